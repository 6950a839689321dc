#include "rilievo/web_walk/picture_files.h"

#include <gtest/gtest.h>
#include <webp/decode.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "rilievo/core/file.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/web_walk/plane16.h"
#include "rilievo/web_walk/walk_test_helpers.h"

namespace rilievo {
namespace {

constexpr int kSize = 24;

// A disc that is tilted, in front of nothing; its rim is half transparent.
DepthImage disc_from(const glm::dvec3& eye) {
  DepthImage picture;
  picture.camera = look_at(eye, {0, 0, 0}, {0, 1, 0}, 0.6, kSize, kSize, 1, 10);
  picture.color = ColorImage(kSize, kSize);
  picture.depth = Image<float>(kSize, kSize, kNoDepth);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const double r = std::hypot(x + 0.5 - 0.5 * kSize, y + 0.5 - 0.5 * kSize);
      if (r > 9) continue;
      const float a = r > 8 ? 0.5f : 1.0f;
      picture.color(x, y) = a * glm::vec4(0.1f + 0.03f * float(x), 0.4f, 0.7f, 1);
      picture.depth(x, y) = 3.0f + 0.05f * float(x);
    }
  return picture;
}

// What a picture of a walk says where the original shows something: depth and colour.
void expect_shows(const std::filesystem::path& folder, const WalkPicture& written,
                  const DepthImage& original, double most_off) {
  const Result<Image<std::uint16_t>> codes =
      decode_plane16(bytes_of(folder / written.depths.name), kSize, kSize);
  ASSERT_TRUE(codes);
  const std::vector<std::uint8_t> webp = bytes_of(folder / written.colors.name);
  std::vector<std::uint8_t> colors(4 * kSize * kSize);
  ASSERT_TRUE(
      WebPDecodeRGBAInto(webp.data(), webp.size(), colors.data(), colors.size(), 4 * kSize));
  int shown = 0;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const std::uint8_t* c = &colors[std::size_t(4 * (y * kSize + x))];
      if (!original.covered(x, y)) {
        EXPECT_EQ(c[3], 0);
        continue;
      }
      ++shown;
      ASSERT_GT((*codes)(x, y), 0);
      const double q = written.least_disparity + ((*codes)(x, y) - 1) * written.disparity_step;
      EXPECT_NEAR(q, 1 / double(original.depth(x, y)), most_off);
      const glm::vec4 truth = original.color(x, y);
      EXPECT_NEAR(c[3], 255 * double(truth.a), 0.51);
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(c[k], 255 * double(srgb_from_linear(truth[k] / truth.a)), 6) << x << " " << y;
    }
  EXPECT_GT(shown, 200);
}

TEST(PictureFiles, HoldDepthsAndColoursOfALayeredImpostor) {
  const TemporaryFolder folder;
  const std::vector<DepthImage> pictures{disc_from({0, 0, 4}), disc_from({3, 0, 2})};
  const Result<LayeredImpostor> impostor = make_layered_impostor(pictures, {});
  ASSERT_TRUE(impostor);
  Result<WalkWriter> writer = WalkWriter::create(folder / "walk");
  ASSERT_TRUE(writer);
  WalkManifest manifest;
  ASSERT_TRUE(add_layered_impostor(*impostor, *writer, manifest, {}));
  ASSERT_TRUE(writer->finish(manifest));
  const WalkPictures& written = manifest.pictures;
  EXPECT_EQ(written.drawn, WalkPictures::Drawn::surfaces);
  ASSERT_EQ(written.pictures.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    // Half a step.
    const double most_off = 0.51 * written.pictures[i].disparity_step;
    expect_shows(folder / "walk", written.pictures[i], pictures[i], most_off);
    EXPECT_EQ(written.pictures[i].direction, impostor->views.directions[i]);
  }
  const nlohmann::json json =
      nlohmann::json::parse(*read_file(folder / "walk" / "walk.json", 1 << 24));
  EXPECT_FALSE(json.contains("nodes"));
  EXPECT_EQ(json["pictures"]["drawn"], "surfaces");
  EXPECT_EQ(json["pictures"]["list"].size(), 2u);
  EXPECT_EQ(json["pictures"]["list"][1]["depths"]["file"], written.pictures[1].depths.name);
}

TEST(PictureFiles, HoldNailboardsWithDepthsInTheirOwnSteps) {
  const TemporaryFolder folder;
  const std::vector<DepthImage> pictures{disc_from({0, 0, 4})};
  for (const int bits : {8, 16}) {
    Result<WalkWriter> writer = WalkWriter::create(folder / "walk");
    ASSERT_TRUE(writer);
    WalkManifest manifest;
    ASSERT_TRUE(add_nailboards(pictures, bits, *writer, manifest, {}));
    ASSERT_TRUE(writer->finish(manifest));
    EXPECT_EQ(manifest.pictures.drawn, WalkPictures::Drawn::nailboards);
    ASSERT_EQ(manifest.pictures.pictures.size(), 1u);
    const WalkPicture& written = manifest.pictures.pictures[0];
    // Half a step of Delta, which divides disparities from 1 / 1 m to 1 / 10 m, and of the file's.
    const double most_off = 0.5 * 0.9 / double(delta_steps(bits)) + written.disparity_step;
    expect_shows(folder / "walk", written, pictures[0], most_off);
    EXPECT_GT(written.plane_z, 3);
    EXPECT_LT(written.plane_z, 4.2);
  }
}

TEST(PictureFiles, RefuseParallelNailboards) {
  const TemporaryFolder folder;
  DepthImage picture = disc_from({0, 0, 4});
  picture.camera.projection = Projection::parallel;
  Result<WalkWriter> writer = WalkWriter::create(folder / "walk");
  ASSERT_TRUE(writer);
  WalkManifest manifest;
  EXPECT_FALSE(add_nailboards({&picture, 1}, 8, *writer, manifest, {}));
}

}  // namespace
}  // namespace rilievo
