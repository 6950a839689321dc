#include "rilievo/keyframes/software/sampled_loss.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>
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

class SampledLossTest : public ::testing::Test {
 protected:
  static constexpr int kWidth = 128, kHeight = 96;

  void SetUp() override {
    auto built = make_builtin("builtin:bridge?triangles=100000");
    ASSERT_TRUE(built.ok());
    scene_ = std::move(built->scene), path_ = built->path;
    Result<RayScene> rays = RayScene::create(scene_);
    ASSERT_TRUE(rays.ok());
    rays_.emplace(std::move(*rays));
    for (std::uint32_t i = 0; i < scene_.objects.size(); ++i) objects_.push_back(i);
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

  Scene scene_;
  CameraPath path_;
  std::optional<RayScene> rays_;
  std::vector<std::uint32_t> objects_;
};

TEST_F(SampledLossTest, direct_drawing_loses_nothing) {
  SampledLoss loss(*rays_);
  for (int i = 0; i < 20; ++i) {
    const Camera camera = camera_at(path_, frame_time(path_, 2 * i), kWidth, kHeight);
    loss.add(camera, objects_, warped_as(draw(camera, 1)));
  }
  ASSERT_TRUE(loss.known());
  // Rays and the rasteriser differ at samples on edges, and bytes are rounded once more.
  EXPECT_NEAR(loss.loss_db(), 0, 0.3);
}

TEST_F(SampledLossTest, holes_are_filled_and_lose_nothing) {
  SampledLoss loss(*rays_);
  for (int i = 0; i < 20; ++i)
    loss.add(camera_at(path_, frame_time(path_, 2 * i), kWidth, kHeight), objects_,
             Image<std::uint32_t>(kWidth, kHeight, 0u));
  ASSERT_TRUE(loss.known());
  EXPECT_EQ(loss.loss_db(), 0);
}

TEST_F(SampledLossTest, it_is_the_ratio_of_the_whole_frames_errors) {
  SampledLoss loss(*rays_);
  double direct = 0, shown = 0;
  for (int i = 0; i < 40; ++i) {
    const Camera camera = camera_at(path_, frame_time(path_, 2 * i), kWidth, kHeight);
    const Rgba8Image truth = halved(draw(camera, 2)), of_direct = draw(camera, 1);
    // Frames that are a pixel off.
    Rgba8Image off = of_direct;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 1; x < kWidth; ++x) off(x, y) = of_direct(x - 1, y);
    direct += mean_square(of_direct, truth), shown += mean_square(off, truth);
    loss.add(camera, objects_, warped_as(off));
  }
  ASSERT_TRUE(loss.known());
  // Some 3000 pixels, most of whose errors are at edges: a hundred or two of them count.
  EXPECT_NEAR(loss.loss_db(), 10 * std::log10(shown / direct), 1.5);
  loss.forget();
  EXPECT_FALSE(loss.known());
}

// Direct drawing of a wall of one colour is true: what frames lose is then over what is not seen,
// and rounding. By steps of k in three channels that is 10 log10( (3 k^2 + r) / (3 + r) ).
TEST_F(SampledLossTest, what_nobody_sees_is_the_least_that_direct_drawing_is_off_by) {
  Scene wall;
  wall.meshes.resize(1);
  wall.meshes[0].positions = {{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}};
  wall.meshes[0].normals.assign(4, {0, 0, 1});
  wall.meshes[0].indices = {0, 1, 2, 0, 2, 3};
  wall.models.resize(1);
  wall.models[0].parts = {{0, glm::mat4(1)}};
  wall.objects.resize(1);
  finish(wall);
  scene_ = std::move(wall);
  const Result<RayScene> rays = RayScene::create(scene_);
  ASSERT_TRUE(rays.ok());
  const Camera camera = look_at({0, 0, 100}, {0, 0, 0}, {0, 1, 0}, 0.02, kWidth, kHeight, 1, 200);
  const Rgba8Image own = draw(camera, 1);
  for (const int steps : {0, 1, 2, 5}) {
    Rgba8Image off = own;
    for (glm::u8vec4& color : off.texels())
      for (int c = 0; c < 3; ++c)
        color[c] = std::uint8_t(color[c] > 128 ? color[c] - steps : color[c] + steps);
    SampledLoss loss(*rays);
    const std::uint32_t objects[] = {0};
    for (int i = 0; i < 20; ++i) loss.add(camera, objects, warped_as(off));
    ASSERT_TRUE(loss.known());
    const double k = steps, rounding = 0.25;
    EXPECT_NEAR(loss.loss_db(), 10 * std::log10((3 * k * k + rounding) / (3 + rounding)), 0.5)
        << steps;
  }
}

}  // namespace
}  // namespace rilievo
