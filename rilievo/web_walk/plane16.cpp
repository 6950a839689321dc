#include "rilievo/web_walk/plane16.h"

#include <zlib.h>

#include <algorithm>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

enum Predictor : std::uint8_t { kNone, kPlane, kMedian, kPredictors };

// From the west and the north, and from the plane through these and the north-west.
int predicted(std::uint8_t predictor, int w, int n, int affine) {
  if (predictor == kMedian) return std::max(std::min(w, n), std::min(affine, std::max(w, n)));
  return predictor == kPlane ? affine : 0;
}

// A row's differences from what a predictor says, folded, as low and high bytes. `above` is the row
// before, and both rows have a 0 before their first texel.
template <Predictor predictor>
void fold_row(const std::uint16_t* row, const std::uint16_t* above, int width, std::uint8_t* low,
              std::uint8_t* high) {
  for (int x = 0; x < width; ++x) {
    const int w = row[x], n = above[x + 1], affine = w + n - above[x];
    const std::int16_t off = std::int16_t(row[x + 1] - predicted(predictor, w, n, affine));
    const std::uint16_t folded = std::uint16_t((off * 2) ^ (off >> 15));
    low[x] = std::uint8_t(folded & 0xFF), high[x] = std::uint8_t(folded >> 8);
  }
}

// All rows, behind the predictor's number: the low bytes of all, and then the high ones.
template <Predictor predictor>
std::vector<std::uint8_t> fold(const Image<std::uint16_t>& plane) {
  const std::size_t count = plane.texels().size(), width = std::size_t(plane.width());
  std::vector<std::uint8_t> raw(1 + 2 * count);
  raw[0] = predictor;
  std::vector<std::uint16_t> above(width + 1), row(width + 1);
  for (int y = 0; y < plane.height(); ++y) {
    std::ranges::copy(plane.row(y), row.begin() + 1);
    std::uint8_t* const low = raw.data() + 1 + std::size_t(y) * width;
    fold_row<predictor>(row.data(), above.data(), plane.width(), low, low + count);
    std::swap(row, above);
  }
  return raw;
}

// And back.
void unfold_row(std::uint8_t predictor, const std::uint16_t* above, const std::uint8_t* low,
                const std::uint8_t* high, std::span<std::uint16_t> row) {
  int w = 0, nw = 0;
  for (std::size_t x = 0; x < row.size(); ++x) {
    const int folded = low[x] | high[x] << 8, n = above[x], affine = w + n - nw;
    row[x] = std::uint16_t(predicted(predictor, w, n, affine) + ((folded >> 1) ^ -(folded & 1)));
    w = row[x], nw = n;
  }
}

}  // namespace

std::vector<std::uint8_t> encode_plane16_quickly(const Image<std::uint16_t>& plane) {
  std::vector<std::uint8_t> raw = fold<kMedian>(plane);
  z_stream stream{};
  // Runs and Huffman codes: what is left after the prediction repeats in no other way.
  int done = deflateInit2(&stream, 1, Z_DEFLATED, 15, 9, Z_RLE);
  RILIEVO_EXPECTS(done == Z_OK);
  std::vector<std::uint8_t> packed(deflateBound(&stream, uLong(raw.size())));
  stream.next_in = raw.data(), stream.avail_in = uInt(raw.size());
  stream.next_out = packed.data(), stream.avail_out = uInt(packed.size());
  done = deflate(&stream, Z_FINISH);
  RILIEVO_EXPECTS(done == Z_STREAM_END);
  (void)done;
  packed.resize(stream.total_out);
  packed.shrink_to_fit();  // it is a fiftieth of the bound, and may be kept
  deflateEnd(&stream);
  return packed;
}

std::vector<std::uint8_t> encode_plane16(const Image<std::uint16_t>& plane) {
  std::vector<std::uint8_t> best;
  for (const auto& raw : {fold<kNone>(plane), fold<kPlane>(plane), fold<kMedian>(plane)}) {
    uLongf size = compressBound(uLong(raw.size()));
    std::vector<std::uint8_t> packed(size);
    // Fails only without memory.
    const int done = compress2(packed.data(), &size, raw.data(), uLong(raw.size()), 9);
    RILIEVO_EXPECTS(done == Z_OK);
    (void)done;
    packed.resize(size);
    packed.shrink_to_fit();
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
  const std::vector<std::uint16_t> zeros(std::size_t(width), std::uint16_t(0));
  for (int y = 0; y < height; ++y) {
    const std::size_t at = 1 + std::size_t(y) * std::size_t(width);
    unfold_row(raw[0], y > 0 ? plane.row(y - 1).data() : zeros.data(), &raw[at], &raw[at + count],
               plane.row(y));
  }
  return plane;
}

}  // namespace rilievo
