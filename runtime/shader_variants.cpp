#include "runtime/shader_variants.h"

#include "material/check.h"

namespace loden::runtime {
namespace {

struct LookupName {
  Lookup lookup;
  const char* define;
  const char* name;
};
constexpr LookupName kLookups[] = {{Lookup::kNone, "LODEN_LOOKUP_NONE", "none"},
                                   {Lookup::kPaper, "LODEN_LOOKUP_PAPER", "paper"},
                                   {Lookup::kFast, "LODEN_LOOKUP_FAST", "fast"},
                                   {Lookup::kDefault, "LODEN_LOOKUP_DEFAULT", "default"}};

const LookupName& lookupName(Lookup lookup) {
  LODEN_CHECK_LT(size_t(lookup), std::size(kLookups));
  return kLookups[size_t(lookup)];
}

}  // namespace

const ProgramRow* findProgramRow(std::string_view name) {
  for (const ProgramRow& row : kProgramRows)
    if (row.name == name) return &row;
  return nullptr;
}

bool rowAllows(const ProgramRow& row, const MaterialVariant& variant) {
  switch (variant.kind) {
    case MaterialVariant::Kind::kNone: return row.none && variant == MaterialVariant{};
    case MaterialVariant::Kind::kSurface: return row.surface && variant.bands == 0;
    case MaterialVariant::Kind::kBands: return row.bands && variant.bands >= 1 && variant.bands <= kMaxShaderBands;
  }
  return false;
}

std::vector<MaterialVariant> rowVariants(const ProgramRow& row) {
  std::vector<MaterialVariant> variants;
  if (row.none) variants.push_back({});
  for (const LookupName& lookup : kLookups)
    for (const bool counted : {false, true}) {
      if (row.surface) variants.push_back({MaterialVariant::Kind::kSurface, 0, lookup.lookup, counted});
      for (uint8_t bands = 1; row.bands && bands <= kMaxShaderBands; ++bands)
        variants.push_back({MaterialVariant::Kind::kBands, bands, lookup.lookup, counted});
    }
  return variants;
}

std::vector<std::string> variantDefines(const MaterialVariant& variant) {
  if (variant.kind == MaterialVariant::Kind::kNone) return {};
  std::vector<std::string> defines;
  if (variant.kind == MaterialVariant::Kind::kSurface) {
    defines.push_back("LODEN_MODE_SURFACE 1");
  } else {
    defines.push_back("LODEN_MODE_BANDS 1");
    defines.push_back("LODEN_BANDS " + std::to_string(variant.bands));
  }
  defines.push_back(std::string(lookupName(variant.lookup).define) + " 1");
  if (variant.count_fetches) defines.push_back("LODEN_COUNT_FETCHES 1");
  return defines;
}

std::string variantName(const MaterialVariant& variant) {
  if (variant.kind == MaterialVariant::Kind::kNone) return "plain";
  std::string name = variant.kind == MaterialVariant::Kind::kSurface ? "surface" : "bands" + std::to_string(variant.bands);
  name += std::string("-") + lookupName(variant.lookup).name;
  return variant.count_fetches ? name + "-counted" : name;
}

}  // namespace loden::runtime
