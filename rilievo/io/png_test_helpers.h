// Writes PNG files in stored (uncompressed) blocks, unfiltered, for tests to read back.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include "rilievo/core/color.h"

namespace rilievo::test_png {

inline std::string big_endian(std::uint32_t v) {
  return {char(v >> 24), char(v >> 16), char(v >> 8), char(v)};
}

inline std::string chunk(const std::string& type, const std::string& body) {
  std::uint32_t crc = 0xFFFFFFFFu;
  for (unsigned char b : type + body) {
    crc ^= b;
    for (int k = 0; k < 8; ++k) crc = crc & 1 ? 0xEDB88320u ^ crc >> 1 : crc >> 1;
  }
  return big_endian(std::uint32_t(body.size())) + type + body + big_endian(~crc);
}

// How every such file begins. `color` is PNG's number: 0 grey, 6 RGBA.
inline std::string head(int width, int height, int bits, int color) {
  return "\x89PNG\r\n\x1A\n" +
         chunk("IHDR", big_endian(std::uint32_t(width)) + big_endian(std::uint32_t(height)) +
                           std::string{char(bits), char(color), 0, 0, 0});
}

// What follows the head. `rows` are the texels' bytes, a zero before each row.
inline std::string tail(const std::string& rows) {
  std::string zlib = "\x78\x01";
  std::uint32_t a = 1, b = 0;
  for (unsigned char c : rows) a = (a + c) % 65521, b = (b + a) % 65521;
  for (std::size_t at = 0; at < rows.size(); at += 65535) {
    const std::size_t n = std::min<std::size_t>(65535, rows.size() - at);
    zlib += {char(at + n == rows.size()), char(n), char(n >> 8), char(~n), char(~n >> 8)};
    zlib += rows.substr(at, n);
  }
  return chunk("IDAT", zlib + big_endian(b << 16 | a)) + chunk("IEND", "");
}

inline std::string rgba8_png(const Rgba8Image& image) {
  std::string rows;
  for (int y = 0; y < image.height(); ++y) {
    rows += '\0';
    for (const glm::u8vec4& t : image.row(y)) rows += {char(t.r), char(t.g), char(t.b), char(t.a)};
  }
  return head(image.width(), image.height(), 8, 6) + tail(rows);
}

inline std::string grey16_png(const Image<std::uint16_t>& image) {
  std::string rows;
  for (int y = 0; y < image.height(); ++y) {
    rows += '\0';
    for (std::uint16_t v : image.row(y)) rows += {char(v >> 8), char(v)};
  }
  return head(image.width(), image.height(), 16, 0) + tail(rows);
}

}  // namespace rilievo::test_png
