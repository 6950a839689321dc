// Broken, hostile and merely different files: each ends in an error that names it, or loads.

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "rilievo/core/file.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/io/exr.h"
#include "rilievo/io/io_test_helpers.h"

namespace rilievo {
namespace {

// The most memory that this process has ever held, in MiB.
double peak_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return double(usage.ru_maxrss) / 1024;
}

void expect_one_line_error_or_picture(const std::filesystem::path& path) {
  const Result<std::vector<DepthImage>> loaded = load_pictures(path);
  if (loaded.ok()) {
    for (const DepthImage& picture : *loaded) EXPECT_TRUE(validate(picture).ok()) << path;
    return;
  }
  const std::string message = loaded.error().message();
  EXPECT_TRUE(message.starts_with(path.string() + ": ")) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  EXPECT_GT(message.size(), path.string().size() + 5) << message;
}

TEST(ExrCorpus, every_truncation_and_every_flipped_byte_is_an_error_or_a_valid_picture) {
  const TemporaryFolder folder;
  const std::vector<DepthImage> pictures = {random_picture(0, 6, 5), random_picture(1, 5, 6)};
  ASSERT_TRUE(save_pictures(folder / "a.exr", pictures).ok());
  std::ifstream in(folder / "a.exr", std::ios::binary);
  const std::string whole(std::istreambuf_iterator<char>(in), {});
  // A file cut by a few bytes may still hold all its texels; one cut in half cannot.
  for (std::size_t size = 0; size < whole.size(); size += 23) {
    ASSERT_TRUE(write_file(folder / "cut.exr", std::string_view(whole).substr(0, size)).ok());
    if (size < whole.size() / 2) {
      EXPECT_FALSE(load_pictures(folder / "cut.exr").ok()) << size;
    }
    expect_one_line_error_or_picture(folder / "cut.exr");
  }
  const double before = peak_mib();
  std::mt19937 rng(8);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string flipped = whole;
    flipped[i] = char(flipped[i] ^ char(1 + rng() % 255));
    ASSERT_TRUE(write_file(folder / "flip.exr", flipped).ok());
    expect_one_line_error_or_picture(folder / "flip.exr");
  }
  // The file has 3 kB. AddressSanitizer keeps up to 256 MiB of what was freed.
  EXPECT_LT(peak_mib() - before, 400);
}

TEST(ExrCorpus, damaged_files_end_in_a_clear_error_and_bounded_memory) {
  const char* data = std::getenv("RILIEVO_DATA");
  if (!data) GTEST_SKIP() << "RILIEVO_DATA is not set";
  int files = 0;
  for (const char* folder :
       {"invalid/exr_damaged", "invalid/exr_wrong_type", "exr", "deep", "rgbd"})
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(std::filesystem::path(data) / folder)) {
      if (!entry.is_regular_file()) continue;
      const double before = peak_mib();
      expect_one_line_error_or_picture(entry.path());
      // These files are small. AddressSanitizer keeps up to 256 MiB of what was freed.
      EXPECT_LT(peak_mib() - before, 400) << entry.path();
      ++files;
    }
  EXPECT_GT(files, 100);
}

TEST(ExrCorpus, foreign_files_are_refused_for_the_right_reason) {
  const char* data = std::getenv("RILIEVO_DATA");
  if (!data) GTEST_SKIP() << "RILIEVO_DATA is not set";
  const auto reason = [&](const char* file) {
    const Result<std::vector<DepthImage>> loaded =
        load_pictures(std::filesystem::path(data) / file);
    return loaded.ok() ? std::string() : loaded.error().reason;
  };
  EXPECT_EQ(reason("rgbd/seurat_capture/depth_image_with_transparency.exr"),
            "has no camera (worldToCamera and worldToNDC)");
  EXPECT_EQ(reason("rgbd/seurat_capture/color.exr"), "has no channel Z; it has A, B, G, R");
  EXPECT_EQ(reason("rgbd/beachball_stereo/multipart.0001.exr"),
            "part 0: has no channel Z; it has A, B, G, R");
  EXPECT_EQ(reason("exr/DisplayWindow/t08.exr"), "has no channel Z; it has B, G, R");
  EXPECT_EQ(reason("deep/openexr-id/objectid.deep.exr"),
            "is a deep image, not a flat picture with depth");
}

}  // namespace
}  // namespace rilievo
