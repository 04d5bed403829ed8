// Reads and writes Bonn University's image folders: UBO2003 (JPEG), ATRIUM (JPEG and Radiance HDR), and
// others with the same file names.
//
//   tv030_pv030/00008 tl000 pl000 tv030 pv030.jpg
//
// tl and pl are theta and phi of the light, tv and pv those of the view, in degrees; decimals are allowed, in
// any order and either case. These keys count, not the running index. 8-bit images carry no radiometric
// calibration and are taken as sRGB; HDR and EXR are linear. A picture's top row is y = 1.
#pragma once

#include <optional>

#include "importer/base/picture.h"
#include "importer/btf/measured/measured.h"

namespace loden::importer {

// Whether the folder, or a folder in it, holds a file with such a name.
bool looksLikeBonnFolder(const std::filesystem::path& folder);
// The BTF in a folder. Every pair of the sampled directions must have its image. The images are read when a
// view is asked for.
Result<std::unique_ptr<MeasuredSource>> openBonnFolder(const std::filesystem::path& folder);

enum class BonnEncoding { kJpeg, kHdr, kExr };  // JPEG is clamped to [0, 1]
// Writes all images of a BTF; `quiet` as for Progress.
Status writeBonnFolder(const BtfSource& source, const std::filesystem::path& folder, BonnEncoding encoding,
                       int threads, bool quiet);

// The four angles of a file name, radians; nothing if it is not such a name.
struct BonnAngles {
  Spherical light, view;
};
std::optional<BonnAngles> parseBonnName(const std::string& file_name);

// The Radiance picture in a file. Its resolution line may be the usual "-Y h +X w", or "+X w -Y h" as in
// ATRIUM, whose scanlines are nevertheless rows, bottom row first. Other orders are refused.
Result<Picture> readRadiance(const std::filesystem::path& path);

}  // namespace loden::importer
