#include "sample_game/player.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace loden::walk {
namespace {

using Clock = std::chrono::steady_clock;

GLFWwindow* windowOf(const runtime::Device& device) {
  return static_cast<GLFWwindow*>(device.nativeWindow());
}

bool pressed(GLFWwindow* window, int key) {
  return glfwGetKey(window, key) == GLFW_PRESS;
}

// -1, 0 or 1.
double axis(GLFWwindow* window, int minus, int plus) {
  return double(pressed(window, plus)) - double(pressed(window, minus));
}

// Turns a direction by angles around `up` and around the axis to the right; stops short of straight up or
// down.
glm::dvec3 turned(const glm::dvec3& direction, const glm::dvec3& up, double yaw, double pitch) {
  const glm::dvec3 right = glm::normalize(glm::cross(direction, up)), ahead = glm::cross(up, right);
  const double height =
      std::clamp(std::asin(std::clamp(glm::dot(direction, up), -1.0, 1.0)) + pitch, -1.5, 1.5);
  const glm::dvec3 level = std::cos(yaw) * ahead + std::sin(yaw) * right;
  return std::cos(height) * level + std::sin(height) * up;
}

constexpr double kMegabyte = 1 << 20;

}  // namespace

struct Player::Ui {
  explicit Ui(GLFWwindow* window) {
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui_ImplGlfw_InitForOpenGL(window, true);
    ImGui_ImplOpenGL3_Init("#version 450");
  }
  ~Ui() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
  }
};

Player::Player(runtime::Device& device, const runtime::CameraPath& path)
    : device_(device),
      path_(path),
      ui_(std::make_unique<Ui>(windowOf(device))),
      camera_(path.at(0)),
      last_(Clock::now()) {}

Player::~Player() = default;

float Player::beginFrame() {
  const auto now = Clock::now();
  const float seconds = std::min(std::chrono::duration<float>(now - last_).count(), 0.25f);
  last_ = now;
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  leave_ = leave_ || pressed(windowOf(device_), GLFW_KEY_ESCAPE);
  look();
  move(seconds);
  if (!free_ && path_.duration() > 0) {
    path_seconds_ = std::fmod(path_seconds_ + seconds, path_.duration());
    camera_ = path_.at(path_seconds_);
  }
  return seconds;
}

void Player::look() {
  GLFWwindow* window = windowOf(device_);
  glm::dvec2 cursor;
  glfwGetCursorPos(window, &cursor.x, &cursor.y);
  const glm::dvec2 motion = cursor - cursor_;
  cursor_ = cursor;
  if (glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_RIGHT) != GLFW_PRESS || ImGui::GetIO().WantCaptureMouse)
    return;
  free_ = true;
  const glm::dvec3 direction = glm::normalize(camera_.target - camera_.position);
  camera_.target = camera_.position + turned(direction, camera_.up, motion.x * 0.003, -motion.y * 0.003);
}

void Player::move(float seconds) {
  GLFWwindow* window = windowOf(device_);
  if (ImGui::GetIO().WantCaptureKeyboard) return;
  if (pressed(window, GLFW_KEY_P)) free_ = false;
  const glm::dvec3 ahead = glm::normalize(camera_.target - camera_.position);
  const glm::dvec3 right = glm::normalize(glm::cross(ahead, camera_.up));
  const glm::dvec3 step = axis(window, GLFW_KEY_S, GLFW_KEY_W) * ahead +
                          axis(window, GLFW_KEY_A, GLFW_KEY_D) * right +
                          axis(window, GLFW_KEY_Q, GLFW_KEY_E) * camera_.up;
  if (glm::length(step) == 0) return;
  free_ = true;
  const double speed = pressed(window, GLFW_KEY_LEFT_SHIFT) ? 4.0 : 1.0;  // metres per second
  camera_.position += step * speed * double(seconds);
  camera_.target += step * speed * double(seconds);
}

void Player::drawOverlay(double ms, const runtime::FrameStats& frame, const runtime::MaterialStats& materials,
                         runtime::FrameSettings& settings) {
  ImGui::SetNextWindowPos({8, 8}, ImGuiCond_FirstUseEver);
  ImGui::Begin("Loden", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
  ImGui::Text("%.1f ms, %d of %d objects, %d draws", ms, frame.visible_objects, frame.objects,
              frame.draw_calls);
  ImGui::Text("materials: %.2f MB resident of %.2f, peak %.2f", double(materials.resident_bytes) / kMegabyte,
              double(materials.total_bytes) / kMegabyte, double(materials.peak_bytes) / kMegabyte);
  for (const runtime::MaterialDemand& demand : frame.demands)
    ImGui::Text("%-12s lambda %.2f, resident %.2f", demand.name.c_str(), double(demand.lambda),
                double(demand.resident));
  ImGui::Checkbox("base materials", &settings.base_materials_only);
  ImGui::Checkbox("shadows", &settings.shadows);
  ImGui::SliderFloat("exposure", &settings.exposure, 0.1f, 4.0f);
  ImGui::TextUnformatted("W A S D Q E, right mouse button; P: path; Esc");
  ImGui::End();
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

}  // namespace loden::walk
