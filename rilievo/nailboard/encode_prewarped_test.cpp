#include "rilievo/nailboard/encode_prewarped.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "rilievo/core/depth.h"
#include "rilievo/render/shading/simd_test_helpers.h"

namespace rilievo {
namespace {

constexpr std::uint16_t kEmpty = delta_transparent(16);

// What the header says, texel by texel.
std::uint16_t expected_code(const Prewarped& picture, int u, int v) {
  const auto at = [&](int x, int y) {
    return picture.delta[std::size_t(y) * std::size_t(picture.width()) + std::size_t(x)];
  };
  std::uint16_t code = at(u, v);
  if (code != kEmpty) return code;
  for (int y = std::max(v - 1, 0); y <= std::min(v + 1, picture.height() - 1); ++y)
    for (int x = std::max(u - 1, 0); x <= std::min(u + 1, picture.width() - 1); ++x)
      code = std::min(code, at(x, y));
  return code;
}

TEST(EncodePrewarped, empty_texels_get_the_nearest_delta_beside_them) {
  std::mt19937 rng(5);
  for (int i = 0; i < 200; ++i) {
    Prewarped picture;
    Camera& camera = picture.geometry.capture;
    camera.width = 1 + int(rng() % 150), camera.height = 1 + int(rng() % 9);
    const auto texels = std::size_t(camera.width) * std::size_t(camera.height);
    picture.color.resize(texels);
    const unsigned share = rng() % 5;  // from all empty to few
    for (std::size_t k = 0; k < texels; ++k)
      picture.delta.push_back(rng() % 4 >= share ? kEmpty : std::uint16_t(rng()));
    for (const PicturePiece& piece : pieces_of(camera.width, camera.height, i % 2 ? 40 : 1024)) {
      std::vector<std::uint16_t> codes(std::size_t(piece.width)), expected(codes.size());
      for (int y = 0; y < piece.height; ++y) {
        for (int x = 0; x < piece.width; ++x)
          expected[std::size_t(x)] = expected_code(picture, piece.x + x, piece.y + y);
        for_each_instruction_set([&](const char* set) {
          codes_of_row(picture, piece, y, codes.data());
          EXPECT_EQ(codes, expected) << set << ", " << piece.width << " of " << camera.width;
        });
      }
    }
  }
}

}  // namespace
}  // namespace rilievo
