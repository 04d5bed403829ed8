// Measures the texture coordinates of a material's surfaces, at the places where the scene's nodes put them.
// Not installed.
#pragma once

#include "importer/gltf/gltf_accessor.h"
#include "importer/gltf/gltf_document.h"
#include "material/model/uv_survey.h"

namespace loden::importer {

// The survey of every triangle of the default scene that has the material. Skinned meshes are taken in the
// pose in which their skin was made. Meshes that cannot be read, such as compressed ones, are left out, so
// that the survey may be empty.
UvSurvey surveyUvs(const nlohmann::ordered_json& scene, GltfBuffers& buffers, int64_t material,
                   int tex_coord);

}  // namespace loden::importer
