// What the texture coordinates of a material's surfaces measure, where the scene's nodes put these. Not
// installed.
#pragma once

#include "importer/gltf/gltf_accessor.h"
#include "importer/gltf/gltf_document.h"
#include "material/model/uv_survey.h"

namespace loden::importer {

// Of every triangle of the default scene that wears the material. Skinned meshes are taken in the pose that
// their skin was made in. What cannot be read, such as compressed meshes, is left out: then there may be
// nothing.
UvSurvey surveyUvs(const nlohmann::ordered_json& scene, GltfBuffers& buffers, int64_t material,
                   int tex_coord);

}  // namespace loden::importer
