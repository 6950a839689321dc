#include "bench/depth_coders.h"

#include <zlib.h>

#include <cstdlib>

namespace rilievo::bench {
namespace {

// Numbers of any size, 3 bits at a time, eight of these in a word.
class RvlWriter {
 public:
  void add(std::uint32_t value) {
    do {
      std::uint32_t nibble = value & 7;
      value >>= 3;
      if (value) nibble |= 8;
      word_ = word_ << 4 | nibble;
      if (++count_ == 8) words_.push_back(word_), count_ = 0, word_ = 0;
    } while (value);
  }
  [[nodiscard]] std::vector<std::uint32_t> take() {
    if (count_ > 0) words_.push_back(word_ << (4 * (8 - count_)));
    return std::move(words_);
  }

 private:
  std::vector<std::uint32_t> words_;
  std::uint32_t word_ = 0;
  int count_ = 0;
};

class RvlReader {
 public:
  explicit RvlReader(const std::vector<std::uint32_t>& words) : words_(words) {}
  std::uint32_t next() {
    std::uint32_t value = 0;
    for (int shift = 0;; shift += 3) {
      const std::uint32_t nibble = words_[at_ / 8] >> (28 - 4 * (at_ % 8)) & 15;
      ++at_;
      value |= (nibble & 7) << shift;
      if (!(nibble & 8)) return value;
    }
  }

 private:
  const std::vector<std::uint32_t>& words_;
  std::size_t at_ = 0;
};

std::vector<std::uint8_t> packed(const std::vector<std::uint8_t>& raw) {
  uLongf size = compressBound(uLong(raw.size()));
  std::vector<std::uint8_t> out(size);
  if (compress2(out.data(), &size, raw.data(), uLong(raw.size()), 6) != Z_OK) size = 0;
  out.resize(size);
  return out;
}

int paeth(int a, int b, int c) {
  const int p = a + b - c, pa = std::abs(p - a), pb = std::abs(p - b), pc = std::abs(p - c);
  return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
}

}  // namespace

std::vector<std::uint32_t> encode_rvl(const Image<std::uint16_t>& plane) {
  const auto texels = plane.texels();
  RvlWriter writer;
  int before = 0;
  for (std::size_t i = 0; i < texels.size();) {
    std::uint32_t zeros = 0, others = 0;
    for (; i < texels.size() && texels[i] == 0; ++i) ++zeros;
    for (std::size_t j = i; j < texels.size() && texels[j] != 0; ++j) ++others;
    writer.add(zeros), writer.add(others);
    for (; others > 0; --others, ++i) {
      const int off = int(texels[i]) - before;
      writer.add(std::uint32_t(off * 2) ^ std::uint32_t(off >> 31));
      before = texels[i];
    }
  }
  return writer.take();
}

Image<std::uint16_t> decode_rvl(const std::vector<std::uint32_t>& words, int width, int height) {
  Image<std::uint16_t> plane(width, height);
  const auto texels = plane.texels();
  RvlReader reader(words);
  int before = 0;
  for (std::size_t i = 0; i < texels.size();) {
    i += reader.next();
    for (std::uint32_t others = reader.next(); others > 0; --others, ++i) {
      const std::uint32_t folded = reader.next();
      before += int(folded >> 1) ^ -int(folded & 1);
      texels[i] = std::uint16_t(before);
    }
  }
  return plane;
}

std::vector<std::uint8_t> encode_png_rows(const Image<std::uint16_t>& plane) {
  std::vector<std::uint8_t> raw;
  const auto byte = [&](int x, int y, int part) {
    if (x < 0 || y < 0) return 0;
    return part == 0 ? plane(x, y) >> 8 : plane(x, y) & 255;
  };
  for (int y = 0; y < plane.height(); ++y) {
    raw.push_back(4);
    for (int x = 0; x < plane.width(); ++x)
      for (int part = 0; part < 2; ++part)
        raw.push_back(
            std::uint8_t(byte(x, y, part) - paeth(byte(x - 1, y, part), byte(x, y - 1, part),
                                                  byte(x - 1, y - 1, part))));
  }
  return packed(raw);
}

std::vector<std::uint8_t> encode_deflate(const Image<std::uint16_t>& plane) {
  std::vector<std::uint8_t> raw;
  for (const std::uint16_t code : plane.texels())
    raw.push_back(std::uint8_t(code & 255)), raw.push_back(std::uint8_t(code >> 8));
  return packed(raw);
}

}  // namespace rilievo::bench
