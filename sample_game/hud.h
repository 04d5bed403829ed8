// The panel with settings and measurements, and the page of help, that are drawn over the picture.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sample_game/dress.h"
#include "sample_game/picture.h"
#include "sample_game/world.h"

struct GLFWwindow;

namespace loden::walk {

enum class Quality { kLow, kMedium, kHigh };
inline constexpr const char* kQualityNames[] = {"low", "medium", "high"};
// Sets the lookup, the shadows inside the tile, and the samples per pixel.
void applyQuality(Quality quality, runtime::FrameSettings& settings);

// The state that the panel shows and changes, apart from the settings of the frame.
struct HudState {
  bool panel = true, help = false;
  int material = 0;     // index of the scene's material that the panel shows
  double period = 0;    // metres; 0: not known
  double rotation = 0;  // radians
  Wipe wipe;
  Quality quality = Quality::kHigh;
  double budget_mb = 64;
  std::string message;         // says what was done last
  double message_seconds = 0;  // for how many more seconds the message is shown
};

// What the visitor asked for with the panel; the player does it.
struct HudRequests {
  bool redraw = false;                     // settings have changed
  bool dress = false;                      // material, period or rotation has changed
  std::optional<int> wear;                 // index of an asset of the scene; -1: glTF's own material
  std::optional<int> environment;          // index into the list of environments
  std::optional<double> environment_turn;  // radians
  bool budget = false;                     // HudState::budget_mb has changed
};

class Hud {
 public:
  // The window's input callbacks must have been set before; the panel's own callbacks call them.
  explicit Hud(GLFWwindow* window);
  ~Hud();
  Hud(const Hud&) = delete;
  Hud& operator=(const Hud&) = delete;

  void beginFrame();
  // Whether the panel takes the keys, and whether it takes the pointer.
  bool wantsKeyboard() const;
  bool wantsPointer() const;
  // Draws a notice into the window while there is no picture yet; takes the place of draw().
  void drawPreparing();
  // Draws the panel into the window.
  HudRequests draw(World& world, HudState& state, const Picture& picture,
                   const std::vector<std::string>& environments, int environment, double seconds);

 private:
  void drawTimes(const World& world, const Picture& picture);
  void drawMaterial(const World& world, HudState& state, HudRequests& requests);
  void drawLight(World& world, const std::vector<std::string>& environments, int environment,
                 HudRequests& requests);
  void drawLooks(World& world, HudState& state, HudRequests& requests);
  void drawBytes(const World& world, const Picture& picture, HudState& state, HudRequests& requests);
  void drawHelp(bool& open);
  void drawWipe(const World& world, const HudState& state, const Picture& picture);

  std::array<float, 120> times_{};  // of the last frames in ms, a ring whose oldest entry is at next_
  size_t next_ = 0;
  float light_degrees_ = 0;  // where the light's slider stands while it is dragged
};

}  // namespace loden::walk
