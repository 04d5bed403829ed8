// Writes a place to walk through: rooms.gltf and rooms.bin, the same bytes every time. Usage: make_rooms
// FOLDER
// Off a corridor with runners of 30 m lie a wardrobe, a sitting room, a tea room and a fitting room,
// furnished with the materials button, isba, pulli and sponge. `loden pack` gives them their assets; until
// then the factors below stand in.
#include <cstdio>
#include <filesystem>
#include <string>

#include "sample_game/gallery/scene_writer.h"
#include "sample_game/gallery/shapes.h"

namespace gallery {
namespace {

constexpr float kHeight = 3.1f, kThick = 0.2f;  // of rooms and walls, metres
constexpr float kHall = 1.5f;                   // half width of the corridor, which runs along -z
constexpr float kOuter = 6.6f;                  // where the rooms end, left and right
constexpr float kNear = 1.8f, kFar = -31;       // ends of the corridor
constexpr float kRoomNear[2] = {-0.6f, -8.2f};  // z at which the two rooms of a side begin ...
constexpr float kRoomFar[2] = {-7.8f, -15.4f};  // ... and end
constexpr float kDoor = 1.5f, kDoorHeight = 2.2f;

const float kHalfTurn = .70710678f;  // sine and cosine of half a quarter turn

struct Materials {
  int plaster, planks, wood, metal, cloth[4];  // button, isba, pulli, sponge
};

class Rooms {
 public:
  Rooms() : writer_("rooms") {
    writer_.addMaterial("plaster", {.66f, .63f, .58f}, .95f, false);
    materials_.plaster = 0;
    materials_.planks = writer_.addMaterial("floor", {.27f, .20f, .15f}, .55f, false);
    materials_.wood = writer_.addMaterial("wood", {.34f, .21f, .12f}, .5f, false);
    materials_.metal = writer_.addMaterial("brass", {.45f, .36f, .2f}, .35f, false);
    materials_.cloth[kButton] = writer_.addMaterial("button", {.46f, .10f, .08f}, .5f, true);
    materials_.cloth[kIsba] = writer_.addMaterial("isba", {.45f, .30f, .16f}, .8f, true);
    materials_.cloth[kPulli] = writer_.addMaterial("pulli", {.20f, .27f, .42f}, .9f, true);
    materials_.cloth[kSponge] = writer_.addMaterial("sponge", {.75f, .60f, .22f}, .8f, true);
  }

  bool write(const std::filesystem::path& folder) {
    addHouse();
    addRunners();
    addWardrobe({-4.1f, 0, -4.2f});
    addSittingRoom({4.1f, 0, -4.2f});
    addTeaRoom({-4.1f, 0, -11.8f});
    addFittingRoom({4.1f, 0, -11.8f});
    addLights();
    const int camera = writer_.addCamera({{"name", "entrance"},
                                          {"type", "perspective"},
                                          {"perspective", {{"yfov", 0.95}, {"znear", 0.02}, {"zfar", 100}}}});
    writer_.addNode({{"name", "entrance"},
                     {"camera", camera},
                     {"translation", {0, 1.6, 1.5}},
                     {"rotation", {-0.07, 0, 0, 0.9975}}});
    return writer_.write(folder);
  }

 private:
  enum Cloth { kButton, kIsba, kPulli, kSponge };

  void add(const std::string& name, const Shape& shape, int material, glm::vec3 position = {0, 0, 0},
           const Json& rotation = {}) {
    Json node{
        {"name", name}, {"mesh", writer_.addMesh(name, shape, material)}, {"translation", vec(position)}};
    if (!rotation.is_null()) node["rotation"] = rotation;
    writer_.addNode(std::move(node));
  }
  void addBox(const std::string& name, glm::vec3 min, glm::vec3 max, int material) {
    add(name, box(min, max), material);
  }

  // A wall across x from one z to another, with a hole of that size in its middle: a door, or a window from
  // `sill` on.
  void addWallWithHole(const std::string& name, float x, float from, float to, float width, float sill,
                       float lintel) {
    const float low = std::min(from, to), high = std::max(from, to), middle = 0.5f * (low + high);
    const glm::vec3 a(x - kThick / 2, 0, low), b(x + kThick / 2, kHeight, high);
    addBox(name + ", far part", a, {b.x, b.y, middle - width / 2}, materials_.plaster);
    addBox(name + ", near part", {a.x, a.y, middle + width / 2}, b, materials_.plaster);
    addBox(name + ", above", {a.x, lintel, middle - width / 2}, {b.x, b.y, middle + width / 2},
           materials_.plaster);
    if (sill > 0)
      addBox(name + ", below", {a.x, 0, middle - width / 2}, {b.x, sill, middle + width / 2},
             materials_.plaster);
  }

  void addHouse() {
    addBox("floor", {-kOuter, -kThick, kFar}, {kOuter, 0, kNear}, materials_.planks);
    addBox("ceiling", {-kOuter, kHeight, kFar}, {kOuter, kHeight + kThick, kNear}, materials_.plaster);
    addBox("near wall", {-kOuter, 0, kNear}, {kOuter, kHeight, kNear + kThick}, materials_.plaster);
    addBox("far wall", {-kOuter, 0, kFar - kThick}, {kOuter, kHeight, kFar}, materials_.plaster);
    for (const float side : {-1.0f, 1.0f}) {
      const std::string where = side < 0 ? "left" : "right";
      const float inner = side * (kHall + kThick / 2);
      addBox(where + " wall, begin", {inner - kThick / 2, 0, kRoomNear[0]},
             {inner + kThick / 2, kHeight, kNear}, materials_.plaster);
      addBox(where + " wall, end", {inner - kThick / 2, 0, kFar}, {inner + kThick / 2, kHeight, kRoomFar[1]},
             materials_.plaster);
      const float a = std::min(side * kHall, side * kOuter), b = std::max(side * kHall, side * kOuter);
      for (const float z : {kRoomNear[0], kRoomFar[0], kRoomFar[1]})
        addBox(where + " partition", {a, 0, z - (z == kRoomFar[0] ? kRoomFar[0] - kRoomNear[1] : kThick)},
               {b, kHeight, z}, materials_.plaster);
      for (int room = 0; room < 2; ++room) {
        addWallWithHole(where + " wall", inner, kRoomNear[room], kRoomFar[room], kDoor, 0, kDoorHeight);
        // The sun comes in from the right.
        const float outer = side * (kOuter + kThick / 2);
        if (side > 0)
          addWallWithHole("outer wall", outer, kRoomNear[room], kRoomFar[room], 2.6f, 0.7f, 2.5f);
        else
          addBox("outer wall", {outer - kThick / 2, 0, kRoomFar[room]},
                 {outer + kThick / 2, kHeight, kRoomNear[room]}, materials_.plaster);
      }
    }
  }

  // In pieces, so that only those in sight are drawn, with only the lights that reach them.
  void addRunners() {
    constexpr int kPieces = 12;
    constexpr float kPiece = 2.5f, kWidth = 0.62f, kGap = 0.06f;
    for (int c = 0; c < 4; ++c) {
      const int mesh = writer_.addMesh("runner", rectangle({0, 0, 0}, {kWidth, 0, 0}, {0, 0, -kPiece}),
                                       materials_.cloth[c]);
      const float x = (static_cast<float>(c) - 2) * (kWidth + kGap) + kGap / 2;
      for (int i = 0; i < kPieces; ++i)
        writer_.addNode({{"name", "runner"},
                         {"mesh", mesh},
                         {"translation", {x, 0.004f, 0.8f - kPiece * static_cast<float>(i)}}});
    }
  }

  void addStand(glm::vec3 at) {
    addBox("stand", at + glm::vec3(-.015f, 0, -.015f), at + glm::vec3(.015f, 1.56f, .015f), materials_.metal);
    addBox("foot", at + glm::vec3(-.17f, 0, -.17f), at + glm::vec3(.17f, .02f, .17f), materials_.metal);
  }

  void addRug(glm::vec3 middle, float width, float depth, int material) {
    add("rug", rectangle({-width / 2, 0, depth / 2}, {width, 0, 0}, {0, 0, -depth}), material,
        middle + glm::vec3(0, 0.005f, 0));
  }

  // Garments on stands, and a rail of lengths of cloth.
  void addWardrobe(glm::vec3 middle) {
    addRug(middle, 3.2f, 3.6f, materials_.cloth[kSponge]);
    const Json facing{0, kHalfTurn, 0, kHalfTurn};  // towards the door
    const struct {
      glm::vec3 at;
      Shape shape;
      int material;
    } garments[] = {{{-0.3f, 0, 1.5f}, pullover(), kPulli},
                    {{-0.9f, 0, 0.2f}, skirt(), kButton},
                    {{-0.9f, 0, 0.2f}, pullover(), kIsba},
                    {{-0.3f, 0, -1.2f}, pullover(), kButton}};
    for (const auto& garment : garments) {
      addStand(middle + garment.at);
      add("garment", garment.shape, materials_.cloth[garment.material], middle + garment.at, facing);
    }
    addBox("rail", middle + glm::vec3(-2.1f, 1.74f, -2.9f), middle + glm::vec3(1.4f, 1.77f, -2.87f),
           materials_.metal);
    for (int i = 0; i < 4; ++i)
      add("length of cloth", drapedCloth(0.72f, 1.35f, 2), materials_.cloth[i],
          middle + glm::vec3(-1.7f + 0.9f * static_cast<float>(i), 0.42f, -2.86f));
  }

  // Curtains at the window, a bench with cushions, a rug.
  void addSittingRoom(glm::vec3 middle) {
    addRug(middle + glm::vec3(0.2f, 0, 0), 2.6f, 3.4f, materials_.cloth[kIsba]);
    const Json inwards{0, -kHalfTurn, 0, kHalfTurn};
    for (const float side : {-1.0f, 1.0f})
      add("curtain", drapedCloth(0.95f, 2.6f, 4), materials_.cloth[side < 0 ? kPulli : kPulli],
          {kOuter - 0.18f, 0.05f, middle.z + side * 1.5f}, inwards);
    addBox("bench", middle + glm::vec3(-1.5f, 0.14f, -3.1f), middle + glm::vec3(1.5f, 0.42f, -2.3f),
           materials_.cloth[kSponge]);
    addBox("back of the bench", middle + glm::vec3(-1.5f, 0.14f, -3.3f),
           middle + glm::vec3(1.5f, 0.95f, -3.1f), materials_.cloth[kSponge]);
    for (int i = 0; i < 4; ++i) {
      const float tilt = 0.60f;  // half angle: leaning against the back
      add("cushion", cushion(0.46f), materials_.cloth[(i + 2) % 4],
          middle + glm::vec3(-1.1f + 0.74f * static_cast<float>(i), 0.60f, -2.82f),
          {std::sin(tilt), 0, 0, std::cos(tilt)});
    }
    add("cushion", cushion(0.62f), materials_.cloth[kButton], middle + glm::vec3(0.9f, 0.01f, 0.6f));
    add("cushion", cushion(0.62f), materials_.cloth[kIsba], middle + glm::vec3(-0.6f, 0.01f, 1.0f));
  }

  // Bottle, teapot, vase and jar on a long table with a cloth.
  void addTeaRoom(glm::vec3 middle) {
    addRug(middle, 3.4f, 3.0f, materials_.cloth[kButton]);
    addBox("table", middle + glm::vec3(-0.55f, 0.72f, -1.5f), middle + glm::vec3(0.55f, 0.78f, 1.5f),
           materials_.wood);
    for (const float x : {-.45f, .45f})
      for (const float z : {-1.35f, 1.35f})
        addBox("leg", middle + glm::vec3(x - .04f, 0, z - .04f), middle + glm::vec3(x + .04f, .72f, z + .04f),
               materials_.wood);
    const Shape pots[] = {bottle(), teapot(), vase(), jar()};
    const int order[] = {kButton, kIsba, kPulli, kSponge};
    for (int i = 0; i < 4; ++i)
      add("pot", pots[i], materials_.cloth[order[i]],
          middle + glm::vec3(0.1f, 0.78f, -1.1f + 0.74f * static_cast<float>(i)),
          {0, kHalfTurn, 0, kHalfTurn});
    add("wall hanging", drapedCloth(2.4f, 1.9f, 3), materials_.cloth[kPulli],
        middle + glm::vec3(-2.28f, 0.7f, 0), {0, kHalfTurn, 0, kHalfTurn});
  }

  // Curtained booths, a skirt and pullovers.
  void addFittingRoom(glm::vec3 middle) {
    addRug(middle + glm::vec3(0, 0, 0.6f), 2.4f, 2.4f, materials_.cloth[kPulli]);
    for (int i = 0; i < 3; ++i) {
      add("booth curtain", drapedCloth(1.15f, 2.2f, 4), materials_.cloth[(i + 1) % 4],
          middle + glm::vec3(-1.4f + 1.3f * static_cast<float>(i), 0.1f, -2.0f));
      addBox("booth", middle + glm::vec3(-2.03f + 1.3f * static_cast<float>(i), 0, -3.35f),
             middle + glm::vec3(-1.98f + 1.3f * static_cast<float>(i), 2.35f, -2.05f), materials_.wood);
    }
    addBox("booth rail", middle + glm::vec3(-2.03f, 2.33f, -2.02f), middle + glm::vec3(1.95f, 2.36f, -1.99f),
           materials_.metal);
    const Json facing{0, -kHalfTurn, 0, kHalfTurn};
    addStand(middle + glm::vec3(0.7f, 0, 1.3f));
    add("garment", skirt(), materials_.cloth[kIsba], middle + glm::vec3(0.7f, 0, 1.3f), facing);
    add("garment", pullover(), materials_.cloth[kSponge], middle + glm::vec3(0.7f, 0, 1.3f), facing);
    for (const float side : {-1.0f, 1.0f})
      add("curtain", drapedCloth(0.95f, 2.6f, 4), materials_.cloth[kButton],
          {kOuter - 0.18f, 0.05f, middle.z + side * 1.5f}, facing);
  }

  void addLamp(glm::vec3 at, float intensity, float range) {
    writer_.addLight({{"name", "lamp"},
                      {"type", "point"},
                      {"color", {1.0, 0.83, 0.64}},
                      {"intensity", intensity},
                      {"range", range}},
                     at);
  }

  void addLights() {
    // A rotation that turns -z to the way the sunlight goes: down, to the left and away.
    writer_.addLight(
        {{"name", "sun"}, {"type", "directional"}, {"color", {1.0, 0.94, 0.84}}, {"intensity", 4.2}},
        {8, 6, 0}, {-0.2706f, 0.5628f, 0.1999f, 0.7549f});
    for (const float x : {-4.1f, 4.1f})
      for (const float z : {-4.2f, -11.8f}) {
        addLamp({x + 0.9f, 2.5f, z + 1.3f}, 3.6f, 6);
        addLamp({x - 0.9f, 2.5f, z - 1.5f}, 3.6f, 6);
      }
    for (const float z : {0.2f, -4.2f, -8.2f, -12.5f, -18.0f, -24.0f, -29.5f})
      addLamp({0, 2.75f, z}, 2.6f, 6.5f);
  }

  SceneWriter writer_;
  Materials materials_{};
};

}  // namespace
}  // namespace gallery

int main(int argc, char** argv) {
  const std::string argument = argc == 2 ? argv[1] : "";
  if (argument == "--help" || argument == "-h")
    return std::printf("usage: make_rooms FOLDER\nWrites rooms.gltf and rooms.bin into the folder.\n"), 0;
  if (argument.empty() || argument.front() == '-')
    return std::fprintf(stderr, "usage: make_rooms FOLDER\n"), 1;
  std::error_code error;
  std::filesystem::create_directories(argv[1], error);
  if (gallery::Rooms().write(argv[1])) return 0;
  return std::fprintf(stderr, "make_rooms: cannot write to %s\n", argv[1]), 2;
}
