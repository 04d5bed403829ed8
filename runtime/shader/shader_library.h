// Programs by name and material variant: assembled from the embedded GLSL, compiled when first asked for, and
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
  // Driver binaries by hash of driver and source; empty: none are kept. A damaged or foreign file is ignored.
  std::filesystem::path cache_folder;
};

struct ShaderStats {
  int compiled = 0;    // from source
  int from_cache = 0;  // from a binary on disk
  double seconds = 0;  // spent in both
};

class ShaderLibrary {
 public:
  // The device must outlive the library.
  ShaderLibrary(const Device& device, ShaderLibraryOptions options);

  // GL name of the program, owned by the library and valid until it is destroyed or the context is lost.
  // kShader with file and line if it does not compile, or if no row of the list allows it.
  Result<uint32_t> program(std::string_view row, const MaterialVariant& variant);

  // Forgets all programs of a context that is gone; they are compiled again when asked for.
  void contextLost();
  const ShaderStats& stats() const { return stats_; }

 private:
  Result<GlProgram> build(const ProgramRow& row, const MaterialVariant& variant, const std::string& label);

  const Device* device_;
  ShaderLibraryOptions options_;
  std::map<std::string, GlProgram, std::less<>> programs_;
  ShaderStats stats_;
};

// Low level: text with `#include "loden_material.glsl"` lines, resolved among the embedded files, each file
// at most once. `defines` become `#define` lines after `#version 450 core`.
struct ShaderText {
  std::string name;  // for messages
  std::string text;
};
// A linked program, compiled from source; an empty fragment text gives a program without a fragment stage.
Result<GlProgram> compileProgram(const ShaderText& vertex, const ShaderText& fragment,
                                 std::span<const std::string> defines, std::string_view label);

}  // namespace loden::runtime
