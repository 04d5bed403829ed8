// Input of a window. Every press is kept until take() is called, so that none is lost however short it was
// and however long a frame takes.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <vector>

struct GLFWwindow;

namespace loden::walk {

struct KeyEvent {
  int key = 0;  // GLFW_KEY_*
  bool down = false;
};
struct ButtonEvent {
  int button = 0;  // GLFW_MOUSE_BUTTON_*
  bool down = false;
  bool twice = false;  // the second press of a double click
  int modifiers = 0;   // GLFW_MOD_*
  glm::dvec2 at{0};    // window coordinates, from the top left
};

// All input since the last take().
struct InputEvents {
  std::vector<KeyEvent> keys;
  std::vector<ButtonEvent> buttons;
  glm::dvec2 motion{0};  // of the pointer, window coordinates
  double wheel = 0;      // clicks
  bool focus_lost = false;
  std::vector<std::filesystem::path> dropped;
};

// Collects the input of one window, which must outlive it. It must be made before other objects that set
// callbacks of the window; their callbacks then call those of this class.
class WindowInput {
 public:
  explicit WindowInput(GLFWwindow* window);
  ~WindowInput();
  WindowInput(const WindowInput&) = delete;
  WindowInput& operator=(const WindowInput&) = delete;

  InputEvents take();
  glm::dvec2 pointer() const { return pointer_; }

 private:
  static WindowInput& of(GLFWwindow* window);
  void press(int button, bool down, int modifiers);

  GLFWwindow* window_;
  InputEvents events_;
  glm::dvec2 pointer_{0}, pressed_at_{0};
  double pressed_time_ = -10;
  int pressed_button_ = -1;
};

}  // namespace loden::walk
