#include "rilievo/io/deep_exr.h"

#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfHeader.h>
#include <ImfPartType.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "rilievo/core/file.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/io/exr.h"
#include "rilievo/io/io_test_helpers.h"

namespace rilievo {
namespace {

// Lines of sight with no sample to many; volumes among the surfaces; colours that are halfs.
LayeredDepthImage random_deep(unsigned seed, int width, int height) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> u(0, 1);
  LayeredDepthImage layers;
  layers.name = "layers " + std::to_string(seed);
  layers.camera = random_camera(rng, width, height);
  layers.depth_kind = DepthKind(seed % 3);
  layers.first.push_back(0);
  for (int i = 0; i < width * height; ++i) {
    float depth = 0.3f;
    for (unsigned k = rng() % 6; k > 0; --k) {
      LayerSample sample;
      for (int c = 0; c < 4; ++c) sample.color[c] = float(half(u(rng) * 4));
      sample.depth = depth += u(rng);
      sample.back = rng() % 3 ? sample.depth : sample.depth + u(rng);
      sample.object = rng();
      layers.samples.push_back(sample);
    }
    layers.first.push_back(layers.samples.size());
  }
  return layers;
}

void expect_same(const LayeredDepthImage& a, const LayeredDepthImage& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.camera, b.camera);
  EXPECT_EQ(a.depth_kind, b.depth_kind);
  EXPECT_EQ(a.first, b.first);
  ASSERT_EQ(a.samples.size(), b.samples.size());
  for (std::size_t i = 0; i < a.samples.size(); ++i) {
    EXPECT_EQ(a.samples[i].color, b.samples[i].color);
    EXPECT_EQ(a.samples[i].depth, b.samples[i].depth);
    EXPECT_EQ(a.samples[i].back, b.samples[i].back);
    EXPECT_EQ(a.samples[i].object, b.samples[i].object);
  }
}

TEST(DeepExr, what_is_saved_is_loaded_bit_for_bit) {
  const TemporaryFolder folder;
  for (unsigned seed = 0; seed < 12; ++seed) {
    const LayeredDepthImage layers = random_deep(seed, 1 + int(seed) * 3, 7);
    ASSERT_TRUE(save_layers(folder / "a.exr", layers));
    const Result<LayeredDepthImage> loaded = load_layers(folder / "a.exr");
    ASSERT_TRUE(loaded) << loaded.error().message();
    expect_same(layers, *loaded);
  }
  EXPECT_EQ(folder.entries(), 1);
}

TEST(DeepExr, several_pictures_and_what_is_said_of_them_share_a_file) {
  const TemporaryFolder folder;
  std::vector<LayeredDepthImage> pictures;
  for (unsigned seed = 0; seed < 3; ++seed)
    pictures.push_back(random_deep(seed, 3 + 4 * int(seed), 9 - 2 * int(seed)));
  pictures[1].name = pictures[0].name;
  FileAttributes attributes;
  attributes.file["kind"] = "some";
  attributes.pictures = {{{"a", "1"}}, {}, {{"a", "3"}, {"b", ""}}};
  ASSERT_TRUE(save_layers(folder / "a.exr", pictures, attributes));
  const Result<PictureFile> loaded = load_picture_file(folder / "a.exr");
  ASSERT_TRUE(loaded) << loaded.error().message();
  EXPECT_TRUE(loaded->pictures.empty());
  ASSERT_EQ(loaded->layers.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) expect_same(pictures[i], loaded->layers[i]);
  EXPECT_EQ(loaded->attributes.file, attributes.file);
  EXPECT_EQ(loaded->attributes.pictures, attributes.pictures);
  // Who asks for one, or for flat ones, is told.
  EXPECT_EQ(load_layers(folder / "a.exr").error().reason,
            "has several parts; a deep picture is one");
  EXPECT_EQ(load_pictures(folder / "a.exr").error().reason,
            "is a deep image, not a flat picture with depth");
  attributes.file["no space"] = "";
  EXPECT_FALSE(save_layers(folder / "b.exr", pictures, attributes));
  EXPECT_EQ(folder.entries(), 1);
}

TEST(DeepExr, an_invalid_picture_is_not_saved) {
  const TemporaryFolder folder;
  LayeredDepthImage layers = random_deep(1, 4, 4);
  layers.samples[0].depth = kNoDepth;
  const Result<> saved = save_layers(folder / "a.exr", layers);
  ASSERT_FALSE(saved);
  EXPECT_EQ(saved.error().where, (folder / "a.exr").string());
  EXPECT_EQ(folder.entries(), 0);
}

TEST(DeepExr, a_flat_file_is_refused) {
  const TemporaryFolder folder;
  const std::vector<DepthImage> flat = {random_picture(0, 4, 4)};
  ASSERT_TRUE(save_pictures(folder / "a.exr", flat));
  EXPECT_EQ(load_layers(folder / "a.exr").error().message(),
            (folder / "a.exr").string() + ": is not a deep image");
}

TEST(DeepExr, every_truncation_and_every_flipped_byte_is_an_error_or_a_valid_picture) {
  const TemporaryFolder folder;
  ASSERT_TRUE(save_layers(folder / "a.exr", random_deep(3, 7, 6)));
  const std::string whole = *read_file(folder / "a.exr", 1 << 20);
  int chunks_too_large = 0;
  const auto check = [&](std::string_view bytes) {
    const Result<LayeredDepthImage> loaded = load_layers(bytes, "a.exr");
    if (loaded) {
      EXPECT_TRUE(validate(*loaded));
      return true;
    }
    chunks_too_large += loaded.error().message().ends_with("a chunk that is larger than the file");
    EXPECT_TRUE(loaded.error().message().starts_with("a.exr: ")) << loaded.error().message();
    EXPECT_EQ(loaded.error().message().find('\n'), std::string::npos);
    return false;
  };
  rusage before{}, after{};
  getrusage(RUSAGE_SELF, &before);
  for (std::size_t size = 0; size < whole.size(); size += 11) {
    const bool loads = check(std::string_view(whole).substr(0, size));
    if (size < whole.size() / 2) {
      EXPECT_FALSE(loads) << size;
    }
  }
  std::mt19937 rng(8);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string flipped = whole;
    flipped[i] = char(flipped[i] ^ char(1 + rng() % 255));
    check(flipped);
  }
  getrusage(RUSAGE_SELF, &after);
  // The file has a few kilobytes. AddressSanitizer keeps up to 256 MiB of what was freed, with as
  // much as half of that around it.
  EXPECT_LT(double(after.ru_maxrss - before.ru_maxrss) / 1024, 400 + 64);
  EXPECT_GT(chunks_too_large, 20);  // five high bytes of two sizes in each chunk
}

// A file of another program, all of whose rows are alike: the samples of each column (R G B A Z).
using ForeignSamples = std::vector<std::array<float, 5>>;

void save_foreign_deep(const std::filesystem::path& path, const Imath::Box2i& window,
                       const std::vector<ForeignSamples>& row) {
  Imf::Header header(window, window);
  header.setType(Imf::DEEPSCANLINE);
  header.compression() = Imf::ZIPS_COMPRESSION;
  std::vector<unsigned> counts;
  for (const ForeignSamples& samples : row) counts.push_back(unsigned(samples.size()));
  // OpenEXR wants the address that column 0 would have; the next row is 0 bytes away.
  const auto at_column_0 = [&](auto& of) {
    return reinterpret_cast<char*>(std::intptr_t(of.data()) -
                                   std::int64_t(sizeof(of[0])) * window.min.x);
  };
  Imf::DeepFrameBuffer planes;
  planes.insertSampleCountSlice(Imf::Slice(Imf::UINT, at_column_0(counts), sizeof(unsigned), 0));
  std::array<std::vector<const float*>, 5> pointers;
  const char* const names[] = {"R", "G", "B", "A", "Z"};
  for (std::size_t c = 0; c < 5; ++c) {
    header.channels().insert(names[c], Imf::Channel(Imf::FLOAT));
    for (const ForeignSamples& samples : row)
      pointers[c].push_back(samples.empty() ? nullptr : &samples[0][c]);
    planes.insert(names[c], Imf::DeepSlice(Imf::FLOAT, at_column_0(pointers[c]), sizeof(float*), 0,
                                           sizeof(ForeignSamples::value_type)));
  }
  Imf::DeepScanLineOutputFile file(path.c_str(), header);
  file.setFrameBuffer(planes);
  file.writePixels(window.max.y - window.min.y + 1);
}

TEST(DeepExr, foreign_samples_are_sorted_and_their_colours_made_finite) {
  const TemporaryFolder folder;
  const float nan = std::nanf("");
  const std::vector<ForeignSamples> row = {{{kNoDepth, -kNoDepth, nan, 1, 2}},
                                           {},
                                           {{0, 0, 0, 1, 3}, {1, 1, 1, 1, 1}, {1, 1, 1, 1, 1e30f}},
                                           {{1, 2, 3, nan, 5}}};
  save_foreign_deep(folder / "a.exr", {{5, -3}, {8, -1}}, row);
  DeepLoadOptions options;
  options.fov = 0.9;
  const Result<LayeredDepthImage> loaded = load_layers(folder / "a.exr", options);
  ASSERT_TRUE(loaded) << loaded.error().message();
  EXPECT_EQ(loaded->camera.width, 4);
  EXPECT_EQ(loaded->camera.height, 3);
  const std::vector<std::uint64_t> first = {0, 1, 1, 3, 4, 5, 5, 7, 8, 9, 9, 11, 12};
  ASSERT_EQ(loaded->first, first);
  const glm::vec4 colors[] = {{65504, -65504, 0, 1}, {1, 1, 1, 1}, {0, 0, 0, 1}, {1, 2, 3, 0}};
  const float depths[] = {2, 1, 3, 5};
  for (std::size_t s = 0; s < 12; ++s) {
    EXPECT_EQ(loaded->samples[s].color, colors[s % 4]);
    EXPECT_EQ(loaded->samples[s].depth, depths[s % 4]);
    EXPECT_EQ(loaded->samples[s].back, depths[s % 4]);
  }
}

// A texel without samples takes 8 bytes as it is read, 8 in the result, and 4 in OpenEXR.
TEST(DeepExr, texels_without_samples_take_little_memory) {
  const TemporaryFolder folder;
  save_foreign_deep(folder / "a.exr", {{0, 0}, {1499, 999}}, std::vector<ForeignSamples>(1500));
  DeepLoadOptions options;
  options.fov = 0.9;
  rusage before{}, after{};
  getrusage(RUSAGE_SELF, &before);
  const Result<LayeredDepthImage> loaded = load_layers(folder / "a.exr", options);
  getrusage(RUSAGE_SELF, &after);
  ASSERT_TRUE(loaded) << loaded.error().message();
  EXPECT_EQ(loaded->first.size(), 1'500'001u);
  // 30 MiB; with pointers to the samples of all texels it would be 80.
  EXPECT_LT(double(after.ru_maxrss - before.ru_maxrss) / 1024, 50);
}

TEST(DeepExr, a_side_that_no_camera_has_is_refused_before_anything_is_read) {
  const TemporaryFolder folder;
  ASSERT_TRUE(save_layers(folder / "a.exr", random_deep(3, 7, 6)));
  std::string bytes = *read_file(folder / "a.exr", 1 << 20);
  const std::string key = std::string("dataWindow\0box2i\0\x10\0\0\0", 21);
  const std::size_t at = bytes.find(key);
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at + key.size() + 8, 4, std::string("\0\0\1\0", 4));
  EXPECT_EQ(load_layers(bytes, "a.exr").error().reason,
            "its data window is larger than 65536 texels along a side");
}

TEST(DeepExr, foreign_files_load_with_a_camera_and_are_refused_without) {
  const char* data = std::getenv("RILIEVO_DATA");
  if (!data) GTEST_SKIP() << "RILIEVO_DATA is not set";
  const std::filesystem::path deep = std::filesystem::path(data) / "deep";
  const Result<LayeredDepthImage> arnold = load_layers(deep / "arnold_deep.exr");
  ASSERT_TRUE(arnold) << arnold.error().message();
  EXPECT_EQ(arnold->camera.width, 64);
  EXPECT_EQ(arnold->camera.height, 32);
  // worldToNDC: x is halved, y is not.
  EXPECT_NEAR(arnold->camera.window.right, 2, 1e-5);
  EXPECT_NEAR(arnold->camera.window.top, 1, 1e-5);
  EXPECT_GT(arnold->samples.size(), 0u);

  const Result<LayeredDepthImage> bare = load_layers(deep / "LowResLeftView/Balls.exr");
  ASSERT_FALSE(bare);
  EXPECT_EQ(bare.error().reason,
            "has no camera: neither worldToCamera and worldToNDC, nor one given beside it");
  DeepLoadOptions options;
  options.camera = deep_camera(0.9, 1024, 576);
  const Result<LayeredDepthImage> balls = load_layers(deep / "LowResLeftView/Balls.exr", options);
  ASSERT_TRUE(balls) << balls.error().message();
  // A crop of the display window.
  EXPECT_EQ(balls->camera.width, 764);
  EXPECT_NEAR(balls->camera.window.left, (2.0 * 131 / 1024 - 1) * std::tan(0.45), 1e-9);
  EXPECT_GT(balls->samples.size(), 100'000u);
  for (const char* id : {"openexr-id/11.deep.exr", "openexr-id/objectid.deep.exr"})
    EXPECT_TRUE(load_layers(deep / id, options)) << id;
}

TEST(DeepExr, damaged_files_end_in_a_clear_error) {
  const char* data = std::getenv("RILIEVO_DATA");
  if (!data) GTEST_SKIP() << "RILIEVO_DATA is not set";
  DeepLoadOptions options;
  options.camera = deep_camera(0.9, 64, 64);
  int files = 0;
  for (const char* folder : {"invalid/exr_damaged", "invalid/exr_wrong_type", "exr"})
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(std::filesystem::path(data) / folder)) {
      if (!entry.is_regular_file()) continue;
      ++files;
      const Result<LayeredDepthImage> loaded = load_layers(entry.path(), options);
      if (loaded) {
        EXPECT_TRUE(validate(*loaded)) << entry.path();
        continue;
      }
      const std::string message = loaded.error().message();
      EXPECT_TRUE(message.starts_with(entry.path().string() + ": ")) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
  EXPECT_GT(files, 100);
}

}  // namespace
}  // namespace rilievo
