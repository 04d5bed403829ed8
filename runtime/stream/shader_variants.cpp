#include "runtime/stream/shader_variants.h"

#include "material/base/check.h"
#include "shaders/loden_shared.h"

namespace loden::runtime {
namespace {

const char* lookupDefine(Lookup lookup) {
  switch (lookup) {
    case Lookup::kPaper:
      return "LODEN_LOOKUP_PAPER 1";
    case Lookup::kFast:
      return "LODEN_LOOKUP_FAST 1";
    case Lookup::kDefault:
      return "LODEN_LOOKUP_DEFAULT 1";
    case Lookup::kNone:
    case Lookup::kQuality:
      break;
  }
  return nullptr;
}

}  // namespace

const ProgramRow* findProgramRow(std::string_view name) {
  for (const ProgramRow& row : kProgramRows)
    if (row.name == name) return &row;
  return nullptr;
}

bool hasRelief(const MaterialVariant& variant) {
  return variant.lookup == Lookup::kFast || variant.lookup == Lookup::kDefault;
}

bool rowAllows(const ProgramRow& row, const MaterialVariant& variant) {
  if (row.relief && !hasRelief(variant)) return false;
  if (variant.lookup == Lookup::kQuality) return false;  // offline
  if (!variant.shadesMaterial()) return row.none && variant == MaterialVariant{};
  if (!row.material || variant.bands > LODEN_MAX_BANDS) return false;
  if (byLookup(variant.visibility) && !(variant.near && hasRelief(variant))) return false;
  const bool by_map = variant.visibility == Visibility::kMap;
  if (by_map != (variant.shadow_quads > 0) || variant.shadow_quads > LODEN_MAX_SHADOW_QUADS) return false;
  if (by_map && !variant.near) return false;
  if (variant.visibility == Visibility::kDefault && variant.lookup != Lookup::kDefault) return false;
  const bool paper = variant.lookup == Lookup::kPaper;
  if (variant.near) return !variant.nearest_tables && variant.bands <= (paper ? 0 : kMostNearBands);
  // Nearest tables are those of published level-of-detail materials, in which nothing is read at p; and the
  // published VDIM and the nearest-direction images share texture units.
  return !variant.nearest_tables || variant.lookup == Lookup::kNone;
}

std::vector<MaterialVariant> rowVariants(const ProgramRow& row) {
  std::vector<MaterialVariant> variants;
  const auto addIfAllowed = [&](const MaterialVariant& variant) {
    if (rowAllows(row, variant)) variants.push_back(variant);
  };
  addIfAllowed({});
  for (const Lookup lookup : kLookups) {
    for (uint8_t bands = 0; bands <= kMostNearBands; ++bands) {
      for (const Visibility visibility : {Visibility::kNone, Visibility::kFast, Visibility::kDefault})
        addIfAllowed({true, bands, lookup, visibility});
      for (uint8_t quads = 1; quads <= LODEN_MAX_SHADOW_QUADS; ++quads)
        addIfAllowed({true, bands, lookup, Visibility::kMap, false, 0, quads});
    }
    for (const bool nearest : {false, true})
      for (uint8_t bands = 1; bands <= LODEN_MAX_BANDS; ++bands)
        addIfAllowed({false, bands, lookup, Visibility::kNone, nearest});
  }
  return variants;
}

int unitsOf(const MaterialVariant& variant) {
  if (!variant.shadesMaterial()) return 0;
  return LODEN_UNITS(variant.bands) + (variant.near ? 3 : 0) + (variant.shadow_quads > 0 ? 2 : 0);
}

std::vector<std::string> variantDefines(const MaterialVariant& variant) {
  std::vector<std::string> defines;
  if (variant.near) defines.push_back("LODEN_NEAR 1");
  if (variant.visibility == Visibility::kFast) defines.push_back("LODEN_VISIBILITY_FAST 1");
  if (variant.visibility == Visibility::kDefault) defines.push_back("LODEN_VISIBILITY_DEFAULT 1");
  if (variant.shadow_quads > 0)
    defines.push_back("LODEN_VISIBILITY_MAP " + std::to_string(variant.shadow_quads));
  if (variant.bands > 0) defines.push_back("LODEN_BANDS " + std::to_string(variant.bands));
  if (variant.first_unit > 0) defines.push_back("LODEN_FIRST_UNIT " + std::to_string(variant.first_unit));
  if (variant.nearest_tables) defines.push_back("LODEN_TABLES_NEAREST 1");
  if (const char* define = lookupDefine(variant.lookup)) defines.push_back(define);
  return defines;
}

std::string variantName(const MaterialVariant& variant) {
  if (!variant.shadesMaterial()) return "plain";
  std::string name = variant.near ? "near" : "";
  if (variant.bands > 0) name += (variant.near ? "-bands" : "bands") + std::to_string(variant.bands);
  if (variant.nearest_tables) name += "-nearest";
  name += "-";
  name += lookupName(variant.lookup);
  if (variant.visibility != Visibility::kNone)
    name += std::string("-shadows-") + visibilityName(variant.visibility);
  if (variant.shadow_quads > 0) name += std::to_string(variant.shadow_quads);
  if (variant.first_unit > 0) name += "-from" + std::to_string(variant.first_unit);
  return name;
}

}  // namespace loden::runtime
