// Bonn's binary .btf files: DFMF (UBO2014), FMF, PVF and BDI. The values are decoded view by view from the
// mapped file. Layouts after btflib (Bonn) and btf.hh; the first row of a file is y = 1.
#pragma once

#include "importer/btf/measured/measured.h"

namespace loden::importer {

// Refuses, with the place in the file, whatever is not exactly this format: a wrong signature, counts whose
// products do not fit the file's length (in 64 bit, before anything is allocated), light lists that differ
// between views by more than rounding. What the format allows and this reader does not know is refused by its
// name: spectral channels, Lab, compressed chunks, texels that a mask leaves out.
Result<std::unique_ptr<MeasuredSource>> openBtfFile(const std::filesystem::path& path);

}  // namespace loden::importer
