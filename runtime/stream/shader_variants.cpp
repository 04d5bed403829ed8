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
  switch (variant.kind) {
    case MaterialVariant::Kind::kNone:
      return row.none && variant == MaterialVariant{};
    case MaterialVariant::Kind::kSurface:
      return row.surface && variant.bands == 0 && !variant.nearest_tables && !variant.light_factor;
    case MaterialVariant::Kind::kBands:
      // The published VDIM and the nearest-direction images share texture units.
      return row.bands && variant.bands >= 1 && variant.bands <= LODEN_MAX_BANDS &&
             !(variant.nearest_tables && variant.lookup == Lookup::kPaper) &&
             !(variant.light_factor && (variant.nearest_tables || variant.lookup == Lookup::kPaper ||
                                        variant.bands > kMostLightFactorBands));
  }
  return false;
}

std::vector<MaterialVariant> rowVariants(const ProgramRow& row) {
  std::vector<MaterialVariant> variants;
  const auto addIfAllowed = [&](const MaterialVariant& variant) {
    if (rowAllows(row, variant)) variants.push_back(variant);
  };
  addIfAllowed({});
  for (const Lookup lookup : kLookups) {
    addIfAllowed({MaterialVariant::Kind::kSurface, 0, lookup});
    for (const bool nearest : {false, true})
      for (uint8_t bands = 1; bands <= LODEN_MAX_BANDS; ++bands)
        for (const bool light_factor : {false, true})
          addIfAllowed({MaterialVariant::Kind::kBands, bands, lookup, nearest, light_factor});
  }
  return variants;
}

int unitsOf(const MaterialVariant& variant) {
  if (variant.kind == MaterialVariant::Kind::kNone) return 0;
  return LODEN_UNITS(variant.kind == MaterialVariant::Kind::kSurface ? 1 : variant.bands);
}

std::vector<std::string> variantDefines(const MaterialVariant& variant) {
  std::vector<std::string> defines;
  if (variant.kind == MaterialVariant::Kind::kSurface) defines.push_back("LODEN_MODE_SURFACE 1");
  if (variant.kind == MaterialVariant::Kind::kBands)
    defines.push_back("LODEN_BANDS " + std::to_string(variant.bands));
  if (variant.first_unit > 0) defines.push_back("LODEN_FIRST_UNIT " + std::to_string(variant.first_unit));
  if (variant.nearest_tables) defines.push_back("LODEN_TABLES_NEAREST 1");
  if (variant.light_factor) defines.push_back("LODEN_LIGHT_FACTOR 1");
  if (const char* define = lookupDefine(variant.lookup)) defines.push_back(define);
  return defines;
}

std::string variantName(const MaterialVariant& variant) {
  if (variant.kind == MaterialVariant::Kind::kNone) return "plain";
  std::string name =
      variant.kind == MaterialVariant::Kind::kSurface ? "surface" : "bands" + std::to_string(variant.bands);
  if (variant.nearest_tables) name += "-nearest";
  if (variant.light_factor) name += "-light";
  name += "-";
  name += lookupName(variant.lookup);
  if (variant.first_unit > 0) name += "-from" + std::to_string(variant.first_unit);
  return name;
}

}  // namespace loden::runtime
