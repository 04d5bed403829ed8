# Writes OUTPUT, a C++ file that holds the text of FILES as raw strings (in pieces: compilers limit literals).
set(text "// Generated from shaders/*.glsl.\n#include \"shaders/shader_sources.h\"\n\nnamespace loden {\n\n")
set(table "")
foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME)
  file(READ ${file} content)
  string(LENGTH "${content}" length)
  set(literal "")
  set(at 0)
  while(at LESS length)
    string(SUBSTRING "${content}" ${at} 8000 piece)
    string(APPEND literal "R\"~~(${piece})~~\"\n")
    math(EXPR at "${at} + 8000")
  endwhile()
  string(APPEND table "      {\"${name}\",\n${literal}},\n")
endforeach()
string(APPEND text
       "std::span<const ShaderSource> shaderSources() {\n"
       "  static constexpr ShaderSource kSources[] = {\n${table}  };\n"
       "  return kSources;\n}\n\n"
       "std::string_view shaderSource(std::string_view name) {\n"
       "  for (const ShaderSource& source : shaderSources())\n"
       "    if (source.name == name) return source.text;\n"
       "  return {};\n}\n\n"
       "}  // namespace loden\n")
file(WRITE ${OUTPUT} "${text}")
