#include "rilievo/keyframes/software/sampled_loss.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "rilievo/core/camera_path.h"
#include "rilievo/frame/software/software_frames.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

// Draws polygons.
class Polygons final : public FrameChooser {
 public:
  void add_sets(FrameContent&) override {}
  Result<> choose(const Camera& camera, const PlacedScene& placed, FrameContent& content,
                  FrameStats&) override {
    placed.cull(camera, content.polygons);
    return Done{};
  }
};

double mean_square(const Rgba8Image& a, const Rgba8Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.texels().size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const double d = double(a.texels()[i][c]) - double(b.texels()[i][c]);
      sum += d * d;
    }
  return sum / double(a.texels().size());
}

Image<std::uint32_t> warped_as(const Rgba8Image& frame) {
  Image<std::uint32_t> colors(frame.width(), frame.height());
  for (std::size_t i = 0; i < frame.texels().size(); ++i) {
    const glm::u8vec4& c = frame.texels()[i];
    colors.texels()[i] = c.r | c.g << 8 | c.b << 16 | 0xff000000u;
  }
  return colors;
}

// n x n squares in a plane that faces z, 2 apart, of half sides `half`.
Scene squares(int n, float half) {
  Scene scene;
  Mesh& mesh = scene.meshes.emplace_back();
  for (int i = 0; i < n * n; ++i) {
    const glm::vec3 middle(2 * (i % n) - n + 1, 2 * (i / n) - n + 1, 0);
    const auto first = std::uint32_t(mesh.positions.size());
    for (const glm::vec2 corner : {glm::vec2(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
      mesh.positions.push_back(middle + half * glm::vec3(corner, 0));
    for (const std::uint32_t k : {0, 1, 2, 0, 2, 3}) mesh.indices.push_back(first + k);
  }
  mesh.normals.assign(mesh.positions.size(), {0, 0, 1});
  scene.models.resize(1);
  scene.models[0].parts = {{0, glm::mat4(1)}};
  scene.objects.resize(1);
  finish(scene);
  return scene;
}

class SampledLossTest : public ::testing::Test {
 protected:
  static constexpr int kWidth = 128, kHeight = 96;

  void SetUp() override {
    auto built = make_builtin("builtin:bridge?triangles=100000");
    ASSERT_TRUE(built.ok());
    path_ = built->path;
    use(std::move(built->scene));
  }
  void use(Scene scene) {
    scene_ = std::move(scene);
    Result<RayScene> rays = RayScene::create(scene_);
    ASSERT_TRUE(rays.ok());
    rays_.emplace(std::move(*rays));
    objects_.resize(scene_.objects.size());
    std::iota(objects_.begin(), objects_.end(), 0);
  }
  Rgba8Image draw(const Camera& camera, int scale) {
    SoftwareBackend backend(scene_, 4);
    SoftwareFrames frames(backend, std::make_unique<Polygons>());
    Camera larger = camera;
    larger.width *= scale, larger.height *= scale;
    EXPECT_TRUE(frames.draw(larger, 0).ok());
    return frames.software_target()->color();
  }
  // Bytes are averaged, as samples are.
  static Rgba8Image halved(const Rgba8Image& fine) {
    Rgba8Image half(fine.width() / 2, fine.height() / 2);
    for (int y = 0; y < half.height(); ++y)
      for (int x = 0; x < half.width(); ++x) {
        glm::ivec4 sum(2);
        for (int i = 0; i < 4; ++i) sum += glm::ivec4(fine(2 * x + i % 2, 2 * y + i / 2));
        half(x, y) = glm::u8vec4(sum / 4);
      }
    return half;
  }

  struct Off {
    double mean = 0, rms = 0;
  };
  Off looks_at(const Camera& camera, const Rgba8Image& of_direct, const Rgba8Image& shown,
               int looks);
  void expect_ratio_of_whole_frames(const std::function<Camera(int)>& camera_of, double within_db);

  Scene scene_;
  CameraPath path_;
  std::optional<RayScene> rays_;
  std::vector<std::uint32_t> objects_;
};

TEST_F(SampledLossTest, direct_drawing_loses_nothing) {
  SampledLoss loss(*rays_);
  for (int i = 0; i < 20; ++i) {
    const Camera camera = camera_at(path_, frame_time(path_, 2 * i), kWidth, kHeight);
    loss.add(camera, objects_, warped_as(draw(camera, 1)).texels());
  }
  ASSERT_TRUE(loss.known());
  // Rays and the rasteriser differ at samples on edges, and bytes are rounded once more.
  EXPECT_NEAR(loss.loss_db(), 0, 0.3);
}

TEST_F(SampledLossTest, holes_are_filled_and_lose_nothing) {
  SampledLoss loss(*rays_);
  for (int i = 0; i < 20; ++i)
    loss.add(camera_at(path_, frame_time(path_, 2 * i), kWidth, kHeight), objects_,
             Image<std::uint32_t>(kWidth, kHeight, 0u).texels());
  ASSERT_TRUE(loss.known());
  EXPECT_EQ(loss.loss_db(), 0);
}

// Of frames that are a pixel off; `camera_of` has the i-th.
void SampledLossTest::expect_ratio_of_whole_frames(const std::function<Camera(int)>& camera_of,
                                                   double within_db) {
  SampledLoss loss(*rays_);
  double direct = 0, shown = 0;
  for (int i = 0; i < 40; ++i) {
    const Camera camera = camera_of(i);
    const Rgba8Image truth = halved(draw(camera, 2)), of_direct = draw(camera, 1);
    Rgba8Image off = of_direct;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 1; x < kWidth; ++x) off(x, y) = of_direct(x - 1, y);
    direct += mean_square(of_direct, truth), shown += mean_square(off, truth);
    loss.add(camera, objects_, warped_as(off).texels(), 1, 1);
  }
  ASSERT_TRUE(loss.known());
  const double frames_loss = SampledLoss::loss_db(shown, direct, 40);
  EXPECT_NEAR(loss.loss_db(), frames_loss, within_db);
  loss.forget();
  EXPECT_FALSE(loss.known());
}

TEST_F(SampledLossTest, it_is_the_ratio_of_the_whole_frames_errors) {
  // Most of the errors are at edges.
  expect_ratio_of_whole_frames(
      [&](int i) { return camera_at(path_, frame_time(path_, 2 * i), kWidth, kHeight); }, 0.6);
}

// Of one frame: the mean of what is off, dB, and its square root.
SampledLossTest::Off SampledLossTest::looks_at(const Camera& camera, const Rgba8Image& of_direct,
                                               const Rgba8Image& shown, int looks) {
  constexpr int kTimes = 60;
  const Rgba8Image truth = halved(draw(camera, 2));
  const double true_db =
      SampledLoss::loss_db(mean_square(shown, truth), mean_square(of_direct, truth), 1);
  SampledLoss loss(*rays_);
  Off off;
  for (int i = 0; i < kTimes; ++i) {
    loss.forget();
    loss.add(camera, objects_, warped_as(shown).texels(), looks);
    const double db = loss.loss_db() - true_db;
    off.mean += db / kTimes, off.rms += db * db / kTimes;
  }
  off.rms = std::sqrt(off.rms);
  return off;
}

// A pixel off, as many of any pixels are off by 0.9 dB.
TEST_F(SampledLossTest, looks_at_one_frame_agree) {
  const Camera camera = camera_at(path_, frame_time(path_, 20), kWidth, kHeight);
  const Rgba8Image of_direct = draw(camera, 1);
  Rgba8Image shown = of_direct;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 1; x < kWidth; ++x) shown(x, y) = of_direct(x - 1, y);
  const Off off = looks_at(camera, of_direct, shown, 8);
  EXPECT_LT(off.rms, 0.7);
  EXPECT_LT(std::abs(off.mean), 0.25);
}

// What is wrong all over, a fiftieth of the frame, has no edge inside.
TEST_F(SampledLossTest, what_is_missing_is_found) {
  const Camera camera = camera_at(path_, frame_time(path_, 20), kWidth, kHeight);
  const Rgba8Image of_direct = draw(camera, 1);
  Rgba8Image shown = of_direct;
  for (int y = 60; y < 76; ++y)
    for (int x = 30; x < 46; ++x) shown(x, y) = {90, 90, 90, 255};
  const Off off = looks_at(camera, of_direct, shown, 16);
  EXPECT_LT(off.rms, 0.7);
  EXPECT_LT(std::abs(off.mean), 0.25);
}

// So more of what was seen must be remembered.
TEST_F(SampledLossTest, what_is_known_stays_known_where_little_is_surfaces) {
  for (const float half : {0.06f, 0.08f, 0.1f, 0.14f, 0.2f}) {
    use(squares(2, half));
    const Camera camera = look_at({0, 0, 10}, {0, 0, 0}, {0, 1, 0}, 0.8, kWidth, kHeight, 1, 200);
    const Rgba8Image own = draw(camera, 1);
    SampledLoss loss(*rays_);
    loss.add(camera, objects_, warped_as(own).texels(), 64);
    for (int i = 0; i < 100; ++i) {
      ASSERT_TRUE(loss.known()) << half << ", " << i;
      loss.add(camera, objects_, warped_as(own).texels());
    }
  }
}

TEST_F(SampledLossTest, the_smallest_frames_can_be_looked_at) {
  for (const auto& [width, height] : {std::pair(1, 1), {1, 9}, {16, 1}}) {
    const Camera camera = look_at({0, 0, 10}, {0, 0, 0}, {0, 1, 0}, 0.8, width, height, 1, 200);
    SampledLoss loss(*rays_);
    loss.add(camera, objects_, Image<std::uint32_t>(width, height, 0u).texels(), 4);
    EXPECT_EQ(loss.loss_db(), 0) << width << " x " << height;
  }
}

TEST_F(SampledLossTest, many_looks_at_one_frame_are_forgotten_as_few) {
  const Camera camera = camera_at(path_, 0, kWidth, kHeight);
  const Rgba8Image own = draw(camera, 1);
  Rgba8Image black = own;
  for (glm::u8vec4& color : black.texels()) color = {0, 0, 0, 255};
  SampledLoss loss(*rays_);
  loss.add(camera, objects_, warped_as(black).texels(), 64);
  const double of_black = loss.loss_db();
  for (int i = 0; i < 44; ++i) loss.add(camera, objects_, warped_as(own).texels());
  // 0.9^44 is 0.01.
  EXPECT_LT(loss.loss_db(), of_black - 15);
}

TEST_F(SampledLossTest, edges_before_the_sky_count) {
  use(squares(16, 0.5f));
  // All errors are there, in a quarter of the pixels.
  expect_ratio_of_whole_frames(
      [&](int i) {
        const double x = 0.1 * i;
        return look_at({x, 0.7 * x, 20}, {x, 0.3 * x, 0}, {0, 1, 0}, 0.8, kWidth, kHeight, 1, 200);
      },
      0.5);
}

// They fill a fiftieth of the frame: of as many pixels of all of it one in a thousand would be at
// an edge.
TEST_F(SampledLossTest, what_fills_little_of_the_frame_is_found) {
  use(squares(2, 0.9f));
  expect_ratio_of_whole_frames(
      [&](int i) {
        const double x = 0.05 * i;
        return look_at({x, 0.7 * x, 40}, {x + 2, 0.3 * x, 0}, {0, 1, 0}, 0.8, kWidth, kHeight, 1,
                       200);
      },
      0.5);
}

// Direct drawing of a wall of one colour is true: what frames lose is then over what is not seen,
// and rounding. By steps of k in three channels that is 10 log10( (3 k^2 + r) / (3 + r) ).
TEST_F(SampledLossTest, what_nobody_sees_is_the_least_that_direct_drawing_is_off_by) {
  use(squares(1, 9));
  const Camera camera = look_at({0, 0, 100}, {0, 0, 0}, {0, 1, 0}, 0.02, kWidth, kHeight, 1, 200);
  const Rgba8Image own = draw(camera, 1);
  for (const int steps : {0, 1, 2, 5}) {
    Rgba8Image off = own;
    for (glm::u8vec4& color : off.texels())
      for (int c = 0; c < 3; ++c)
        color[c] = std::uint8_t(color[c] > 128 ? color[c] - steps : color[c] + steps);
    SampledLoss loss(*rays_);
    const std::uint32_t objects[] = {0};
    for (int i = 0; i < 20; ++i) loss.add(camera, objects, warped_as(off).texels());
    ASSERT_TRUE(loss.known());
    const double k = steps, rounding = 0.25;
    EXPECT_NEAR(loss.loss_db(), 10 * std::log10((3 * k * k + rounding) / (3 + rounding)), 0.5)
        << steps;
  }
}

}  // namespace
}  // namespace rilievo
