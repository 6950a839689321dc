#include "rilievo/io/rgbd.h"

#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "rilievo/core/file_test_helpers.h"
#include "rilievo/io/rgbd_test_helpers.h"

namespace rilievo {
namespace {

constexpr RgbdFormat kFormats[] = {RgbdFormat::nerfstudio, RgbdFormat::redwood,
                                   RgbdFormat::pose_files};

// A ball in front of a wall z = -1 of the world, by formula; every hundredth texel not measured.
DepthImage ball_picture(const Camera& camera) {
  DepthImage p;
  p.camera = camera;
  p.color = ColorImage(camera.width, camera.height);
  p.depth = Image<float>(camera.width, camera.height, kNoDepth);
  const glm::dvec3 eye = camera.position();
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const glm::dvec3 ray = world_from_raster(camera, {x + 0.5, y + 0.5}, 1.0) - eye;
      double t = ray.z < 0 ? (-1 - eye.z) / ray.z : 0;
      const double a = glm::dot(ray, ray), b = glm::dot(ray, eye), c = glm::dot(eye, eye) - 0.25;
      const bool ball = b * b > a * c;
      if (ball) t = (-b - std::sqrt(b * b - a * c)) / a;
      p.color(x, y) = glm::vec4(ball ? 0.5f : 0.1f, float(x) / 64, float(y) / 64, 1.0f);
      if (t > 0 && t < 60 && (x + y * camera.width) % 100 != 0) p.depth(x, y) = float(t);
    }
  return p;
}

// Cameras around the ball, their axes off the centre.
std::vector<DepthImage> ball_capture(unsigned seed, int count, bool one_lens) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<DepthImage> pictures;
  for (int i = 0; i < count; ++i) {
    Camera c = look_at({1.5 * u(rng), 1.5 * u(rng), 3 + u(rng)}, {0.2 * u(rng), 0.2 * u(rng), 0},
                       {0.2 * u(rng), 1, 0}, 0.7, 48, 40, 0.1, 100);
    if (i && one_lens) {
      c.window = pictures[0].camera.window;
    } else {
      c.window.left *= 1 + 0.3 * u(rng);
      c.window.top *= 1 + 0.3 * u(rng);
    }
    pictures.push_back(ball_picture(c));
  }
  return pictures;
}

TEST(Rgbd, captures_of_every_kind_come_back) {
  for (unsigned seed = 0; seed < 4; ++seed)
    for (RgbdFormat format : kFormats) {
      const TemporaryFolder folder;
      const std::vector<DepthImage> truth = ball_capture(seed, 3, format != RgbdFormat::nerfstudio);
      test_rgbd::write_capture(folder.path(), format, truth);
      EXPECT_TRUE(is_rgbd_capture(folder.path()));
      const Result<RgbdCapture> capture = open_rgbd_capture(folder.path());
      ASSERT_TRUE(capture) << capture.error().message();
      EXPECT_EQ(capture->format, format);
      ASSERT_EQ(capture->frames.size(), truth.size());
      for (std::size_t i = 0; i < truth.size(); ++i) {
        const Result<DepthImage> read = load_rgbd_frame(capture->frames[i]);
        ASSERT_TRUE(read) << read.error().message();
        const Camera &a = truth[i].camera, &b = read->camera;
        for (int k = 0; k < 16; ++k)
          EXPECT_NEAR(a.world_from_eye[k / 4][k % 4], b.world_from_eye[k / 4][k % 4], 1e-6);
        EXPECT_NEAR(a.window.left, b.window.left, 1e-9);
        EXPECT_NEAR(a.window.right, b.window.right, 1e-9);
        EXPECT_NEAR(a.window.bottom, b.window.bottom, 1e-9);
        EXPECT_NEAR(a.window.top, b.window.top, 1e-9);
        for (int y = 0; y < a.height; ++y)
          for (int x = 0; x < a.width; ++x) {
            ASSERT_EQ(truth[i].covered(x, y), read->covered(x, y));
            // Half a millimetre, and the float's rounding.
            if (read->covered(x, y)) {
              EXPECT_NEAR(truth[i].depth(x, y), read->depth(x, y), 0.000501);
            }
            // An eighth bit of sRGB: at most 1.2 % of linear 1 near white, and its rounding.
            for (int c = 0; c < 3; ++c)
              EXPECT_NEAR(truth[i].color(x, y)[c], read->color(x, y)[c], 0.0062);
            EXPECT_EQ(read->color(x, y).a, 1.0f);
          }
      }
    }
}

// Changes one file of a good capture and says what opening, or loading all frames, then answers.
struct Case {
  RgbdFormat format;
  const char* file;
  std::string (*change)(const std::string&);
  const char* expected;  // part of the message; the file's name must be in it too
};

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  if (at != text.npos) text.replace(at, what.size(), by);
  return text;
}

std::string answer(const std::filesystem::path& folder) {
  const Result<RgbdCapture> capture = open_rgbd_capture(folder);
  if (!capture) return capture.error().message();
  for (const RgbdFrame& frame : capture->frames) {
    const Result<DepthImage> picture = load_rgbd_frame(frame);
    if (!picture) return picture.error().message();
    EXPECT_TRUE(validate(*picture));
  }
  return "fine";
}

std::string content(const std::filesystem::path& path) {
  return *read_file(path, std::uint64_t(1) << 30);
}

TEST(Rgbd, what_is_wrong_is_named) {
  const auto identity = [](const std::string& text) { return text; };
  using S = const std::string&;
  const Case cases[] = {
      {RgbdFormat::nerfstudio, "transforms.json", identity, "fine"},
      {RgbdFormat::nerfstudio, "transforms.json", [](S s) { return s.substr(0, s.size() / 2); },
       "not valid JSON"},
      {RgbdFormat::nerfstudio, "transforms.json", [](S) { return std::string("{}"); }, "frames"},
      {RgbdFormat::nerfstudio, "transforms.json", [](S) { return std::string("{\"frames\": []}"); },
       "without frames"},
      {RgbdFormat::nerfstudio, "transforms.json",
       [](S s) { return replaced(s, "\"k1\": 0.0", "\"omega\": 0.01"); }, "distorted"},
      {RgbdFormat::nerfstudio, "transforms.json",
       [](S s) { return replaced(s, "\"k1\": 0.0", "\"camera_model\": \"FISHEYE624\""); },
       "camera_model"},
      {RgbdFormat::nerfstudio, "transforms.json",
       [](S s) { return replaced(s, "\"k1\": 0.0", "\"integer_depth_scale\": 0"); }, "unit"},
      {RgbdFormat::nerfstudio, "transforms.json",
       [](S s) { return replaced(s, "\"w\": 48", "\"w\": 47"); }, "47 x 40"},
      {RgbdFormat::nerfstudio, "transforms.json",
       [](S s) { return replaced(s, "[[", "[[NaN, 0, 0, 0], [["); }, "not valid JSON"},
      {RgbdFormat::nerfstudio, "transforms.json",
       [](S s) { return replaced(s, "[[", "[[null, 0, 0, 0], ["); }, "transform_matrix"},
      {RgbdFormat::nerfstudio, "transforms.json", [](S s) { return replaced(s, "[[", "[[9"); },
       "orthonormal"},
      {RgbdFormat::nerfstudio, "transforms.json",
       [](S s) { return replaced(s, "\"fl_x\": ", "\"fl_x\": -"); }, "focal length"},
      {RgbdFormat::nerfstudio, "transforms.json",
       [](S s) { return replaced(replaced(s, "\"fl_x\"", "\"flx\""), "\"fl_y\"", "\"fly\""); },
       "camera_angle_x"},
      {RgbdFormat::nerfstudio, "transforms.json",
       [](S s) { return replaced(s, "\"depth_file_path\"", "\"depth\""); }, "depth_file_path"},
      {RgbdFormat::nerfstudio, "transforms.json",
       [](S s) { return replaced(s, "frame-000001.png", "nowhere.png"); }, "missing"},
      {RgbdFormat::redwood, "trajectory.log", identity, "fine"},
      {RgbdFormat::redwood, "trajectory.log", [](S s) { return s.substr(0, s.size() - 20); },
       "entry 2"},
      {RgbdFormat::redwood, "trajectory.log", [](S s) { return s + "3 3 4\n"; },
       "fewer than five lines"},
      {RgbdFormat::redwood, "trajectory.log",
       [](S s) { return s + "3 3 4\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"; }, "no image"},
      {RgbdFormat::redwood, "trajectory.log",
       [](S) { return std::string("0 0 1\n1 0 0 0\n1 0 0 0\n0 0 1 0\n0 0 0 1\n"); }, "singular"},
      {RgbdFormat::redwood, "trajectory.log",
       [](S) { return std::string("0 0 1\n-1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"); }, "mirrors"},
      {RgbdFormat::redwood, "trajectory.log",
       [](S) { return std::string("0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 2\n"); }, "last row"},
      {RgbdFormat::redwood, "trajectory.log",
       [](S) { return std::string("0 0 1\n1 0 0 nan\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"); }, "finite"},
      {RgbdFormat::redwood, "camera_intrinsic.json", [](S) { return std::string("[]"); }, "JSON"},
      {RgbdFormat::redwood, "camera_intrinsic.json",
       [](S s) { return replaced(s, "\"height\": 40", "\"height\": 41"); }, "40"},
      {RgbdFormat::pose_files, "frame-000001.pose.txt", identity, "fine"},
      {RgbdFormat::pose_files, "frame-000001.pose.txt", [](S) { return std::string(); },
       "16 numbers"},
      {RgbdFormat::pose_files, "frame-000001.pose.txt", [](S s) { return s + "1"; }, "16 numbers"},
      {RgbdFormat::pose_files, "frame-000001.pose.txt",
       [](S) { return std::string("1e300 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"); }, "orthonormal"},
      {RgbdFormat::pose_files, "frame-000001.pose.txt",
       [](S) { return std::string("1 0 0 0\n0 1 0x 0\n0 0 1 0\n0 0 0 1\n"); },
       "line 2 has '0x' where a number belongs"},
      {RgbdFormat::pose_files, "frame-000001.pose.txt",
       [](S) { return std::string("1 0 0 0,5\n0 1,0 0 0\n0 0 1 0\n0 0 0 1\n"); }, "fine"},
      {RgbdFormat::redwood, "trajectory.log",
       [](S) { return std::string("0 0 1\n1 0 0 0\n\n0 1 0 2,5,5\n0 0 1 0\n0 0 0 1\n"); },
       "entry 0: line 4 has '2,5,5'"},
      {RgbdFormat::pose_files, "camera-intrinsics.txt",
       [](S s) { return replaced(s, " 0 ", " 1 "); }, "matrix"},
      {RgbdFormat::pose_files, "camera-intrinsics.txt", [](S s) { return "-" + s; },
       "focal length"},
      {RgbdFormat::pose_files, "frame-000002.depth.png", [](S s) { return s.substr(0, 40); },
       "cannot be decoded"},
      {RgbdFormat::pose_files, "frame-000002.depth.png",
       [](S) { return test_png::grey16_png(Image<std::uint16_t>(48, 40)); }, "no depth"},
      {RgbdFormat::pose_files, "frame-000002.depth.png",
       [](S) { return test_png::grey16_png(Image<std::uint16_t>(40, 48, 1000)); }, "40 x 48"},
      {RgbdFormat::pose_files, "frame-000002.depth.png",
       [](S) {
         const auto png = encode_png(Rgba8Image(48, 40));
         return std::string(png.begin(), png.end());
       },
       "16-bit grey"},
      {RgbdFormat::pose_files, "frame-000002.color.png", [](S) { return std::string("GIF89a"); },
       "cannot be decoded"},
  };
  for (const Case& c : cases) {
    const TemporaryFolder folder;
    test_rgbd::write_capture(folder.path(), c.format, ball_capture(7, 3, true));
    const std::filesystem::path file = folder / c.file;
    (void)write_file(file, c.change(content(file)));
    const std::string said = answer(folder.path());
    EXPECT_NE(said.find(c.expected), said.npos) << c.file << ": " << said;
    if (said != "fine") {
      EXPECT_NE(said.find(folder.path().string()), said.npos) << said;
      EXPECT_EQ(said.find('\n'), said.npos) << said;
    }
  }
}

TEST(Rgbd, missing_files_are_named) {
  for (const char* file : {"frame-000001.color.png", "frame-000002.depth.png"}) {
    const TemporaryFolder folder;
    test_rgbd::write_capture(folder.path(), RgbdFormat::pose_files, ball_capture(8, 3, true));
    std::filesystem::remove(folder / file);
    EXPECT_NE(answer(folder.path()).find(file), std::string::npos);
  }
  const TemporaryFolder folder;
  EXPECT_FALSE(is_rgbd_capture(folder.path()));
  EXPECT_NE(answer(folder.path()).find("is no capture"), std::string::npos);
  EXPECT_NE(answer(folder / "transforms.json").find("missing"), std::string::npos);
  test_rgbd::write_capture(folder.path(), RgbdFormat::redwood, ball_capture(8, 3, true));
  std::filesystem::remove(folder / "depth/frame-000000.png");
  EXPECT_NE(answer(folder.path()).find("3 colour images but 2 of depth"), std::string::npos);
}

TEST(Rgbd, damaged_texts_never_do_harm) {
  std::mt19937 rng(9);
  const char* files[] = {"transforms.json", "trajectory.log", "frame-000000.pose.txt"};
  for (int k = 0; k < 3; ++k) {
    const TemporaryFolder folder;
    test_rgbd::write_capture(folder.path(), kFormats[k], ball_capture(9, 1, true));
    const std::string good = content(folder / files[k]);
    const std::string alphabet = "0123456789.-+eE[]{},:\"\n nainf\\u";
    for (int round = 0; round < 400; ++round) {
      std::string bad = good;
      for (int i = 0; i < 3; ++i) bad[rng() % bad.size()] = alphabet[rng() % alphabet.size()];
      if (round % 4 == 0) bad.resize(rng() % bad.size());
      (void)write_file(folder / files[k], bad);
      EXPECT_EQ(answer(folder.path()).find('\n'), std::string::npos);
    }
  }
}

// Where a texel of one frame, put back into the world, lands in another, that one measures nearly
// the same depth: poses, lens and units are those of the capture.
double median_disagreement(const DepthImage& a, const DepthImage& b) {
  std::vector<double> off;
  for (int y = 0; y < a.camera.height; y += 4)
    for (int x = 0; x < a.camera.width; x += 4) {
      if (!a.covered(x, y)) continue;
      const glm::dvec3 there = raster_from_world(
          b.camera, world_from_raster(a.camera, {x + 0.5, y + 0.5}, a.depth(x, y)));
      const int u = int(std::floor(there.x)), v = int(std::floor(there.y));
      if (there.z <= 0 || u < 0 || v < 0 || u >= b.camera.width || v >= b.camera.height) continue;
      if (b.covered(u, v)) off.push_back(std::abs(there.z / b.depth(u, v) - 1));
    }
  EXPECT_GT(off.size(), 5000u);
  std::nth_element(off.begin(), off.begin() + std::ptrdiff_t(off.size() / 2), off.end());
  return off[off.size() / 2];
}

TEST(Rgbd, real_captures_agree_with_themselves) {
  const char* data = std::getenv("RILIEVO_DATA");
  if (!data) GTEST_SKIP() << "RILIEVO_DATA is not set";
  for (const auto& [name, count] : {std::pair("tsdf_fusion_room", 8), {"open3d_redwood", 5}}) {
    const Result<RgbdCapture> capture =
        open_rgbd_capture(std::filesystem::path(data) / "rgbd" / name);
    ASSERT_TRUE(capture) << capture.error().message();
    ASSERT_EQ(int(capture->frames.size()), count);
    std::vector<DepthImage> pictures;
    for (const RgbdFrame& frame : capture->frames) {
      Result<DepthImage> picture = load_rgbd_frame(frame);
      ASSERT_TRUE(picture) << picture.error().message();
      pictures.push_back(*std::move(picture));
    }
    for (std::size_t i = 0; i + 1 < pictures.size(); ++i)
      // 0.3 to 0.9 % is what these captures are known to reach.
      EXPECT_LT(median_disagreement(pictures[i], pictures[i + 1]), 0.01) << name << " " << i;
  }
}

}  // namespace
}  // namespace rilievo
