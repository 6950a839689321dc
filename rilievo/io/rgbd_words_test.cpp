// Captures in the words of many programs: lenses, angles, masks, paths, lost cameras.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "rilievo/core/file_test_helpers.h"
#include "rilievo/io/lens_distortion.h"
#include "rilievo/io/rgbd_open.h"
#include "rilievo/io/rgbd_test_helpers.h"

namespace rilievo {
namespace {

namespace fs = std::filesystem;
using test_rgbd::lens_of;
using Model = LensDistortion::Model;

constexpr int kWidth = 64, kHeight = 48;

Camera pinhole() {
  return look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 0.9, kWidth, kHeight, 0.1, 100);
}

// Smooth colours, and two depths with an edge between them, along a line of sight.
glm::vec4 color_at(const glm::dvec2& p) {
  return {float(0.5 + 0.4 * std::sin(4 * p.x)), float(0.5 + 0.4 * std::cos(3 * p.y)), 0.25f, 1};
}
float depth_at(const glm::dvec2& p) { return p.x + 0.3 * p.y > 0.1 ? 2.0f : 7.0f; }

// The line of sight of a raster position of a lens: where distorted() leads there.
glm::dvec2 straight(const LensDistortion& lens, const Camera& camera, const glm::dvec2& raster) {
  const auto k = lens_of(camera);
  const glm::dvec2 target((raster.x - k.cx) / k.fl_x, (raster.y - k.cy) / k.fl_y);
  glm::dvec2 p = target;
  for (int i = 0; i < 200; ++i) p += 0.7 * (target - distorted(lens, p));
  return p;
}

// What a lens photographs.
DepthImage photograph(const LensDistortion& lens) {
  DepthImage picture;
  picture.camera = pinhole();
  picture.color = ColorImage(kWidth, kHeight);
  picture.depth = Image<float>(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const glm::dvec2 p = straight(lens, picture.camera, {x + 0.5, y + 0.5});
      picture.color(x, y) = color_at(p);
      picture.depth(x, y) = depth_at(p);
    }
  return picture;
}

std::string all_replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != text.npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

void edit(const fs::path& file, const std::function<std::string(std::string)>& change) {
  (void)write_file(file, change(*read_file(file, std::uint64_t(1) << 30)));
}

// A nerfstudio capture of one lens whose words are `words`, a list of JSON members.
void write_lens(const TemporaryFolder& folder, const LensDistortion& lens, const std::string& words,
                bool each_frame = false) {
  test_rgbd::write_capture(folder.path(), RgbdFormat::nerfstudio, {photograph(lens)});
  edit(folder / "transforms.json", [&](const std::string& text) {
    return each_frame ? all_replaced(text, "{\"file_path\"", "{" + words + ", \"file_path\"")
                      : all_replaced(text, "\"k1\": 0.0", words);
  });
}

// The only picture, or an error.
Result<DepthImage> only_picture(const fs::path& folder) {
  const Result<RgbdCapture> capture = open_rgbd_capture(folder);
  if (!capture) return capture.error();
  return load_rgbd_frame(capture->frames.at(0));
}

TEST(LensDistortion, is_what_opencv_says) {
  const glm::dvec2 p(0.3, -0.2);
  const double r2 = 0.13, r = std::sqrt(r2);
  LensDistortion lens{Model::radial, {0.1, 0.02, 0.003, 0.2, 0.04, 0.005}, {0.01, -0.02}};
  const double s = (1 + 0.1 * r2 + 0.02 * r2 * r2 + 0.003 * r2 * r2 * r2) /
                   (1 + 0.2 * r2 + 0.04 * r2 * r2 + 0.005 * r2 * r2 * r2);
  const glm::dvec2 q = distorted(lens, p);
  EXPECT_NEAR(q.x, 0.3 * s + 2 * 0.01 * 0.3 * -0.2 - 0.02 * (r2 + 2 * 0.09), 1e-15);
  EXPECT_NEAR(q.y, -0.2 * s + 0.01 * (r2 + 2 * 0.04) + 2 * -0.02 * 0.3 * -0.2, 1e-15);
  const double t = std::atan(r);
  lens = {Model::fisheye, {0.1, 0.02, 0.003, 0.004}, {}};
  const double bent = t * (1 + 0.1 * t * t + 0.02 * std::pow(t, 4) + 0.003 * std::pow(t, 6) +
                           0.004 * std::pow(t, 8));
  EXPECT_NEAR(glm::length(distorted(lens, p)), bent, 1e-15);
  EXPECT_EQ(distorted({}, p), p);
  EXPECT_EQ(distorted(lens, glm::dvec2(0)), glm::dvec2(0));
}

// r (1 - r^2) grows up to r = 1 / sqrt(3).
TEST(LensDistortion, the_radius_ends_where_the_picture_would_fold) {
  const LensDistortion lens{Model::series, {-1}, {}};
  EXPECT_NEAR(largest_radius(lens, 2), 1 / std::sqrt(3.0), 0.003);
  EXPECT_EQ(largest_radius(lens, 0.5), 0.5);
  EXPECT_EQ(largest_radius({Model::fisheye}, 100), 100);
}

struct Words {
  LensDistortion lens;
  std::string words;
};

std::vector<Words> known_lenses() {
  const LensDistortion radial{Model::series, {-0.2, 0.05}, {}};
  const LensDistortion one{Model::series, {-0.2}, {}};
  const LensDistortion opencv{Model::series, {-0.2, 0.05}, {0.01, -0.02}};
  const LensDistortion third{Model::series, {-0.2, 0.05, 0.02}, {0.01, -0.02}};
  const LensDistortion fourth{Model::series, {-0.2, 0.05, 0.02, 0.01}, {0.01, -0.02}};
  const LensDistortion full{Model::radial, {0.3, 0.1, 0.02, 0.5, 0.1, 0.02}, {0.01, -0.02}};
  const LensDistortion equidistant{Model::fisheye, {}, {}};
  const LensDistortion fisheye{Model::fisheye, {0.1, -0.02, 0.01, 0.003}, {}};
  return {{one, R"("k1": -0.2)"},
          {one, R"("camera_model": "SIMPLE_RADIAL", "k1": -0.2)"},
          {one, R"("camera_model": "SIMPLE_RADIAL", "k": -0.2)"},
          {radial, R"("camera_model": "RADIAL", "k1": -0.2, "k2": 0.05)"},
          {opencv, R"("camera_model": "OPENCV", "k1": -0.2, "k2": 0.05, "p1": 0.01, "p2": -0.02)"},
          {opencv, R"("camera_model": "opencv", "distortion_params": [-0.2, 0.05, 0.01, -0.02])"},
          {opencv, R"("distortion_params": [-0.2, 0.05, 0, 0, 0.01, -0.02])"},
          {third, R"("distortion_params": [-0.2, 0.05, 0.01, -0.02, 0.02])"},
          {third,
           R"("is_fisheye": false, "k1": -0.2, "k2": 0.05, "k3": 0.02, "p1": 0.01, "p2": -0.02)"},
          {fourth, R"("distortion_params": [-0.2, 0.05, 0.02, 0.01, 0.01, -0.02])"},
          {full, R"("camera_model": "FULL_OPENCV", "k1": 0.3, "k2": 0.1, "k3": 0.02, "k4": 0.5,
                "k5": 0.1, "k6": 0.02, "p1": 0.01, "p2": -0.02)"},
          {full, R"("k1": 0.3, "k2": 0.1, "k3": 0.02, "k4": 0.5, "k5": 0.1, "k6": 0.02, "p1": 0.01,
                "p2": -0.02)"},
          {full, R"("distortion_params": [0.3, 0.1, 0.01, -0.02, 0.02, 0.5, 0.1, 0.02])"},
          {equidistant, R"("is_fisheye": true, "k1": 0, "camera_model": "OPENCV")"},
          {equidistant, R"("camera_model": "OPENCV_FISHEYE")"},
          {fisheye, R"("is_fisheye": true, "k1": 0.1, "k2": -0.02, "k3": 0.01, "k4": 0.003)"},
          {fisheye, R"("camera_model": "OPENCV_FISHEYE", "k1": 0.1, "k2": -0.02, "k3": 0.01,
                   "k4": 0.003, "p1": 0)"},
          {fisheye, R"("camera_model": "FISHEYE", "distortion_params": [0.1, -0.02, 0.01, 0.003])"},
          {fisheye, R"("is_fisheye": 1, "distortion_params": [0.1, -0.02, 0.01, 0.003, 0, 0])"}};
}

TEST(RgbdWords, every_wording_of_a_known_lens_is_undistorted) {
  for (const bool each_frame : {false, true})
    for (const Words& words : known_lenses()) {
      const TemporaryFolder folder;
      write_lens(folder, words.lens, words.words, each_frame);
      const Result<DepthImage> picture = only_picture(folder.path());
      ASSERT_TRUE(picture) << words.words << picture.error().message();
      const auto k = lens_of(picture->camera);
      const auto own = lens_of(pinhole());
      EXPECT_NEAR(k.fl_x, own.fl_x, 1e-6);
      EXPECT_NEAR(k.cy, own.cy, 1e-6);
      int seen = 0, wrong_depth = 0;
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
          if (!picture->covered(x, y)) continue;
          ++seen;
          const glm::dvec2 p((x + 0.5 - k.cx) / k.fl_x, (y + 0.5 - k.cy) / k.fl_y);
          // Interpolated over a texel of 0.02, a curvature of 4 x 4 x 0.4 is off by 4e-4, and at
          // the picture's edge by half a texel of slope 1.6; 8 bits of sRGB by 6e-3.
          const bool inside = x > 1 && y > 1 && x < kWidth - 2 && y < kHeight - 2;
          for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(picture->color(x, y)[c], color_at(p)[c], inside ? 0.012 : 0.035)
                << words.words << " " << x << " " << y;
          const float depth = picture->depth(x, y);
          EXPECT_TRUE(std::abs(depth - 2) < 1e-3 || std::abs(depth - 7) < 1e-3) << depth;
          wrong_depth += std::abs(depth - depth_at(p)) > 0.1 ? 1 : 0;
        }
      // Lenses that bulge show less at the corners; the edge is a texel wide.
      EXPECT_GT(seen, kWidth * kHeight * 3 / 4) << words.words;
      EXPECT_LT(wrong_depth, 60) << words.words;
    }
}

TEST(RgbdWords, unknown_lenses_are_refused_by_name) {
  const std::pair<const char*, const char*> cases[] = {
      {R"("camera_model": "THIN_PRISM_FISHEYE")", "THIN_PRISM_FISHEYE"},
      {R"("camera_model": "FOV", "omega": 0.9)", "FOV"},
      {R"("camera_model": "EQUIRECTANGULAR")", "EQUIRECTANGULAR"},
      {R"("camera_model": 3)", "camera_model"},
      {R"("ftheta_p0": 1.0)", "ftheta_p0"},
      {R"("latlong": true)", "latlong"},
      {R"("omega": 0.9)", "omega"},
      {R"("is_fisheye": true, "p1": 0.1)", "p1"},
      {R"("distortion_params": [0.1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0])", "12 numbers"},
      {R"("distortion_params": [0.1, "x"])", "distortion_params"},
      {R"("k1": "0.1")", "k1"}};
  for (const auto& [words, named] : cases)
    for (const bool each_frame : {false, true}) {
      const TemporaryFolder folder;
      write_lens(folder, {}, words, each_frame);
      const Result<DepthImage> picture = only_picture(folder.path());
      ASSERT_FALSE(picture) << words;
      EXPECT_NE(picture.error().reason.find(named), std::string::npos) << picture.error().reason;
    }
  for (const char* words : {R"("latlong": false)", R"("distortion_params": [0, 0, 0, 0])",
                            R"("distortion_params": [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0])",
                            R"("camera_model": "PERSPECTIVE", "k1": null)"}) {
    const TemporaryFolder folder;
    write_lens(folder, {}, words);
    const Result<DepthImage> picture = only_picture(folder.path());
    ASSERT_TRUE(picture) << words << picture.error().message();
    EXPECT_TRUE(picture->covered(0, 0));
  }
}

TEST(RgbdWords, open3d_intrinsics_may_have_distortion) {
  const TemporaryFolder folder;
  const LensDistortion lens{Model::series, {-0.2, 0.05}, {}};
  test_rgbd::write_capture(folder.path(), RgbdFormat::redwood, {photograph(lens)});
  edit(folder / "camera_intrinsic.json", [](const std::string& text) {
    return all_replaced(text, "{\"width\"", "{\"k1\": -0.2, \"k2\": 0.05, \"width\"");
  });
  const Result<DepthImage> picture = only_picture(folder.path());
  ASSERT_TRUE(picture) << picture.error().message();
  const auto k = lens_of(picture->camera);
  EXPECT_NEAR(picture->color(50, 40).r,
              color_at({(50.5 - k.cx) / k.fl_x, (40.5 - k.cy) / k.fl_y}).r, 0.012);
}

TEST(RgbdWords, focal_lengths_and_angles_say_the_same) {
  const Camera camera = pinhole();
  const auto k = lens_of(camera);
  const std::string fl_x = fmt::format("\"fl_x\": {:.12g}, \"fl_y\": {:.12g}, ", k.fl_x, k.fl_y);
  const double x = 2 * std::atan(0.5 * kWidth / (0.5 * k.fl_x));
  const double y = 2 * std::atan(0.5 * kHeight / k.fl_y);
  struct Case {
    std::string members;
    double fl_x, fl_y;
  };
  const Case cases[] = {
      {fmt::format("\"camera_angle_x\": {:.12g}, \"camera_angle_y\": {:.12g}, ", x, y), k.fl_x / 2,
       k.fl_y},
      {fmt::format("\"camera_angle_x\": {:.12g}, ", x), k.fl_x / 2, k.fl_x / 2},
      {fmt::format("\"camera_angle_y\": {:.12g}, ", y), k.fl_y, k.fl_y},
      {fmt::format("\"fl_x\": {:.12g}, \"camera_angle_y\": {:.12g}, ", k.fl_x / 2, y), k.fl_x / 2,
       k.fl_y},
      {fmt::format("\"fl_x\": 50, \"fl_y\": {:.12g}, \"camera_angle_x\": {:.12g}, ", k.fl_y, x), 50,
       k.fl_y},
      {"\"fl_y\": 50, ", 50, 50},
      {"\"fl_x\": 50, ", 50, 50}};
  for (const Case& c : cases)
    for (const bool each_frame : {true, false}) {
      const TemporaryFolder folder;
      test_rgbd::write_capture(folder.path(), RgbdFormat::nerfstudio, {photograph({})});
      edit(folder / "transforms.json", [&](const std::string& text) {
        std::string bare = all_replaced(text, fl_x, each_frame ? c.members : "");
        return each_frame ? bare : all_replaced(bare, "\"k1\": 0.0, ", c.members);
      });
      const Result<DepthImage> picture = only_picture(folder.path());
      ASSERT_TRUE(picture) << c.members << picture.error().message();
      EXPECT_NEAR(lens_of(picture->camera).fl_x, c.fl_x, 1e-6) << c.members;
      EXPECT_NEAR(lens_of(picture->camera).fl_y, c.fl_y, 1e-6) << c.members;
    }
}

TEST(RgbdWords, files_are_paired_in_the_order_of_numbers) {
  std::vector<std::string> names{"a10", "a9", "b1", "a010", "10", "2", "a", "1", "02", "a9x", ""};
  std::sort(names.begin(), names.end(), rgbd::comes_before);
  const std::vector<std::string> expected{"",   "1",   "02",   "2",   "10", "a",
                                          "a9", "a9x", "a010", "a10", "b1"};
  EXPECT_EQ(names, expected);
  std::mt19937 rng(3);
  for (int round = 0; round < 2000; ++round) {  // a strict weak order
    std::string words[3];
    for (std::string& word : words)
      for (int i = 0; i < int(rng() % 5); ++i) word += "01a2"[rng() % 4];
    const auto before = rgbd::comes_before;
    EXPECT_FALSE(before(words[0], words[0]));
    EXPECT_FALSE(before(words[0], words[1]) && before(words[1], words[0]));
    EXPECT_TRUE(words[0] == words[1] || before(words[0], words[1]) || before(words[1], words[0]));
    const bool chain = before(words[0], words[1]) && before(words[1], words[2]);
    EXPECT_TRUE(!chain || before(words[0], words[2]))
        << words[0] << " " << words[1] << " " << words[2];
  }
  // Twelve frames without leading zeros, of which each has a depth of its own.
  const TemporaryFolder folder;
  std::vector<DepthImage> pictures(12, photograph({}));
  for (std::size_t i = 0; i < 12; ++i)
    pictures[i].depth = Image<float>(kWidth, kHeight, 1.0f + float(i));
  test_rgbd::write_capture(folder.path(), RgbdFormat::redwood, pictures);
  for (const char* sub : {"color", "depth"})
    for (int i = 0; i < 12; ++i)
      fs::rename(folder / sub / fmt::format("frame-{:06}.png", i),
                 folder / sub / fmt::format("{}.PNG", i));
  const Result<RgbdCapture> capture = open_rgbd_capture(folder.path());
  ASSERT_TRUE(capture) << capture.error().message();
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(capture->frames[i].name, std::to_string(i));
    EXPECT_NEAR(load_rgbd_frame(capture->frames[i])->depth(3, 3), 1.0 + double(i), 1e-3);
  }
}

// The left half is masked out, by light or dark.
void write_mask(const fs::path& file, bool dark) {
  Rgba8Image mask(kWidth, kHeight, glm::u8vec4(255));
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      if ((x < kWidth / 2) == dark) mask(x, y) = {0, 0, 0, 255};
  fs::create_directories(file.parent_path());
  (void)save_png(file, mask);
}

TEST(RgbdWords, masks_are_applied) {
  struct Case {
    RgbdFormat format;
    const char* file;
    bool dark;
    const char* member;
  };
  const Case cases[] = {
      {RgbdFormat::nerfstudio, "m/any.png", true, "\"mask_path\": \"m/any.png\""},
      {RgbdFormat::nerfstudio, "m/any.png", true, "\"mask_path\": \"m\\\\any.png\""},
      {RgbdFormat::nerfstudio, "m/any.png", true, "\"mask_path\": \"m/any\""},
      {RgbdFormat::nerfstudio, "masks/frame-000000.png", true, ""},
      {RgbdFormat::nerfstudio, "masks/frame-000000.png.png", true, ""},
      {RgbdFormat::nerfstudio, "color/dynamic_mask_frame-000000.png", false, ""},
      {RgbdFormat::redwood, "mask/frame-000000.png", true, ""},
      {RgbdFormat::pose_files, "frame-000000.mask.png", true, ""}};
  for (const Case& c : cases) {
    const TemporaryFolder folder;
    test_rgbd::write_capture(folder.path(), c.format, {photograph({})});
    write_mask(folder / c.file, c.dark);
    if (*c.member)
      edit(folder / "transforms.json", [&](const std::string& text) {
        return all_replaced(text, "{\"file_path\"",
                            std::string("{") + c.member + ", \"file_path\"");
      });
    const Result<DepthImage> picture = only_picture(folder.path());
    ASSERT_TRUE(picture) << c.file << picture.error().message();
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        EXPECT_EQ(picture->covered(x, y), x >= kWidth / 2) << c.file;
        EXPECT_EQ(picture->color(x, y).a, x >= kWidth / 2 ? 1 : 0);
      }
    (void)save_png(folder / c.file, Rgba8Image(3, 3));
    const Result<DepthImage> small = only_picture(folder.path());
    ASSERT_FALSE(small) << c.file;
    EXPECT_NE(small.error().message().find("3 x 3"), std::string::npos) << small.error().message();
  }
  const TemporaryFolder folder;
  write_lens(folder, {}, "\"mask_path\": \"gone.png\"", true);
  EXPECT_NE(only_picture(folder.path()).error().message().find("gone.png"), std::string::npos);
}

TEST(RgbdWords, paths_may_be_written_as_windows_does) {
  const TemporaryFolder folder;
  write_lens(folder, {}, "\"k1\": 0");
  edit(folder / "transforms.json", [](const std::string& text) {
    return all_replaced(all_replaced(text, "color/", ".\\\\color\\\\"), "depth/", "depth\\\\");
  });
  EXPECT_TRUE(only_picture(folder.path()));
  edit(folder / "transforms.json",
       [](const std::string& text) { return all_replaced(text, "depth\\\\", "..\\\\depth\\\\"); });
  const Result<DepthImage> outside = only_picture(folder.path());
  ASSERT_FALSE(outside);
  EXPECT_NE(outside.error().reason.find("--allow-outside"), std::string::npos);
}

TEST(RgbdWords, a_frame_whose_camera_was_not_found_is_left_out) {
  const std::vector<DepthImage> three(3, photograph({}));
  const std::string identity = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  for (const std::string& lost :
       {std::string("-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf "
                    "-inf -inf\n-inf -inf -inf -inf\n"),
        all_replaced(identity, "1", "0"), all_replaced(identity, "1", "nan")}) {
    const TemporaryFolder poses, log;
    test_rgbd::write_capture(poses.path(), RgbdFormat::pose_files, three);
    (void)write_file(poses / "frame-000001.pose.txt", lost);
    test_rgbd::write_capture(log.path(), RgbdFormat::redwood, three);
    (void)write_file(log / "trajectory.log",
                     "0 0 1\n" + identity + "1 1 2\n" + lost + "2 2 3\n" + identity);
    for (const fs::path& folder : {poses.path(), log.path()}) {
      const Result<RgbdCapture> capture = open_rgbd_capture(folder);
      ASSERT_TRUE(capture) << capture.error().message();
      ASSERT_EQ(capture->frames.size(), 2u);
      EXPECT_EQ(capture->frames[1].name, "frame-000002");
      EXPECT_EQ(capture->warnings.lines().size(), 1u);
    }
  }
  for (const char* number : {"NaN", "null", "\"nan\"", "-Infinity", "Infinity"}) {
    const TemporaryFolder folder;
    test_rgbd::write_capture(folder.path(), RgbdFormat::nerfstudio, three);
    edit(folder / "transforms.json", [&](std::string text) {
      const std::size_t second = text.find("[[", text.find("[[") + 1) + 2;
      return text.replace(second, text.find(',', second) - second, number);
    });
    const Result<RgbdCapture> capture = open_rgbd_capture(folder.path());
    ASSERT_TRUE(capture) << number << capture.error().message();
    EXPECT_EQ(capture->frames.size(), 2u);
    const std::vector<std::string> expected{"frame 1: the pose is not finite; it is left out"};
    EXPECT_EQ(capture->warnings.lines(), expected);
  }
}

}  // namespace
}  // namespace rilievo
