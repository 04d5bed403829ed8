// Materials with known answers: smooth bands, and planes below the reference surface.
#pragma once

#include "material/model/material.h"

namespace loden::stress {

// Y of the band below for a pair of directions and a component, smooth, in about -1..1.
double smoothEigenValue(int component, const glm::dvec3& wi, const glm::dvec3& wo);

// Mode lod: one linear band of two quads of Y and one of chroma over `side` texels with all mips, whose
// weights are smoothWeight and whose table is smoothEigenValue at its nodes, in 32-bit floats; mean Lambert.
Material smoothMaterial(int side = 8);
double smoothWeight(int component, glm::dvec2 x);
// What smoothMaterial shows, by its definition alone, in double: no stored table or texture is read.
glm::dvec3 smoothValue(int side, glm::dvec2 x, double lambda, const glm::dvec3& wi, const glm::dvec3& wo);

// The first band of `exact` in another format; where that holds -1 to 1 only, each component is divided by
// its largest magnitude.
Material stored(const Material& exact, TexelFormat format);

// A plane `depth` tile lengths below the reference surface, of a side of texels.
GeometryImage planeImage(int side, double depth, bool identity = true);

// Mode surface: white Lambert without shadows on such a plane, its normals (0, 0, 1).
Material planeMaterial(double depth);

// A height field: z = -depth (1 - cos(4 pi x) cos(4 pi y)) / 2.
double bumpHeight(glm::dvec2 p, double depth);
GeometryImage bumpImage(int side, double depth);

// One of each kind: every mode, layout, filter and lobe, with cast shadows where there is a near term.
std::vector<Material> edgeMaterials();

}  // namespace loden::stress
