// Materials with known answers: smooth bands, and planes below the reference surface.
#pragma once

#include "material/model/material.h"

namespace loden::stress {

// The eigen BRDF of a component of smoothMaterial's band: a smooth function of the two directions, from about
// -1 to 1.
double smoothEigenValue(int component, const glm::dvec3& wi, const glm::dvec3& wo);

// A material of mode lod whose mean is Lambert, with one linear band of two quads of Y and one of chroma over
// `side` texels, with all mips, in 32-bit floats. Its weights are smoothWeight at the texels; its table is
// smoothEigenValue at the nodes.
Material smoothMaterial(int side = 8);
double smoothWeight(int component, glm::dvec2 x);
// The value of smoothMaterial in double, from its definition alone: no stored table or texture is read.
glm::dvec3 smoothValue(int side, glm::dvec2 x, double lambda, const glm::dvec3& wi, const glm::dvec3& wo);

// The material with its first band in another format. If the format holds -1 to 1 only, each component is
// divided by its largest magnitude.
Material stored(const Material& exact, TexelFormat format);

// A plane `depth` tile lengths below the reference surface, with `side` texels per side. Without `identity`
// the image does not claim to be a height field.
GeometryImage planeImage(int side, double depth, bool identity = true);

// A material of mode surface on a plane at that depth: white Lambert without shadows, with normals (0, 0, 1).
Material planeMaterial(double depth);

// The height field z = -depth (1 - cos(4 pi x) cos(4 pi y)) / 2, as a function and as an image.
double bumpHeight(glm::dvec2 p, double depth);
GeometryImage bumpImage(int side, double depth);

// Materials of every mode, layout, filter and lobe; those with a near term have cast shadows.
std::vector<Material> edgeMaterials();

}  // namespace loden::stress
