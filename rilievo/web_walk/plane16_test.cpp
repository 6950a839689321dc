#include "rilievo/web_walk/plane16.h"

#include <gtest/gtest.h>

#include <random>

namespace rilievo {
namespace {

Image<std::uint16_t> made(int width, int height, unsigned (*at)(int x, int y)) {
  Image<std::uint16_t> plane(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) plane(x, y) = std::uint16_t(at(x, y));
  return plane;
}

TEST(Plane16, ReturnsWhatWasStored) {
  std::mt19937 rng(7);
  for (const auto& [width, height] : {std::pair(1, 1), {1, 9}, {9, 1}, {33, 17}}) {
    Image<std::uint16_t> plane(width, height);
    for (std::uint16_t& value : plane.texels()) value = std::uint16_t(rng());
    const Result<Image<std::uint16_t>> back = decode_plane16(encode_plane16(plane), width, height);
    ASSERT_TRUE(back);
    EXPECT_EQ(*back, plane);
    const Result<Image<std::uint16_t>> quick =
        decode_plane16(encode_plane16_quickly(plane), width, height);
    ASSERT_TRUE(quick);
    EXPECT_EQ(*quick, plane);
  }
}

// An affine plane is its own prediction but along two borders.
TEST(Plane16, StoresPlanesInAFewBytes) {
  const auto plane = made(256, 256, [](int x, int y) { return unsigned(70 * x + 131 * y + 5); });
  EXPECT_LT(encode_plane16(plane).size(), 700u);
  // Identifiers: few values in areas.
  const auto areas = made(256, 256, [](int x, int y) { return unsigned(x / 64 + 4 * (y / 64)); });
  EXPECT_LT(encode_plane16(areas).size(), 700u);
}

TEST(Plane16, RefusesDamagedBytes) {
  const auto plane = made(64, 64, [](int x, int y) { return unsigned(x * y); });
  const std::vector<std::uint8_t> good = encode_plane16(plane);
  EXPECT_FALSE(decode_plane16(good, 64, 63));
  EXPECT_FALSE(decode_plane16(good, 64, 65));
  EXPECT_FALSE(decode_plane16({}, 64, 64));
  EXPECT_FALSE(decode_plane16(std::span(good).first(good.size() / 2), 64, 64));
  // zlib's checksum finds every changed bit.
  for (std::size_t i = 0; i < good.size(); i += 7) {
    std::vector<std::uint8_t> bad = good;
    bad[i] ^= 0x10;
    const Result<Image<std::uint16_t>> back = decode_plane16(bad, 64, 64);
    EXPECT_TRUE(!back || *back == plane) << i;
  }
}

}  // namespace
}  // namespace rilievo
