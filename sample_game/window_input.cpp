#include "sample_game/window_input.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <utility>

namespace loden::walk {
namespace {

constexpr double kDoubleClickSeconds = 0.4, kDoubleClickReach = 6;  // window coordinates

}  // namespace

WindowInput& WindowInput::of(GLFWwindow* window) {
  return *static_cast<WindowInput*>(glfwGetWindowUserPointer(window));
}

WindowInput::WindowInput(GLFWwindow* window) : window_(window) {
  glfwSetWindowUserPointer(window, this);
  glfwGetCursorPos(window, &pointer_.x, &pointer_.y);
  glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int) {
    if (action != GLFW_REPEAT) of(w).events_.keys.push_back({key, action == GLFW_PRESS});
  });
  glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int modifiers) {
    of(w).press(button, action == GLFW_PRESS, modifiers);
  });
  glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
    WindowInput& self = of(w);
    self.events_.motion += glm::dvec2(x, y) - self.pointer_;
    self.pointer_ = {x, y};
  });
  glfwSetScrollCallback(window, [](GLFWwindow* w, double, double y) { of(w).events_.wheel += y; });
  glfwSetWindowFocusCallback(window, [](GLFWwindow* w, int focused) {
    if (!focused) of(w).events_.focus_lost = true;
  });
  glfwSetDropCallback(window, [](GLFWwindow* w, int count, const char** paths) {
    for (int i = 0; i < count; ++i) of(w).events_.dropped.emplace_back(paths[i]);
  });
}

WindowInput::~WindowInput() {
  glfwSetKeyCallback(window_, nullptr);
  glfwSetMouseButtonCallback(window_, nullptr);
  glfwSetCursorPosCallback(window_, nullptr);
  glfwSetScrollCallback(window_, nullptr);
  glfwSetWindowFocusCallback(window_, nullptr);
  glfwSetDropCallback(window_, nullptr);
  glfwSetWindowUserPointer(window_, nullptr);
}

void WindowInput::press(int button, bool down, int modifiers) {
  ButtonEvent event{button, down, false, modifiers, pointer_};
  if (down) {
    const double now = glfwGetTime();
    event.twice = button == pressed_button_ && now - pressed_time_ < kDoubleClickSeconds &&
                  glm::distance(pointer_, pressed_at_) < kDoubleClickReach;
    pressed_button_ = event.twice ? -1 : button;  // a third press begins anew
    pressed_time_ = now;
    pressed_at_ = pointer_;
  }
  events_.buttons.push_back(event);
}

InputEvents WindowInput::take() {
  return std::exchange(events_, {});
}

}  // namespace loden::walk
