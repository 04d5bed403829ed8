// Writes the gallery: gallery.gltf and gallery.bin, the same bytes every time. Usage: make_gallery FOLDER
// Each of the materials button, isba, pulli and sponge hangs on a wall as cloth, covers a pot, and lies on
// the floor as a strip of 30 m. `loden pack` gives them their assets; until then the factors below stand in.
#include <cstdio>
#include <filesystem>
#include <string>

#include "sample_game/gallery/scene_writer.h"
#include "sample_game/gallery/shapes.h"

namespace gallery {
namespace {

constexpr float kLength = 33, kHalfWidth = 3.6f,
                kHeight = 4;  // of the hall, metres; it runs from z = 2 to -31
constexpr float kNear = 2;

struct Exhibit {
  const char* name;
  glm::vec3 color;
  float roughness;
  Shape (*pot)();
  float lane;           // x of pot and strip
  float wall, cloth_z;  // -1: left wall, 1: right wall; where along it
};
constexpr int kExhibits = 4;
const Exhibit kExhibit[kExhibits] = {
    {"button", {.46f, .10f, .08f}, .5f, &bottle, -2.1f, -1, -2.2f},
    {"isba", {.45f, .30f, .16f}, .8f, &teapot, -0.7f, -1, -5.2f},
    {"pulli", {.20f, .27f, .42f}, .9f, &vase, 0.7f, 1, -2.2f},
    {"sponge", {.75f, .60f, .22f}, .8f, &jar, 2.1f, 1, -5.2f},
};

void addHall(SceneWriter& writer) {
  const int plaster = writer.addMaterial("plaster", {.62f, .60f, .56f}, .95f, false);
  const int planks = writer.addMaterial("floor", {.30f, .24f, .19f}, .7f, false);
  const auto add = [&](const char* name, glm::vec3 min, glm::vec3 max, int material) {
    writer.addNode({{"name", name}, {"mesh", writer.addMesh(name, box(min, max), material)}});
  };
  // Thick, and reaching behind each other, so that no sunlight leaks in where they meet.
  constexpr float kThick = 0.4f, kSkylight = 2.2f;  // half width of the opening in the ceiling
  constexpr float kFar = kNear - kLength, kTop = kHeight + kThick, kOuter = kHalfWidth + kThick;
  add("floor", {-kOuter, -kThick, kFar - kThick}, {kOuter, 0, kNear + kThick}, planks);
  add("left wall", {-kOuter, 0, kFar - kThick}, {-kHalfWidth, kTop, kNear + kThick}, plaster);
  add("right wall", {kHalfWidth, 0, kFar - kThick}, {kOuter, kTop, kNear + kThick}, plaster);
  add("far wall", {-kOuter, 0, kFar - kThick}, {kOuter, kTop, kFar}, plaster);
  add("near wall", {-kOuter, 0, kNear}, {kOuter, kTop, kNear + kThick}, plaster);
  add("left ceiling", {-kOuter, kHeight, kFar - kThick}, {-kSkylight, kTop, kNear + kThick}, plaster);
  add("right ceiling", {kSkylight, kHeight, kFar - kThick}, {kOuter, kTop, kNear + kThick}, plaster);
}

void addExhibit(SceneWriter& writer, const Exhibit& exhibit, int pedestal) {
  const std::string name = exhibit.name;
  const int material = writer.addMaterial(name, exhibit.color, exhibit.roughness, true);
  const glm::vec3 stand(exhibit.lane, 0.8f, -1.2f);
  writer.addNode({{"name", name + " pedestal"}, {"mesh", pedestal}, {"translation", {stand.x, 0, stand.z}}});
  writer.addNode({{"name", name + " pot"},
                  {"mesh", writer.addMesh(name + " pot", exhibit.pot(), material)},
                  {"translation", vec(stand)}});

  const float turn = exhibit.wall < 0 ? .70710678f : -.70710678f;  // half angles of a quarter turn about y
  writer.addNode({{"name", name + " cloth"},
                  {"mesh", writer.addMesh(name + " cloth", drapedCloth(2.2f, 2.6f, 4), material)},
                  {"translation", {exhibit.wall * (kHalfWidth - 0.14f), 0.5f, exhibit.cloth_z}},
                  {"rotation", {0, turn, 0, .70710678f}}});

  // In pieces, so that only those in sight are drawn, with only the lights that reach them.
  constexpr int kPieces = 12;
  constexpr float kPiece = 2.5f, kWidth = 0.9f;
  const int strip =
      writer.addMesh(name + " strip", rectangle({0, 0, 0}, {kWidth, 0, 0}, {0, 0, -kPiece}), material);
  for (int i = 0; i < kPieces; ++i)
    writer.addNode(
        {{"name", name + " strip " + std::to_string(i)},
         {"mesh", strip},
         {"translation", {exhibit.lane - 0.5f * kWidth, 0.004f, 0.3f - kPiece * static_cast<float>(i)}}});
}

void addLights(SceneWriter& writer) {
  // A rotation that turns -z to the way the sunlight goes: down, a little to the left and away.
  writer.addLight(
      {{"name", "sun"}, {"type", "directional"}, {"color", {1.0, 0.95, 0.86}}, {"intensity", 2.6}}, {0, 6, 0},
      {-0.5792f, -0.2290f, -0.1782f, 0.7616f});
  for (int side : {-1, 1})
    for (float z : {-0.6f, -3.7f, -6.8f, -14.0f, -23.0f})
      writer.addLight({{"name", "lamp"},
                       {"type", "point"},
                       {"color", {1.0, 0.82, 0.62}},
                       {"intensity", 3.2},
                       {"range", 5.0}},
                      {static_cast<float>(side) * 1.9f, 2.7f, z});
}

bool writeGallery(const std::filesystem::path& folder) {
  SceneWriter writer("gallery");
  addHall(writer);
  const int stone = writer.addMaterial("stone", {.35f, .35f, .37f}, .6f, false);
  const int pedestal = writer.addMesh("pedestal", box({-.3f, 0, -.3f}, {.3f, .8f, .3f}), stone);
  for (const Exhibit& exhibit : kExhibit) addExhibit(writer, exhibit, pedestal);
  addLights(writer);
  const int camera = writer.addCamera({{"name", "entrance"},
                                       {"type", "perspective"},
                                       {"perspective", {{"yfov", 0.9}, {"znear", 0.02}, {"zfar", 100}}}});
  writer.addNode({{"name", "entrance"},
                  {"camera", camera},
                  {"translation", {0, 1.6, 1.7}},
                  {"rotation", {-0.0998, 0, 0, 0.995}}});
  return writer.write(folder);
}

}  // namespace
}  // namespace gallery

int main(int argc, char** argv) {
  const std::string argument = argc == 2 ? argv[1] : "";
  if (argument == "--help" || argument == "-h")
    return std::printf("usage: make_gallery FOLDER\nWrites gallery.gltf and gallery.bin into the folder.\n"),
           0;
  if (argument.empty() || argument.front() == '-')
    return std::fprintf(stderr, "usage: make_gallery FOLDER\n"), 1;
  std::error_code error;
  std::filesystem::create_directories(argv[1], error);
  if (gallery::writeGallery(argv[1])) return 0;
  return std::fprintf(stderr, "make_gallery: cannot write to %s\n", argv[1]), 2;
}
