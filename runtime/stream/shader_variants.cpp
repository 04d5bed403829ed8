#include "runtime/stream/shader_variants.h"

#include <algorithm>
#include <cmath>

#include "material/model/vdim.h"
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
  if (row.march && marchVariant(variant) != variant) return false;
  if (variant.lookup == Lookup::kQuality) return false;  // offline
  if (!variant.shadesMaterial()) return row.none && variant == MaterialVariant{};
  if (!row.material || variant.bands > LODEN_MAX_BANDS) return false;
  if (byLookup(variant.visibility) && !(variant.near && hasRelief(variant))) return false;
  const bool by_map = variant.visibility == Visibility::kMap;
  if (by_map != (variant.shadow_quads > 0) || variant.shadow_quads > LODEN_MAX_SHADOW_QUADS) return false;
  if ((by_map || variant.indirect) && !variant.near) return false;
  if (variant.visibility == Visibility::kDefault && variant.lookup != Lookup::kDefault) return false;
  if (variant.height_field && !hasRelief(variant)) return false;
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
    for (const bool height_field : {false, true}) {
      for (uint8_t bands = 0; bands <= kMostNearBands; ++bands) {
        for (const bool indirect : {false, true}) {
          for (const Visibility visibility : {Visibility::kNone, Visibility::kFast, Visibility::kDefault})
            addIfAllowed({true, bands, lookup, visibility, false, 0, 0, 0, height_field, indirect});
          for (uint8_t quads = 1; quads <= LODEN_MAX_SHADOW_QUADS; ++quads)
            addIfAllowed({true, bands, lookup, Visibility::kMap, false, 0, quads, 0, height_field, indirect});
        }
      }
      for (const bool nearest : {false, true})
        for (uint8_t bands = 1; bands <= LODEN_MAX_BANDS; ++bands)
          addIfAllowed({false, bands, lookup, Visibility::kNone, nearest, 0, 0, 0, height_field});
    }
  }
  return variants;
}

MaterialVariant narrowed(const MaterialVariant& variant, const Material& skeleton, LambdaRange range) {
  MaterialVariant left = variant;
  if (effortsAreOne(skeleton.geometry.side(), std::exp2(double(range.least)) / skeleton.side)) {
    if (left.lookup == Lookup::kDefault) left.lookup = Lookup::kFast;
    if (left.visibility == Visibility::kDefault) left.visibility = Visibility::kFast;
  }
  if (variant.bands == 0) return left;
  if (variant.near && range.most <= skeleton.surface->fade_begin) {
    left.bands = 0;
    left.bound_bands = variant.bands;
    return left;
  }
  if (variant.near && range.least >= skeleton.surface->fade_end) {
    left.near = left.indirect = false;
    left.visibility = Visibility::kNone, left.shadow_quads = 0;
  }
  const bool reads_p =
      left.near || std::any_of(skeleton.bands.begin(), skeleton.bands.end(), [&](const Band& b) {
        return b.domain == Domain::kFlat && range.least < b.window.out_end;
      });
  if (reads_p) return left;
  left.lookup = Lookup::kNone;
  left.height_field = false;
  return left;
}

std::optional<MaterialVariant> marchVariant(const MaterialVariant& variant) {
  if (!variant.near || !variant.height_field) return {};
  MaterialVariant marched = variant;
  marched.bound_bands = std::max(variant.bands, variant.bound_bands);
  marched.bands = 0;
  marched.visibility = Visibility::kNone;
  marched.shadow_quads = 0;
  marched.indirect = false;
  marched.lookup = Lookup::kFast;  // that is not called
  return marched;
}

int unitsOf(const MaterialVariant& variant) {
  if (!variant.shadesMaterial()) return 0;
  const int bands = std::max(variant.bands, variant.bound_bands);
  const int maps = variant.indirect ? 6 : variant.shadow_quads > 0 ? 5 : variant.near ? 3 : 0;
  return LODEN_UNITS(bands) + maps;
}

std::vector<std::string> variantDefines(const MaterialVariant& variant) {
  std::vector<std::string> defines;
  if (variant.near) defines.push_back("LODEN_NEAR 1");
  if (variant.visibility == Visibility::kFast) defines.push_back("LODEN_VISIBILITY_FAST 1");
  if (variant.visibility == Visibility::kDefault) defines.push_back("LODEN_VISIBILITY_DEFAULT 1");
  if (variant.shadow_quads > 0)
    defines.push_back("LODEN_VISIBILITY_MAP " + std::to_string(variant.shadow_quads));
  if (variant.indirect) defines.push_back("LODEN_INDIRECT 1");
  if (variant.bands > 0) defines.push_back("LODEN_BANDS " + std::to_string(variant.bands));
  if (variant.bound_bands > 0) defines.push_back("LODEN_BOUND_BANDS " + std::to_string(variant.bound_bands));
  if (variant.first_unit > 0) defines.push_back("LODEN_FIRST_UNIT " + std::to_string(variant.first_unit));
  if (variant.nearest_tables) defines.push_back("LODEN_TABLES_NEAREST 1");
  if (const char* define = lookupDefine(variant.lookup)) defines.push_back(define);
  if (variant.height_field) defines.push_back("LODEN_HEIGHT_FIELD 1");
  return defines;
}

std::string variantName(const MaterialVariant& variant) {
  if (!variant.shadesMaterial()) return "plain";
  std::string name = variant.near ? "near" : "";
  if (variant.bands > 0) name += (variant.near ? "-bands" : "bands") + std::to_string(variant.bands);
  if (variant.nearest_tables) name += "-nearest";
  name += "-";
  name += lookupName(variant.lookup);
  if (variant.height_field) name += "-heights";
  if (variant.visibility != Visibility::kNone)
    name += std::string("-shadows-") + visibilityName(variant.visibility);
  if (variant.shadow_quads > 0) name += std::to_string(variant.shadow_quads);
  if (variant.indirect) name += "-indirect";
  if (variant.bound_bands > 0) name += "-of" + std::to_string(variant.bound_bands);
  if (variant.first_unit > 0) name += "-from" + std::to_string(variant.first_unit);
  return name;
}

}  // namespace loden::runtime
