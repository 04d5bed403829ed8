#include "runtime/shader/shader_library.h"

#include <epoxy/gl.h>

#include <chrono>

#include "material/base/issues.h"
#include "runtime/gl/program_cache.h"
#include "runtime/shader/shader_assembly.h"
#include "shaders/shader_sources.h"

namespace loden::runtime {
namespace {

struct AssembledProgram {
  AssembledShader vertex, fragment;  // an empty fragment text: no fragment stage
};

Result<AssembledProgram> assembleProgram(const ShaderText& vertex, const ShaderText& fragment,
                                         std::span<const std::string> defines) {
  AssembledProgram program;
  Result<AssembledShader> stage = assembleShader(vertex.name, vertex.text, defines);
  if (!stage) return stage.issue();
  program.vertex = std::move(*stage);
  if (fragment.text.empty()) return program;
  stage = assembleShader(fragment.name, fragment.text, defines);
  if (!stage) return stage.issue();
  program.fragment = std::move(*stage);
  return program;
}

// Shader names live only as long as a link takes.
class ShaderName {
 public:
  explicit ShaderName(GLenum stage) : name_(glCreateShader(stage)) {}
  ~ShaderName() { glDeleteShader(name_); }
  ShaderName(const ShaderName&) = delete;
  ShaderName& operator=(const ShaderName&) = delete;
  GLuint name() const { return name_; }

 private:
  GLuint name_;
};

std::string shaderLog(GLuint shader) {
  GLint length = 0;
  glGetShaderiv(shader, GL_INFO_LOG_LENGTH, &length);
  std::string log(size_t(std::max(length, 1)), '\0');
  glGetShaderInfoLog(shader, length, nullptr, log.data());
  return log;
}

std::string programLog(GLuint program) {
  GLint length = 0;
  glGetProgramiv(program, GL_INFO_LOG_LENGTH, &length);
  std::string log(size_t(std::max(length, 1)), '\0');
  glGetProgramInfoLog(program, length, nullptr, log.data());
  return log;
}

Status compileStage(const ShaderName& shader, const AssembledShader& source, std::string_view label) {
  const char* text = source.text.c_str();
  glShaderSource(shader.name(), 1, &text, nullptr);
  glCompileShader(shader.name());
  glObjectLabel(GL_SHADER, shader.name(), GLsizei(label.size()), label.data());
  GLint compiled = 0;
  glGetShaderiv(shader.name(), GL_COMPILE_STATUS, &compiled);
  if (compiled) return {};
  return Issue{issue_id::kShader, Severity::kError, source.files.front(),
               namedShaderLog(shaderLog(shader.name()), source.files)};
}

Result<GlProgram> linkProgram(const AssembledProgram& source, std::string_view label) {
  GlProgram program(glCreateProgram());
  setGlLabel(GlKind::kProgram, program.name(), label);
  const ShaderName vertex(GL_VERTEX_SHADER), fragment(GL_FRAGMENT_SHADER);
  if (Status status = compileStage(vertex, source.vertex, label); !status) return status.issue();
  glAttachShader(program.name(), vertex.name());
  const bool has_fragment = !source.fragment.text.empty();
  if (has_fragment) {
    if (Status status = compileStage(fragment, source.fragment, label); !status) return status.issue();
    glAttachShader(program.name(), fragment.name());
  }
  glProgramParameteri(program.name(), GL_PROGRAM_BINARY_RETRIEVABLE_HINT, GL_TRUE);
  glLinkProgram(program.name());
  glDetachShader(program.name(), vertex.name());
  if (has_fragment) glDetachShader(program.name(), fragment.name());
  GLint linked = 0;
  glGetProgramiv(program.name(), GL_LINK_STATUS, &linked);
  if (linked) return program;
  return Issue{issue_id::kShader, Severity::kError, std::string(label),
               namedShaderLog(programLog(program.name()), source.fragment.files)};
}

}  // namespace

Result<GlProgram> compileProgram(const ShaderText& vertex, const ShaderText& fragment,
                                 std::span<const std::string> defines, std::string_view label) {
  Result<AssembledProgram> source = assembleProgram(vertex, fragment, defines);
  if (!source) return source.issue();
  return linkProgram(*source, label);
}

ShaderLibrary::ShaderLibrary(const Device& device, ShaderLibraryOptions options)
    : device_(&device), options_(std::move(options)) {}

Result<uint32_t> ShaderLibrary::program(std::string_view row_name, const MaterialVariant& variant) {
  const std::string label = std::string(row_name) + " " + variantName(variant);
  if (const auto found = programs_.find(label); found != programs_.end()) return found->second.name();
  const ProgramRow* row = findProgramRow(row_name);
  if (row == nullptr || !rowAllows(*row, variant))
    return Issue{issue_id::kShader, Severity::kError, label,
                 "no row of runtime/stream/shader_variants.h allows this program"};
  const auto start = std::chrono::steady_clock::now();
  Result<GlProgram> program = build(*row, variant, label);
  stats_.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!program) return program.issue();
  const uint32_t name = program->name();
  programs_.emplace(label, std::move(*program));
  return name;
}

Result<GlProgram> ShaderLibrary::build(const ProgramRow& row, const MaterialVariant& variant,
                                       const std::string& label) {
  const auto entry = [](std::string_view file) {
    return ShaderText{std::string(file), std::string(file.empty() ? "" : shaderSource(file))};
  };
  std::vector<std::string> defines = variantDefines(variant);
  for (const std::string_view define : row.defines)
    if (!define.empty()) defines.emplace_back(define);
  const ShaderText vertex = entry(row.vertex), fragment = entry(row.fragment);
  for (const ShaderText* file : {&vertex, &fragment})
    if (file->text.empty() && !file->name.empty())
      return Issue{issue_id::kShader, Severity::kError, label,
                   "no embedded shader file is named " + file->name};
  Result<AssembledProgram> source = assembleProgram(vertex, fragment, defines);
  if (!source) return source.issue();

  const ProgramCache cache(*device_, options_.cache_folder);
  const uint64_t key = cache.key(source->vertex.text, source->fragment.text);
  if (GlProgram program = cache.load(key)) {
    setGlLabel(GlKind::kProgram, program.name(), label);
    ++stats_.from_cache;
    return program;
  }
  Result<GlProgram> program = linkProgram(*source, label);
  if (!program) return program.issue();
  ++stats_.compiled;
  cache.store(key, *program);
  return program;
}

void ShaderLibrary::contextLost() {
  for (auto& [label, program] : programs_) program.release();
  programs_.clear();
}

}  // namespace loden::runtime
