#include "rilievo/web_walk/plane16.h"

#include <zlib.h>

#include <algorithm>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

enum Predictor : std::uint8_t { kNone, kPlane, kMedian, kPredictors };

std::uint16_t predicted(const Image<std::uint16_t>& plane, int x, int y, std::uint8_t predictor) {
  if (predictor == kNone) return 0;
  const int w = x > 0 ? plane(x - 1, y) : 0, n = y > 0 ? plane(x, y - 1) : 0;
  const int nw = x > 0 && y > 0 ? plane(x - 1, y - 1) : 0;
  const int affine = w + n - nw;
  if (predictor == kPlane) return std::uint16_t(affine);
  return std::uint16_t(std::clamp(affine, std::min(w, n), std::max(w, n)));
}

}  // namespace

std::vector<std::uint8_t> encode_plane16(const Image<std::uint16_t>& plane) {
  const std::size_t count = plane.texels().size();
  std::vector<std::uint8_t> best;
  for (std::uint8_t predictor = kNone; predictor < kPredictors; ++predictor) {
    std::vector<std::uint8_t> raw(1 + 2 * count);
    raw[0] = predictor;
    std::size_t i = 0;
    for (int y = 0; y < plane.height(); ++y)
      for (int x = 0; x < plane.width(); ++x, ++i) {
        const std::uint16_t off = std::uint16_t(plane(x, y) - predicted(plane, x, y, predictor));
        const std::uint16_t folded = std::uint16_t((off << 1) ^ ((off & 0x8000) ? 0xFFFF : 0));
        raw[1 + i] = std::uint8_t(folded & 0xFF);
        raw[1 + count + i] = std::uint8_t(folded >> 8);
      }
    uLongf size = compressBound(uLong(raw.size()));
    std::vector<std::uint8_t> packed(size);
    // Fails only without memory.
    const int done = compress2(packed.data(), &size, raw.data(), uLong(raw.size()), 9);
    RILIEVO_EXPECTS(done == Z_OK);
    (void)done;
    packed.resize(size);
    if (best.empty() || packed.size() < best.size()) best = std::move(packed);
  }
  return best;
}

Result<Image<std::uint16_t>> decode_plane16(std::span<const std::uint8_t> bytes, int width,
                                            int height) {
  Image<std::uint16_t> plane(width, height);
  const std::size_t count = plane.texels().size();
  std::vector<std::uint8_t> raw(1 + 2 * count);
  uLongf size = uLongf(raw.size());
  if (uncompress(raw.data(), &size, bytes.data(), uLong(bytes.size())) != Z_OK ||
      size != raw.size() || raw[0] >= kPredictors)
    return Error{"plane", "is damaged or has another size"};
  std::size_t i = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x, ++i) {
      const std::uint16_t folded = std::uint16_t(raw[1 + i] | raw[1 + count + i] << 8);
      const std::uint16_t off = std::uint16_t((folded >> 1) ^ ((folded & 1) ? 0xFFFF : 0));
      plane(x, y) = std::uint16_t(predicted(plane, x, y, raw[0]) + off);
    }
  return plane;
}

}  // namespace rilievo
