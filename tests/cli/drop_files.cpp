#include "tests/cli/drop_files.h"

#include <X11/Xatom.h>
#include <X11/Xlib.h>
#include <poll.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <optional>

namespace loden::test {
namespace {

using Clock = std::chrono::steady_clock;

constexpr long kVersion = 5;

// As a URI: bytes that are neither letters nor digits are written as %XX.
std::string uriOf(const std::filesystem::path& file) {
  std::string uri = "file://";
  for (const char c : file.string()) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) || c == '/' || c == '.' || c == '-';
    char code[4];
    std::snprintf(code, sizeof code, "%%%02X", static_cast<unsigned>(static_cast<unsigned char>(c)));
    uri += plain ? std::string(1, c) : code;
  }
  return uri;
}

class Source {
 public:
  explicit Source(Display* display) : display_(display), root_(DefaultRootWindow(display)) {
    own_ = XCreateSimpleWindow(display, root_, 0, 0, 1, 1, 0, 0, 0);
    XSetSelectionOwner(display, atom("XdndSelection"), own_, CurrentTime);
  }

  std::string drop(const std::string& uris, Clock::time_point end) {
    const std::optional<Window> target = findTarget(root_);
    if (!target) return "no window takes drops";
    uris_ = uris;
    XWindowAttributes of_target;
    XGetWindowAttributes(display_, *target, &of_target);
    int x = 0, y = 0;
    Window child = 0;
    XTranslateCoordinates(display_, *target, root_, of_target.width / 2, of_target.height / 2, &x, &y,
                          &child);
    send(*target, "XdndEnter", kVersion << 24, static_cast<long>(atom("text/uri-list")), 0, 0);
    send(*target, "XdndPosition", 0, long{x} << 16 | y, CurrentTime,
         static_cast<long>(atom("XdndActionCopy")));
    const auto status = waitFor("XdndStatus", end);
    if (!status) return "the window does not answer";
    if ((status->data.l[1] & 1) == 0) return "the window refuses the drop";
    send(*target, "XdndDrop", 0, CurrentTime, 0, 0);
    const auto finished = waitFor("XdndFinished", end);
    if (!finished) return "the window does not finish";
    // Bit 0 says so, but GLFW writes the number of bytes that it has read.
    return finished->data.l[1] != 0 ? "" : "the window could not read the list of files";
  }

 private:
  Atom atom(const char* name) const { return XInternAtom(display_, name, False); }

  // The window itself or one below it that has the property XdndAware.
  std::optional<Window> findTarget(Window window) const {
    int count = 0;
    Atom* properties = XListProperties(display_, window, &count);
    bool aware = false;
    for (int i = 0; i < count; ++i) aware = aware || properties[i] == atom("XdndAware");
    if (properties) XFree(properties);
    if (aware) return window;
    Window root = 0, parent = 0, *children = nullptr;
    unsigned children_count = 0;
    std::optional<Window> found;
    if (!XQueryTree(display_, window, &root, &parent, &children, &children_count)) return found;
    for (unsigned i = 0; i < children_count && !found; ++i) found = findTarget(children[i]);
    if (children) XFree(children);
    return found;
  }

  void send(Window target, const char* message, long l1, long l2, long l3, long l4) {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = target;
    event.xclient.message_type = atom(message);
    event.xclient.format = 32;
    const long data[5] = {static_cast<long>(own_), l1, l2, l3, l4};
    std::copy(data, data + 5, event.xclient.data.l);
    XSendEvent(display_, target, False, NoEventMask, &event);
    XFlush(display_);
  }

  // The list of files, to whoever asks for the selection.
  void answer(const XSelectionRequestEvent& request) {
    XChangeProperty(display_, request.requestor, request.property, request.target, 8, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(uris_.data()), static_cast<int>(uris_.size()));
    XEvent event{};
    event.xselection.type = SelectionNotify;
    event.xselection.requestor = request.requestor;
    event.xselection.selection = request.selection;
    event.xselection.target = request.target;
    event.xselection.property = request.property;
    event.xselection.time = request.time;
    XSendEvent(display_, request.requestor, False, NoEventMask, &event);
    XFlush(display_);
  }

  std::optional<XClientMessageEvent> waitFor(const char* message, Clock::time_point end) {
    while (Clock::now() < end) {
      while (XPending(display_) > 0) {
        XEvent event;
        XNextEvent(display_, &event);
        if (event.type == SelectionRequest) answer(event.xselectionrequest);
        if (event.type == ClientMessage && event.xclient.message_type == atom(message)) return event.xclient;
      }
      pollfd waiting{ConnectionNumber(display_), POLLIN, 0};
      ::poll(&waiting, 1, 100);
    }
    return {};
  }

  Display* display_;
  Window root_, own_ = 0;
  std::string uris_;
};

}  // namespace

std::string dropFiles(const char* display_name, const std::vector<std::filesystem::path>& files,
                      std::chrono::seconds most) {
  Display* display = XOpenDisplay(display_name);
  if (!display) return "there is no display";
  std::string uris;
  for (const std::filesystem::path& file : files) uris += uriOf(file) + "\r\n";
  const std::string wrong = Source(display).drop(uris, Clock::now() + most);
  XCloseDisplay(display);
  return wrong;
}

}  // namespace loden::test
