// GLSL's words for glsl.h, until glsl_end.h.
#define float double
#define const static constexpr
#define xy xy_()
#define yx yx_()
#define wzxy wzxy_()
#define LODEN_COUNT(unit, n) (loden_fetches += (n))
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"  // that other variants use
#ifndef __clang__
#pragma GCC diagnostic ignored "-Warray-bounds"  // loops over LodenEffort.layers, which is 3 at most
#endif
