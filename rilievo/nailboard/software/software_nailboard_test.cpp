// What is kept of a nailboard in memory, texel by texel, and what its cells say of it.
#include "rilievo/nailboard/software/software_nailboard.h"

#include <gtest/gtest.h>

#include "rilievo/core/random.h"
#include "rilievo/nailboard/software/composer_test_helpers.h"
#include "rilievo/render/shading/simd_test_helpers.h"

namespace rilievo {
namespace {

// By the definition in the header.
void expect_cells(const SoftwareNailboard& kept) {
  std::uint32_t nearest = 0xffff;
  for (int row = 0; row < kept.cells_down(); ++row)
    for (int column = 0; column < kept.cells_across(); ++column) {
      std::uint32_t least = 0xffff;
      bool opaque = true;
      for (int y = row * SoftwareNailboard::kCell; y < (row + 1) * SoftwareNailboard::kCell; ++y)
        for (int x = column * SoftwareNailboard::kCell; x < (column + 1) * SoftwareNailboard::kCell;
             ++x) {
          if (x >= kept.width() || y >= kept.height()) continue;
          least = std::min(least, kept.code(x, y));
          opaque = opaque && kept.code(x, y) <= kept.steps() &&
                   kept.color()[y * kept.stride() + x] >> 24 == 255;
        }
      const int cell = row * kept.cells_across() + column;
      ASSERT_EQ(kept.cell_nearest()[cell], least);
      ASSERT_EQ(kept.cell_opaque()[cell] != 0, opaque);
      nearest = std::min(nearest, least);
    }
  EXPECT_EQ(kept.nearest(), nearest);
}

// What may be read beside the picture: no colour, and codes of nothing.
void expect_nothing_beside(const SoftwareNailboard& kept) {
  const int end = kept.stride() * (kept.height() + 2) + SoftwareNailboard::kReadBeyond;
  for (int i = 0; i < end; ++i) {
    if (i % kept.stride() < kept.width() && i / kept.stride() < kept.height()) continue;
    ASSERT_EQ(kept.color()[i], 0u) << i;
    if (i / 2 < kept.stride() * (kept.height() + 2) / 2 + SoftwareNailboard::kReadBeyond) {
      ASSERT_EQ(kept.code_pairs()[i / 2] >> (16 * (i & 1)) & 0xffffu, 0xffffu) << i;
    }
  }
}

Prewarped random_prewarped(Random& random, int width, int height) {
  Prewarped made;
  made.geometry.capture.width = width, made.geometry.capture.height = height;
  made.geometry.delta_bits = 16;
  // Empty in patches, so that some texels have neighbours and others none.
  for (int i = 0; i < width * height; ++i) {
    const bool empty = (i % width / 9 + i / width / 7) % 3 == 0 || random.unit() < 0.1f;
    const auto byte = [&] { return std::uint8_t(random.below(256)); };
    glm::u8vec4 color(0);
    if (!empty) color.r = byte(), color.g = byte(), color.a = random.unit() < 0.1f ? 100 : 255;
    made.color.push_back(color);
    made.delta.push_back(empty ? std::uint16_t(delta_transparent(16))
                               : std::uint16_t(random.below(int(delta_steps(16)) + 1)));
  }
  return made;
}

TEST(SoftwareNailboard, keeps_each_texel_whatever_was_kept_before) {
  Random random(11);
  const Camera frame = random_frame(random, 150, 92);
  SoftwareNailboard kept;
  for (int i = 0; i < 24; ++i) {
    const int bits = i % 3 == 0 ? 16 : 8;
    const Nailboard board = random_picture(random, frame, bits, 20 + 17 * (i % 7));
    for_each_instruction_set([&](const char* set) {
      SCOPED_TRACE(set);
      kept.assign(board);
      ASSERT_EQ(kept.width(), board.color.width());
      ASSERT_EQ(kept.height(), board.color.height());
      const Nailboard copy = kept.copy(board.geometry);
      EXPECT_TRUE(copy.color == board.color);
      EXPECT_TRUE(copy.delta == board.delta);
      ASSERT_NO_FATAL_FAILURE(expect_cells(kept));
      ASSERT_NO_FATAL_FAILURE(expect_nothing_beside(kept));
    });
  }
}

TEST(SoftwareNailboard, bytes_are_those_of_the_largest_picture_so_far) {
  Random random(13);
  const Camera frame = random_frame(random, 150, 92);
  SoftwareNailboard kept;
  std::size_t most = 0;
  for (const int texels : {20, 120, 130, 30, 20, 122}) {
    const Nailboard board = random_picture(random, frame, 8, texels);
    kept.assign(board);
    const std::size_t needed =
        SoftwareNailboard::bytes_of(board.color.width(), board.color.height());
    SoftwareNailboard alone;
    alone.assign(board);
    EXPECT_EQ(alone.bytes(), needed);
    const std::vector<std::uint32_t> objects(
        std::size_t(alone.width()) * std::size_t(alone.height()), 7);
    alone.assign_objects(objects, true);
    EXPECT_GT(alone.bytes(), needed);
    alone.drop_objects();
    EXPECT_EQ(alone.bytes(), needed);
    EXPECT_GE(kept.bytes(), needed);
    most = std::max(most, needed);
  }
  // Of different shapes each part of the memory is the largest of its own: little more.
  EXPECT_GE(kept.bytes(), most);
  EXPECT_LE(kept.bytes(), most + most / 4);
}

TEST(SoftwareNailboard, a_piece_of_a_prewarped_picture_is_kept_as_its_encoding_is) {
  Random random(12);
  SoftwareNailboard directly, encoded;
  EncodedPiece piece_encoded;
  for (int i = 0; i < 40; ++i) {
    const int width = 1 + random.below(90), height = 1 + random.below(70);
    const Prewarped picture = random_prewarped(random, width, height);
    for (const PicturePiece& piece : pieces_of(width, height, 8 + random.below(88))) {
      encode_prewarped(picture, piece, piece_encoded);
      encoded.assign(piece.width, piece.height, piece_encoded.color, piece_encoded.picture, 16);
      directly.assign(picture, piece);
      PictureGeometry geometry = geometry_of(picture.geometry, piece);
      const Nailboard a = directly.copy(geometry), b = encoded.copy(geometry);
      ASSERT_TRUE(a.color == b.color);
      ASSERT_TRUE(a.delta == b.delta);
      ASSERT_NO_FATAL_FAILURE(expect_cells(directly));
      ASSERT_NO_FATAL_FAILURE(expect_nothing_beside(directly));
    }
  }
}

}  // namespace
}  // namespace rilievo
