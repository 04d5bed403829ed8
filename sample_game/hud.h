// The panel and the help over the picture.
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
// Lookup, shadows in the tile and samples a pixel.
void applyQuality(Quality quality, runtime::FrameSettings& settings);

// What the panel shows and changes beside the frame's settings.
struct HudState {
  bool panel = true, help = false;
  int material = 0;     // of the scene, that the panel is about
  double period = 0;    // metres; 0: not known
  double rotation = 0;  // radians
  Wipe wipe;
  Quality quality = Quality::kHigh;
  double budget_mb = 64;
  std::string message;         // of what was done last
  double message_seconds = 0;  // that it is shown yet
};

// What the visitor asked for with the panel; the player does it.
struct HudRequests {
  bool redraw = false;                     // settings changed
  bool dress = false;                      // material, period or rotation changed
  std::optional<int> wear;                 // an asset of the scene's, or -1: the file's own material
  std::optional<int> environment;          // index into the list of environments
  std::optional<double> environment_turn;  // radians
  bool budget = false;
};

class Hud {
 public:
  // The window's input callbacks must be set already; the panel's call them.
  explicit Hud(GLFWwindow* window);
  ~Hud();
  Hud(const Hud&) = delete;
  Hud& operator=(const Hud&) = delete;

  void beginFrame();
  // Whether keys, or the pointer, are the panel's.
  bool wantsKeyboard() const;
  bool wantsPointer() const;
  // In place of draw(), before there is a picture.
  void drawPreparing();
  // Draws into the window.
  HudRequests draw(World& world, HudState& state, const Picture& picture,
                   const std::vector<std::string>& environments, int environment, double seconds);

 private:
  void drawTimes(const World& world, const Picture& picture);
  void drawMaterial(const World& world, HudState& state, HudRequests& requests);
  void drawLight(World& world, const std::vector<std::string>& environments, int environment,
                 HudRequests& requests);
  void drawLooks(World& world, HudState& state, HudRequests& requests);
  void drawBytes(const World& world, HudState& state, HudRequests& requests);
  void drawHelp(bool& open);
  void drawWipe(const World& world, const HudState& state, const Picture& picture);

  std::array<float, 120> times_{};  // ms, oldest first from next_
  size_t next_ = 0;
  float light_degrees_ = 0;  // of the slider, while it is held
};

}  // namespace loden::walk
