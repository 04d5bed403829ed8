#include "runtime/shader/shader_assembly.h"

#include <algorithm>
#include <cctype>

#include "material/base/issues.h"
#include "shaders/shader_sources.h"

namespace loden::runtime {
namespace {

// The file named by `#include "name"`; empty if the line is none.
std::string_view includedFile(std::string_view line) {
  const size_t hash = line.find_first_not_of(" \t");
  if (hash == std::string_view::npos || line.substr(hash, 8) != "#include") return {};
  const size_t open = line.find('"', hash), close = line.find('"', open + 1);
  if (open == std::string_view::npos || close == std::string_view::npos) return {};
  return line.substr(open + 1, close - open - 1);
}

class Assembler {
 public:
  Status append(const std::string& name, std::string_view text) {
    const size_t file = result.files.size();
    result.files.push_back(name);
    mark(1, file);
    for (int line_number = 1; !text.empty(); ++line_number) {
      const size_t end = std::min(text.find('\n'), text.size());
      const std::string_view line = text.substr(0, end);
      text.remove_prefix(std::min(end + 1, text.size()));
      if (const std::string_view wanted = includedFile(line); wanted.empty()) {
        result.text.append(line) += '\n';
      } else {
        if (Status status = include(std::string(wanted), name, line_number); !status) return status;
        mark(line_number + 1, file);
      }
    }
    return {};
  }

  AssembledShader result;

 private:
  void mark(int line, size_t file) {
    result.text += "#line " + std::to_string(line) + " " + std::to_string(file) + "\n";
  }

  Status include(const std::string& wanted, const std::string& from, int line) {
    if (std::find(result.files.begin(), result.files.end(), wanted) != result.files.end()) return {};
    const std::string_view text = shaderSource(wanted);
    if (!text.empty()) return append(wanted, text);
    return Issue{issue_id::kShader, Severity::kError, from + ":" + std::to_string(line),
                 "no embedded shader file is named " + wanted};
  }
};

size_t digitsEnd(std::string_view text, size_t begin) {
  while (begin < text.size() && std::isdigit(static_cast<unsigned char>(text[begin]))) ++begin;
  return begin;
}

std::string namedLine(std::string_view line, std::span<const std::string> files) {
  const size_t begin = line.substr(0, 7) == "ERROR: " ? 7 : 0;
  const size_t end = digitsEnd(line, begin);
  if (end == begin || end - begin > 4 || end >= line.size() || (line[end] != ':' && line[end] != '('))
    return std::string(line);
  const size_t file = size_t(std::stoi(std::string(line.substr(begin, end - begin))));
  if (file >= files.size()) return std::string(line);
  return std::string(line.substr(0, begin)) + files[file] + std::string(line.substr(end));
}

}  // namespace

Result<AssembledShader> assembleShader(const std::string& name, std::string_view text,
                                       std::span<const std::string> defines) {
  Assembler assembler;
  assembler.result.text = "#version 450 core\n";
  for (const std::string& define : defines) assembler.result.text += "#define " + define + "\n";
  if (Status status = assembler.append(name, text); !status) return status.issue();
  return std::move(assembler.result);
}

std::string namedShaderLog(std::string_view log, std::span<const std::string> files) {
  std::string named;
  while (!log.empty()) {
    const size_t end = std::min(log.find('\n'), log.size());
    named += namedLine(log.substr(0, end), files) + "\n";
    log.remove_prefix(std::min(end + 1, log.size()));
  }
  while (!named.empty() && (named.back() == '\n' || named.back() == '\0')) named.pop_back();
  return named;
}

}  // namespace loden::runtime
