// Any bytes as a measured BTF (.btf): no crash, no runaway allocation, and what is accepted gives views of
// the size that it says.
#include <cstdint>

#include "importer/btf/measured/btf_file.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using loden::fuzz::require;
  static const loden::fuzz::InputFolder folder;
  const auto source =
      loden::importer::openBtfFile(folder.write("input.btf", loden::fuzz::textOf(data, size)));
  if (!source) return 0;
  const glm::ivec2 texels = (*source)->size();
  const size_t lights = (*source)->lights().samples.size(), views = (*source)->views().samples.size();
  require(texels.x > 0 && texels.y > 0 && lights > 0 && views > 0);
  for (const size_t view : {size_t(0), views - 1}) {
    const auto values = (*source)->view(static_cast<int>(view));
    if (values) require(values->size() == lights * size_t(texels.x) * size_t(texels.y));
  }
  return 0;
}
