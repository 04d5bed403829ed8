#include "sample_game/hud.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "material/model/directions.h"

namespace loden::walk {

using namespace runtime;

namespace {

constexpr double kMegabyte = 1 << 20;
constexpr const char* kHeatNames[] = {"none", "level of detail, 0 to 8", "texture fetches, 0 to 100",
                                      "near term, bands, mean"};

// What each key does, as the help shows it.
struct Help {
  const char* keys;
  const char* what;
};
constexpr Help kHelp[] = {
    {"left drag", "orbit around what is looked at"},
    {"Shift, Ctrl or middle drag", "pan"},
    {"right drag", "look around"},
    {"wheel", "nearer, farther"},
    {"double click", "look at that point"},
    {"W A S D, arrows", "walk; with Shift faster"},
    {"Q E", "down, up"},
    {"F", "see everything"},
    {"P", "back to the path, or to the scene's camera"},
    {"Space", "stop the animation, and go on"},
    {"B", "glTF's own materials, and back"},
    {"C", "compare two looks side by side; drag the line"},
    {"X", "heat maps, one after the other"},
    {"Tab", "hide or show this panel"},
    {"F12", "save the picture as loden_walk-N.png"},
    {"H, F1", "this help"},
    {"Esc", "leave"},
    {"drop a file", ".gltf or .glb: walk there; .loden: onto the chosen material; .hdr: light"},
};

const char* nameOr(const std::string& name, const char* otherwise) {
  return name.empty() ? otherwise : name.c_str();
}

// What is shown of a look, which is another where the look has nothing to show.
const char* nameOf(Look look, const World& world, const Picture& picture) {
  if (look == Look::kTruth && !picture.showsTruth()) return "Loden; P: the traced truth's camera";
  if (look == Look::kParallax && !world.hasHeightField()) return "no height field: glTF's own materials";
  return kLookNames[size_t(look)];
}

// The file's stem without the hash that names of cooked assets may end in.
std::string shortName(const SceneAsset& asset) {
  std::string name = asset.path.empty() ? asset.name : asset.path.stem().string();
  const size_t dash = name.rfind('-');
  if (dash != std::string::npos && name.size() - dash == 13 &&
      name.find_first_not_of("0123456789abcdef", dash + 1) == std::string::npos)
    name.resize(dash);
  return name;
}

// Of the textures that the last frame asked for.
void drawTextures(const std::vector<MaterialDemand>& textures) {
  if (textures.empty() || !ImGui::CollapsingHeader("textures")) return;
  for (const MaterialDemand& texture : textures)
    ImGui::Text("mip %.1f of %.1f: %s", double(texture.resident), double(texture.lambda),
                texture.name.c_str());
}

}  // namespace

void applyQuality(Quality quality, FrameSettings& settings) {
  settings.lookup = quality == Quality::kHigh ? Lookup::kDefault : Lookup::kFast;
  settings.visibility = quality == Quality::kLow      ? Visibility::kNone
                        : quality == Quality::kMedium ? Visibility::kFast
                                                      : Visibility::kDefault;
  settings.samples = quality == Quality::kLow ? 1 : 4;
}

Hud::Hud(GLFWwindow* window) {
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  ImGui::StyleColorsDark();
  ImGui::GetStyle().WindowRounding = 4;
  ImGui::GetStyle().Colors[ImGuiCol_WindowBg].w = 0.82f;
  ImGui_ImplGlfw_InitForOpenGL(window, true);
  ImGui_ImplOpenGL3_Init("#version 450");
}

Hud::~Hud() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

void Hud::beginFrame() {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
}

bool Hud::wantsKeyboard() const {
  return ImGui::GetIO().WantTextInput;
}
bool Hud::wantsPointer() const {
  return ImGui::GetIO().WantCaptureMouse;
}

void Hud::drawTimes(const World&, const Picture& picture) {
  const FrameStats& frame = picture.stats();
  const float most = *std::max_element(times_.begin(), times_.end());
  char overlay[64];
  std::snprintf(overlay, sizeof overlay, "%.1f ms", picture.lastMs());
  ImGui::PlotLines("##times", times_.data(), int(times_.size()), int(next_), overlay, 0,
                   std::max(most, 20.0f), {270, 46});
  ImGui::Text("%d of %d objects; all of the picture %.0f ms%s", frame.visible_objects, frame.objects,
              picture.wholeMs(), picture.refining() ? ", refining" : "");
}

void Hud::drawMaterial(const World& world, HudState& state, HudRequests& requests) {
  const Scene& scene = world.scene;
  if (scene.materials.empty()) return;
  state.material = std::clamp(state.material, 0, int(scene.materials.size()) - 1);
  const SceneMaterial& material = scene.materials[size_t(state.material)];
  ImGui::SetNextItemWidth(190);
  if (ImGui::BeginCombo("material", nameOr(material.name, "without a name"))) {
    for (int i = 0; i < int(scene.materials.size()); ++i) {
      const SceneMaterial& each = scene.materials[size_t(i)];
      const std::string label = std::string(nameOr(each.name, "without a name")) + "##" + std::to_string(i);
      if (ImGui::Selectable(label.c_str(), i == state.material)) state.material = i, state.period = 0;
    }
    ImGui::EndCombo();
  }
  const int worn = material.flat_btf ? material.flat_btf->asset : -1;
  ImGui::SetNextItemWidth(190);
  if (ImGui::BeginCombo("wears", worn < 0 ? "glTF's own" : shortName(scene.assets[size_t(worn)]).c_str())) {
    if (ImGui::Selectable("glTF's own", worn < 0)) requests.wear = -1;
    for (int i = 0; i < int(scene.assets.size()); ++i) {
      const std::string label = shortName(scene.assets[size_t(i)]) + "##" + std::to_string(i);
      if (ImGui::Selectable(label.c_str(), i == worn)) requests.wear = i;
    }
    ImGui::EndCombo();
  }
  if (worn < 0) return;
  float centimetres = static_cast<float>(state.period * 100);
  ImGui::SetNextItemWidth(190);
  if (ImGui::SliderFloat("tile, cm", &centimetres, 0.2f, 200, "%.2f", ImGuiSliderFlags_Logarithmic)) {
    state.period = double(centimetres) / 100;
    requests.dress = true;
  }
  float degrees = static_cast<float>(state.rotation * 180 / kPi);
  ImGui::SetNextItemWidth(190);
  if (ImGui::SliderFloat("turned", &degrees, -180, 180, "%.0f degrees")) {
    state.rotation = double(degrees) * kPi / 180;
    requests.dress = true;
  }
}

void Hud::drawLight(World& world, const std::vector<std::string>& environments, int environment,
                    HudRequests& requests) {
  ImGui::SetNextItemWidth(190);
  if (ImGui::BeginCombo("light", environments[size_t(environment)].c_str())) {
    for (int i = 0; i < int(environments.size()); ++i)
      if (ImGui::Selectable(environments[size_t(i)].c_str(), i == environment)) requests.environment = i;
    ImGui::EndCombo();
  }
  if (world.lighting.panorama) {
    if (!ImGui::IsAnyItemActive()) light_degrees_ = static_cast<float>(world.lighting.turn * 180 / kPi);
    ImGui::SetNextItemWidth(190);
    ImGui::SliderFloat("from", &light_degrees_, -180, 180, "%.0f degrees");
    if (ImGui::IsItemDeactivatedAfterEdit()) requests.environment_turn = double(light_degrees_) * kPi / 180;
  }
  ImGui::SetNextItemWidth(190);
  requests.redraw |= ImGui::SliderFloat("exposure", &world.settings.exposure, 0.1f, 8.0f, "%.2f",
                                        ImGuiSliderFlags_Logarithmic);
  bool shadows = world.settings.shadows;
  if (ImGui::Checkbox("shadows", &shadows)) {
    world.settings.shadows = shadows;
    world.settings.environment_shadows = shadows && world.settings.reflections != nullptr;
    requests.redraw = true;
  }
  ImGui::SameLine();
  requests.redraw |= ImGui::Checkbox("relief in depth", &world.settings.parallax_depth);
  if (!world.settings.parallax_depth) return;
  ImGui::SameLine();
  requests.redraw |= ImGui::Checkbox("as a shell", &world.settings.shell);
}

void Hud::drawLooks(World& world, HudState& state, HudRequests& requests) {
  int quality = static_cast<int>(state.quality);
  ImGui::SetNextItemWidth(190);
  if (ImGui::Combo("quality", &quality, kQualityNames, 3)) {
    state.quality = static_cast<Quality>(quality);
    applyQuality(state.quality, world.settings);
    requests.redraw = true;
  }
  int heat = static_cast<int>(world.settings.heat);
  ImGui::SetNextItemWidth(190);
  if (ImGui::Combo("heat map", &heat, kHeatNames, 4)) {
    world.settings.heat = static_cast<HeatMap>(heat);
    requests.redraw = true;
  }
  requests.redraw |= ImGui::Checkbox("compare", &state.wipe.on);
  if (!state.wipe.on) {
    ImGui::SameLine();
    requests.redraw |= ImGui::Checkbox("glTF's own materials", &world.settings.base_materials_only);
    return;
  }
  int left = static_cast<int>(state.wipe.left), right = static_cast<int>(state.wipe.right);
  const int looks = static_cast<int>(std::size(kLookNames)) - (world.truth ? 0 : 1);
  ImGui::SetNextItemWidth(190);
  if (ImGui::Combo("left", &left, kLookNames, looks)) state.wipe.left = static_cast<Look>(left);
  ImGui::SetNextItemWidth(190);
  if (ImGui::Combo("right", &right, kLookNames, looks)) state.wipe.right = static_cast<Look>(right);
  ImGui::SetNextItemWidth(190);
  ImGui::SliderFloat("border", &state.wipe.border, 0, 1, "");
}

void Hud::drawBytes(const World& world, const Picture& picture, HudState& state, HudRequests& requests) {
  const MaterialStats& stats = world.materials->stats();
  float budget = static_cast<float>(state.budget_mb);
  ImGui::SetNextItemWidth(190);
  if (ImGui::SliderFloat("budget, MB", &budget, 0.1f, 256, "%.1f", ImGuiSliderFlags_Logarithmic)) {
    state.budget_mb = double(budget);
    requests.budget = true;
  }
  ImGui::Text("%.2f MB resident of %.2f, at most %.2f", double(stats.resident_bytes) / kMegabyte,
              double(stats.total_bytes) / kMegabyte, double(stats.peak_bytes) / kMegabyte);
  if (stats.textures > 0)
    ImGui::Text("%d textures with %.2f MB of it", stats.textures, double(stats.texture_bytes) / kMegabyte);
  drawTextures(picture.stats().textures);
  if (!ImGui::CollapsingHeader("resident parts")) return;
  const std::vector<MaterialId> ids = world.renderer->assets();
  for (size_t i = 0; i < ids.size(); ++i) {
    const std::string name = i < world.scene.assets.size() ? shortName(world.scene.assets[i]) : "asset";
    ImGui::Text("%s, shown from level %.2f", name.c_str(), double(world.materials->residentLambda(ids[i])));
    uint64_t most = 1;
    for (const PartStats& part : world.materials->parts(ids[i])) most = std::max(most, part.bytes);
    for (const PartStats& part : world.materials->parts(ids[i])) {
      char text[64];
      std::snprintf(text, sizeof text, "%s, %.0f KB", part.name.c_str(), double(part.bytes) / 1024);
      ImGui::PushStyleColor(ImGuiCol_PlotHistogram,
                            part.resident ? ImVec4(0.25f, 0.55f, 0.3f, 1) : ImVec4(0.3f, 0.3f, 0.3f, 1));
      ImGui::ProgressBar(float(double(part.bytes) / double(most)), {270, 14}, text);
      ImGui::PopStyleColor();
    }
  }
}

void Hud::drawHelp(bool& open) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({size.x / 2, size.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::Begin("Keys and mouse", &open,
               ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove);
  if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
    for (const Help& line : kHelp) {
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(line.keys);
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(line.what);
    }
    ImGui::EndTable();
  }
  ImGui::End();
}

// The line between the two looks, and their names at its foot.
void Hud::drawWipe(const World& world, const HudState& state, const Picture& picture) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const float x = state.wipe.border * size.x;
  ImDrawList* list = ImGui::GetForegroundDrawList();
  list->AddLine({x, 0}, {x, size.y}, IM_COL32(255, 255, 255, 200), 1.5f);
  const char* left = nameOf(state.wipe.left, world, picture);
  const char* right = nameOf(state.wipe.right, world, picture);
  const float y = size.y - 24;
  list->AddText({x - ImGui::CalcTextSize(left).x - 8, y}, IM_COL32(255, 255, 255, 255), left);
  list->AddText({x + 8, y}, IM_COL32(255, 255, 255, 255), right);
}

void Hud::drawPreparing() {
  const char* text = "compiling the shaders of what is seen ...";
  const ImVec2 size = ImGui::GetIO().DisplaySize, extent = ImGui::CalcTextSize(text);
  ImGui::GetForegroundDrawList()->AddText({(size.x - extent.x) / 2, (size.y - extent.y) / 2},
                                          IM_COL32(255, 255, 255, 255), text);
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

HudRequests Hud::draw(World& world, HudState& state, const Picture& picture,
                      const std::vector<std::string>& environments, int environment, double seconds) {
  HudRequests requests;
  times_[next_] = static_cast<float>(picture.lastMs());
  next_ = (next_ + 1) % times_.size();
  if (state.wipe.on) drawWipe(world, state, picture);
  if (state.panel) {
    ImGui::SetNextWindowPos({8, 8}, ImGuiCond_FirstUseEver);
    ImGui::Begin("Loden", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
    drawTimes(world, picture);
    ImGui::Separator();
    drawMaterial(world, state, requests);
    ImGui::Separator();
    drawLight(world, environments, environment, requests);
    ImGui::Separator();
    drawLooks(world, state, requests);
    ImGui::Separator();
    drawBytes(world, picture, state, requests);
    ImGui::TextDisabled("H: keys and mouse");
    ImGui::End();
  }
  if (state.help) drawHelp(state.help);
  if ((state.message_seconds -= seconds) > 0) {
    const ImVec2 size = ImGui::GetIO().DisplaySize, text = ImGui::CalcTextSize(state.message.c_str());
    ImDrawList* list = ImGui::GetForegroundDrawList();
    const ImVec2 at{(size.x - text.x) / 2, size.y - 44};
    list->AddRectFilled({at.x - 8, at.y - 4}, {at.x + text.x + 8, at.y + text.y + 4}, IM_COL32(0, 0, 0, 180),
                        4);
    list->AddText(at, IM_COL32(255, 255, 255, 255), state.message.c_str());
  }
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  return requests;
}

}  // namespace loden::walk
