#include "runtime/stream/image_parts.h"

#include <algorithm>

namespace loden::runtime {
namespace {

constexpr int kTailSide = 64;

int sideOf(const Texture& mips, int mip) {
  return std::max(mips.mipWidth(mip), mips.mipHeight(mip));
}

}  // namespace

std::vector<PartPlan> planImageParts(const Texture& mips, bool mipmapped, int most_side) {
  const int last = mips.mips - 1;
  int tail = 0;
  while (sideOf(mips, tail) > kTailSide) ++tail;
  std::vector<PartPlan> parts;
  for (int mip = tail; mip >= 0 && sideOf(mips, mip) <= most_side; --mip) {
    PartPlan part;
    part.first_mip = mip;
    part.mips = mipmapped ? last - mip + 1 : 1;
    for (int k = mip; k < mip + part.mips; ++k) part.desc.bytes += mips.mipBytes(k);
    // Without the tail the coarsest mip alone is shown.
    part.desc.lambda_end = static_cast<float>(mip == tail ? std::max(last, mip + 1) : mip + 1);
    part.desc.takes_over = mip < tail;
    parts.push_back(part);
  }
  return parts;
}

PartTexture imagePart(const ImageTexture& image, const PartPlan& plan) {
  PartTexture part;
  part.plain_2d = true;
  part.image = image.mips;
  part.first_mip = plan.first_mip;
  part.mips = plan.mips;
  part.srgb = image.srgb;
  return part;
}

}  // namespace loden::runtime
