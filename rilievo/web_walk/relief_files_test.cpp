#include "rilievo/web_walk/relief_files.h"

#include <gtest/gtest.h>
#include <webp/decode.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "rilievo/core/file.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/layered_relief/relief_test_helpers.h"
#include "rilievo/web_walk/plane16.h"
#include "rilievo/web_walk/walk_test_helpers.h"

namespace rilievo {
namespace {

// A sample: u, v, code, how many of its line of sight are nearer; and r, g, b, a, not multiplied.
struct Sample {
  std::array<int, 4> place{};
  std::array<int, 4> color{};
};

bool in_order(const Sample& a, const Sample& b) { return a.place < b.place; }

// What a relief is made of.
std::vector<Sample> samples_of(const LayeredRelief& relief) {
  std::vector<Sample> samples;
  for (int t = 0; t < relief.tiles_x * relief.tiles_y; ++t)
    for (std::uint32_t i = relief.first[std::size_t(t)]; i < relief.first[std::size_t(t) + 1];
         ++i) {
      const ReliefSample& of = relief.streams[0][i];
      // Those behind it come before it.
      int nearer = 0;
      for (std::uint32_t k = i + 1; k < relief.first[std::size_t(t) + 1]; ++k)
        nearer += relief.streams[0][k].u() == of.u() && relief.streams[0][k].v() == of.v();
      Sample sample;
      sample.place = {t % relief.tiles_x * relief.tile_size + int(of.u()),
                      t / relief.tiles_x * relief.tile_size + int(of.v()), int(of.code()), nearer};
      const int a = int(of.color >> 24);
      for (int k = 0; k < 3; ++k)
        sample.color[std::size_t(k)] = int(of.color >> (8 * k) & 0xff) * 255 / a;
      sample.color[3] = a;
      samples.push_back(sample);
    }
  std::ranges::sort(samples, in_order);
  return samples;
}

// The same of what was written, by the words of the header.
std::vector<Sample> samples_of(const WalkRelief& relief, const std::filesystem::path& folder) {
  const int across = (relief.camera.width + kReliefBlock - 1) / kReliefBlock;
  const int down = (relief.camera.height + kReliefBlock - 1) / kReliefBlock;
  const auto layers = decode_plane16(bytes_of(folder / relief.layers.name), across, down);
  const auto codes =
      decode_plane16(bytes_of(folder / relief.codes.name), relief.sheet_width, relief.sheet_height);
  EXPECT_TRUE(layers && codes);
  const std::vector<std::uint8_t> webp = bytes_of(folder / relief.colors.name);
  std::vector<std::uint8_t> colors(4 * codes->texels().size());
  EXPECT_TRUE(WebPDecodeRGBAInto(webp.data(), webp.size(), colors.data(), colors.size(),
                                 4 * relief.sheet_width));
  std::vector<Sample> samples;
  int place = 0;
  for (int layer = 0; layer < std::ranges::max(layers->texels()); ++layer)
    for (int y = 0; y < down; ++y)
      for (int x = 0; x < across; ++x) {
        if ((*layers)(x, y) <= layer) continue;
        for (int j = 0; j < kReliefBlock; ++j)
          for (int i = 0; i < kReliefBlock; ++i) {
            const int column = kReliefBlock * (place % (relief.sheet_width / kReliefBlock)) + i;
            const int row = kReliefBlock * (place / (relief.sheet_width / kReliefBlock)) + j;
            const int code = (*codes)(column, row);
            const std::uint8_t* c = &colors[4 * std::size_t(row * relief.sheet_width + column)];
            EXPECT_EQ(code == 0, c[3] == 0);
            if (code == 0) continue;
            samples.push_back({{kReliefBlock * x + i, kReliefBlock * y + j, code - 1, layer},
                               {c[0], c[1], c[2], c[3]}});
          }
        ++place;
      }
  std::ranges::sort(samples, in_order);
  return samples;
}

TEST(ReliefFiles, HoldEachSampleInItsLayer) {
  std::mt19937 rng(5);
  for (const bool perspective : {false, true}) {
    SCOPED_TRACE(perspective);
    ReliefPictures pictures;
    for (const auto& [width, height] : {std::pair{50, 37}, {16, 64}})
      pictures.pictures.push_back({random_layers(rng, width, height, 0.1, perspective)});
    // A thin thing: most of the picture's blocks have nothing.
    LayeredDepthImage& last = pictures.pictures.back().layers;
    for (std::size_t i = 0; i < last.first.size(); ++i)
      last.first[i] = std::min(last.first[i], last.first[200]);
    last.samples.resize(last.first.back());
    pictures.bounds = bounds_of(pictures);
    const TemporaryFolder folder;
    Result<WalkWriter> writer = WalkWriter::create(folder / "walk");
    ASSERT_TRUE(writer);
    WalkManifest manifest;
    ASSERT_TRUE(add_reliefs(pictures, {.splat_size = 1.5}, *writer, manifest, {}));
    ASSERT_TRUE(writer->finish(manifest));
    const Result<ReliefSet> set = make_relief_set(pictures);
    ASSERT_TRUE(set);
    ASSERT_EQ(manifest.reliefs.reliefs.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
      const WalkRelief& written = manifest.reliefs.reliefs[i];
      const std::vector<Sample> truth = samples_of(set->reliefs[i]);
      const std::vector<Sample> found = samples_of(written, folder / "walk");
      EXPECT_EQ(written.samples, truth.size());
      ASSERT_EQ(found.size(), truth.size());
      double off = 0;
      for (std::size_t k = 0; k < truth.size(); ++k) {
        EXPECT_EQ(found[k].place, truth[k].place);
        EXPECT_EQ(found[k].color[3], truth[k].color[3]);
        for (std::size_t c = 0; c < 3; ++c)
          off += std::pow(found[k].color[c] - truth[k].color[c], 2);
      }
      // 54 dB over the whole sheet are a mean square of 0.26 there, and more where samples are; one
      // for rounding.
      const double sheet = written.sheet_width * written.sheet_height;
      EXPECT_LT(off / (3 * double(truth.size())), 1 + 0.26 * sheet / double(truth.size()));
      EXPECT_EQ(written.hull, set->reliefs[i].hull);
    }
    const nlohmann::json json =
        nlohmann::json::parse(*read_file(folder / "walk" / "walk.json", 1 << 24))["reliefs"];
    EXPECT_EQ(json["splat"], 1.5);
    EXPECT_EQ(json["list"][0]["projection"], perspective ? "perspective" : "parallel");
    EXPECT_EQ(json["list"][1]["size"], nlohmann::json({16, 64}));
    EXPECT_EQ(json["list"][1]["codes"]["file"], manifest.reliefs.reliefs[1].codes.name);
    EXPECT_TRUE(exists(folder / "walk" / "reliefs.js"));
    EXPECT_FALSE(exists(folder / "walk" / "pictures.js"));
  }
}

TEST(ReliefFiles, RefuseWhatHasNoSamples) {
  const TemporaryFolder folder;
  Result<WalkWriter> writer = WalkWriter::create(folder / "walk");
  ASSERT_TRUE(writer);
  ReliefPictures pictures;
  pictures.pictures.emplace_back();
  WalkManifest manifest;
  EXPECT_FALSE(add_reliefs(pictures, {}, *writer, manifest, {}));
}

}  // namespace
}  // namespace rilievo
