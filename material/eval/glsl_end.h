// Takes glsl_begin.h back.
#undef float
#undef const
#undef xy
#undef yx
#undef wzxy
#undef LODEN_COUNT
#pragma GCC diagnostic pop
