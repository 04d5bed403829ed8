// The version of Loden as preprocessor macros. CMakeLists.txt reads it from here.
#pragma once

#define LODEN_VERSION_MAJOR 0
#define LODEN_VERSION_MINOR 1
#define LODEN_VERSION_PATCH 0
#define LODEN_VERSION "0.1.0"
