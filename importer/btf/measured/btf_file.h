// Reads Bonn University's binary .btf files: DFMF (UBO2014), FMF, PVF and BDI. The values are decoded view by
// view from the memory-mapped file. Layouts are those of btflib (Bonn) and btf.hh; the first row of a file is
// y = 1.
#pragma once

#include "importer/btf/measured/measured.h"

namespace loden::importer {

// The BTF in a file. Anything that is not exactly this format is refused, with the place in the file: a wrong
// signature, counts whose products do not fit the file's length (in 64 bit, before anything is allocated),
// and light lists that differ between views by more than rounding. Parts of the format that this reader does
// not support are refused by name: spectral channels, Lab, compressed chunks, and texels that a mask leaves
// out.
Result<std::unique_ptr<MeasuredSource>> openBtfFile(const std::filesystem::path& path);

}  // namespace loden::importer
