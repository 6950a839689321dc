#include "rilievo/measure/psnr.h"

#include <cmath>
#include <cstdint>
#include <limits>

namespace rilievo {
namespace {

std::uint64_t squared_difference(std::span<const glm::u8vec4> a, std::span<const glm::u8vec4> b) {
  std::uint64_t sum = 0;
  for (std::size_t x = 0; x < a.size(); ++x) {
    const int r = int(a[x].r) - int(b[x].r);
    const int g = int(a[x].g) - int(b[x].g);
    const int l = int(a[x].b) - int(b[x].b);
    sum += std::uint32_t(r * r + g * g + l * l);
  }
  return sum;
}

}  // namespace

double psnr_db(const Rgba8Image& a, const Rgba8Image& b) {
  RILIEVO_EXPECTS(!a.empty() && a.width() == b.width() && a.height() == b.height());
  const std::uint64_t sum = squared_difference(a.texels(), b.texels());
  if (sum == 0) return std::numeric_limits<double>::infinity();
  const double mean = double(sum) / (3.0 * double(a.texels().size()));
  return 10.0 * std::log10(255.0 * 255.0 / mean);
}

}  // namespace rilievo
