#include "importer/study/study.h"

namespace loden::importer {
namespace {

constexpr Study kStudies[] = {
    {"flat-reconstruction", "reference BTF against the Flat-BTF read back (FBTF table 1)",
     studyFlatReconstruction, true},
    {"vdim-interpolation", "looked-up against traced parameters between the views (FBTF figure 10)",
     studyVdimInterpolation},
    {"curved-lookup", "the lookup on a cylinder and a sphere against the bent tile (FBTF section 3.1)",
     studyCurvedLookup},
    {"view-coherence", "how much a texel's light vector changes with the view (FBTF table 2)",
     studyViewCoherence},
    {"abrdf-size", "PNG and JPEG bytes of every texel's ABRDF (FBTF table 3)", studyAbrdfSize},
    {"lod-fit", "error per channel against components, mode and bytes (LBTF table 1, figure 6)", studyLodFit},
    {"minification", "the value at lambda 0 to 6 against the area-averaged truth (LBTF figure 7)",
     studyMinification},
    {"lab-bounds", "what keeps the mean Lab distance up: lookup, components, chroma", studyLabBounds},
};

}  // namespace

std::span<const Study> studies() {
  return kStudies;
}

const Study* findStudy(std::string_view name) {
  for (const Study& study : kStudies)
    if (study.name == name) return &study;
  return nullptr;
}

}  // namespace loden::importer
