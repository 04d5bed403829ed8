// GL programs by row name and material variant: assembled from the embedded GLSL, compiled on first use, and
// kept on disk as driver binaries.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "material/base/result.h"
#include "runtime/gl/device.h"
#include "runtime/gl/gl_objects.h"
#include "runtime/stream/shader_variants.h"

namespace loden::runtime {

struct ShaderLibraryOptions {
  // Folder for driver binaries, which are named by a hash of driver and source; empty: none are kept. Damaged
  // or foreign files in it are ignored.
  std::filesystem::path cache_folder;
};

struct ShaderStats {
  int compiled = 0;    // programs compiled from source
  int from_cache = 0;  // programs loaded from a binary on disk
  double seconds = 0;  // time spent on both
};

class ShaderLibrary {
 public:
  // The device must outlive the library.
  ShaderLibrary(const Device& device, ShaderLibraryOptions options);

  // The GL name of the program, owned by the library and valid until the library is destroyed or the context
  // is lost. Issues: kShader, with file and line, if it does not compile, or if no row of kProgramRows allows
  // it.
  Result<uint32_t> program(std::string_view row, const MaterialVariant& variant);

  // Forgets all programs, whose context is gone; they are compiled again on their next use.
  void contextLost();
  const ShaderStats& stats() const { return stats_; }

 private:
  Result<GlProgram> build(const ProgramRow& row, const MaterialVariant& variant, const std::string& label);

  const Device* device_;
  ShaderLibraryOptions options_;
  std::map<std::string, GlProgram, std::less<>> programs_;
  ShaderStats stats_;
};

// GLSL text with `#include "name"` lines, which compileProgram resolves among the embedded files, each file
// at most once.
struct ShaderText {
  std::string name;  // the name used in messages
  std::string text;
};
// A linked program, compiled from source. `defines` become `#define` lines after `#version 450 core`. An
// empty fragment text gives a program without a fragment stage.
Result<GlProgram> compileProgram(const ShaderText& vertex, const ShaderText& fragment,
                                 std::span<const std::string> defines, std::string_view label);

}  // namespace loden::runtime
