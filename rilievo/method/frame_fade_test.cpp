#include "rilievo/method/frame_fade.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <span>
#include <vector>

#include "rilievo/core/box_view.h"
#include "rilievo/frame/software/software_backend.h"
#include "rilievo/method/method.h"
#include "rilievo/method/moved_objects.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

class FrameFadeTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto built = make_builtin("builtin:teapots?triangles=20000");
    ASSERT_TRUE(built.ok());
    scene_ = std::move(built->scene);
    path_ = built->path;
    for (int i = 0; i < 2; ++i) {
      backends_.push_back(std::make_unique<SoftwareBackend>(scene_, 4));
      Result<Method> made = make_method("direct-raster", {}, *backends_.back());
      ASSERT_TRUE(made.ok());
      frames_.push_back(std::move(made->frames));
    }
  }
  [[nodiscard]] Camera camera(int frame) const {
    Camera eye = camera_at(path_, frame_time(path_, frame), width_, 128);
    eye.world_from_eye = glm::rotate(eye.world_from_eye, frame == 0 ? 0 : roll_, {0, 0, 1});
    return eye;
  }
  const SoftwareTarget& draw(int of, int frame) {
    EXPECT_TRUE(frames_[std::size_t(of)]->draw(camera(frame), 0).ok());
    return *frames_[std::size_t(of)]->software_target();
  }
  static double mean_difference(const Rgba8Image& a, const Rgba8Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.texels().size(); ++i)
      for (int k = 0; k < 3; ++k)
        sum += std::abs(double(a.texels()[i][k]) - double(b.texels()[i][k]));
    return sum / (3 * double(a.texels().size()));
  }
  // A frame of that colour, at the depths of another one.
  static SoftwareTarget showing(const Rgba8Image& color, const SoftwareTarget& depths) {
    struct Shown final : TileDrawer {
      const Rgba8Image* color = nullptr;
      const SoftwareTarget* depths = nullptr;
      void draw_tile(FrameTile& tile) const override {
        for (int y = tile.y; y < std::min(tile.y + FrameTile::kSize, tile.height); ++y)
          for (int x = tile.x; x < std::min(tile.x + FrameTile::kSize, tile.width); ++x) {
            const TilePixel at(tile, x, y);
            const glm::u8vec4 c = (*color)(x, y);
            tile.first[at.block].content[at.pixel] = std::uint32_t(c.r) | std::uint32_t(c.g) << 8 |
                                                     std::uint32_t(c.b) << 16 | 255u << 24;
            tile.first[at.block].inverse_z[at.pixel] = depths->inverse_z()(x, y);
          }
      }
    } shown;
    shown.color = &color, shown.depths = &depths;
    SoftwareTarget target(color.width(), color.height(), 1);
    const TileDrawer* drawer = &shown;
    target.draw(1000, {&drawer, 1});
    return target;
  }
  // The same picture, darker: what another method might show.
  static SoftwareTarget darker(const SoftwareTarget& of) {
    Rgba8Image half = of.color();
    for (glm::u8vec4& c : half.texels()) c = {c.r / 2, c.g / 2, c.b / 2, c.a};
    return showing(half, of);
  }

  int width_ = 192;
  double roll_ = 0;  // of the eye after the first frame
  Scene scene_;
  CameraPath path_;
  std::vector<std::unique_ptr<SoftwareBackend>> backends_;
  std::vector<std::unique_ptr<FrameSource>> frames_;
};

TEST_F(FrameFadeTest, of_an_eye_that_stands_each_frame_is_a_step_nearer) {
  const SoftwareTarget& now = draw(0, 0);
  const SoftwareTarget old = darker(now);
  FrameFade fade;
  EXPECT_FALSE(fade.goes_on());
  fade.begin(old, camera(0));
  const double all = mean_difference(old.color(), now.color());
  ASSERT_GT(all, 20);
  for (int i = 0; i < FrameFade::kFrames; ++i) {
    ASSERT_TRUE(fade.goes_on());
    fade.mix(now, camera(0));
    const double left = all * (FrameFade::kFrames - i) / (FrameFade::kFrames + 1);
    // At edges of colour the old frame shows what is nearer to the new one beside the place.
    EXPECT_NEAR(mean_difference(fade.target().color(), now.color()), left, 0.05 * all) << i;
    EXPECT_TRUE(fade.target().inverse_z() == now.inverse_z());
  }
  EXPECT_FALSE(fade.goes_on());
}

TEST_F(FrameFadeTest, of_few_frames_each_is_a_larger_step) {
  const SoftwareTarget& now = draw(0, 0);
  const SoftwareTarget old = darker(now);
  FrameFade fade;
  fade.begin(old, camera(0), 2);
  const double all = mean_difference(old.color(), now.color());
  for (const double left : {2.0 / 3, 1.0 / 3}) {
    ASSERT_TRUE(fade.goes_on());
    fade.mix(now, camera(0));
    EXPECT_NEAR(mean_difference(fade.target().color(), now.color()), left * all, 0.03 * all);
  }
  EXPECT_FALSE(fade.goes_on());
}

// To what fades out: by steps that are no larger than those of the fade.
TEST_F(FrameFadeTest, back_again_takes_the_frames_that_were_mixed) {
  const SoftwareTarget& now = draw(0, 0);
  const SoftwareTarget old = darker(now);
  const double all = mean_difference(old.color(), now.color());
  FrameFade fade;
  fade.begin(old, camera(0));
  EXPECT_EQ(fade.mixed(), 0);
  for (int i = 1; i <= 3; ++i) {
    fade.mix(now, camera(0));
    EXPECT_EQ(fade.mixed(), i);
  }
  fade.begin(fade.target(), camera(0), fade.mixed());
  for (const double left : {3.0 / 4, 2.0 / 4, 1.0 / 4}) {
    fade.mix(old, camera(0));
    const double shown = all * left * 3 / (FrameFade::kFrames + 1);
    EXPECT_NEAR(mean_difference(fade.target().color(), old.color()), shown, 0.03 * all);
  }
  EXPECT_FALSE(fade.goes_on());
}

class RolledFadeTest : public FrameFadeTest, public ::testing::WithParamInterface<double> {};

// Of an eye that rolls a row's pixels lie in several rows of the old frame.
INSTANTIATE_TEST_SUITE_P(Rolled, RolledFadeTest, ::testing::Values(0.0, 0.35, -2.0));

// The slow twin: each pixel through the world, in double precision.
TEST_P(RolledFadeTest, what_the_old_frame_shows_is_found_by_the_new_ones_depth) {
  roll_ = GetParam();
  width_ = 189;  // no multiple of what is mixed at once
  const SoftwareTarget old = darker(draw(1, 0));
  const SoftwareTarget& now = draw(0, 3);
  const Camera from = camera(0), to = camera(3);
  ASSERT_GT(mean_difference(draw(1, 0).color(), now.color()), 1.0);
  FrameFade fade;
  fade.begin(old, from);
  fade.mix(now, to);
  const double of_old = double(FrameFade::kFrames) / (FrameFade::kFrames + 1);
  int mixed = 0, seen = 0;
  for (int y = 0; y < to.height; ++y)
    for (int x = 0; x < to.width; ++x) {
      const double eye_z = 1 / double(now.inverse_z()(x, y));
      const glm::dvec3 at =
          raster_from_world(from, world_from_raster(to, {x + 0.5, y + 0.5}, eye_z));
      const double passed = glm::distance(from.position(), to.position()) / eye_z;
      const double weight = of_old * std::clamp((double(kOtherShading) - passed) /
                                                    double(kOtherShading - kSameShading),
                                                0.0, 1.0);
      const glm::u8vec4 shown = fade.target().color()(x, y), fresh = now.color()(x, y);
      // The four texels around it, where single precision cannot take others.
      const double left = std::floor(at.x - 0.5), top = std::floor(at.y - 0.5);
      const double right_by = at.x - 0.5 - left, down_by = at.y - 0.5 - top;
      const auto sure = [](double by) { return std::abs(by - std::round(2 * by) / 2) > 0.01; };
      if (left < 0 || top < 0 || left + 1 >= from.width || top + 1 >= from.height) continue;
      if (!sure(right_by) || !sure(down_by)) continue;
      const int px = int(left), py = int(top);
      const double nearest =
          1 / double(old.inverse_z()(px + (right_by > 0.5), py + (down_by > 0.5)));
      // And where it is sure whether the surface is the same.
      const double apart = std::abs(at.z / nearest - 1);
      if (std::abs(apart - 0.15) < 0.01) continue;
      ++seen;
      if (apart > 0.15) {
        EXPECT_EQ(shown, fresh) << x << " " << y;
        continue;
      }
      ++mixed;
      for (int k = 0; k < 3; ++k) {
        int least = 255, most = 0;
        for (int v = py; v <= py + 1; ++v)
          for (int u = px; u <= px + 1; ++u) {
            least = std::min(least, int(old.color()(u, v)[k]));
            most = std::max(most, int(old.color()(u, v)[k]));
          }
        const double shows = std::clamp(int(fresh[k]), least, most);
        EXPECT_NEAR(shown[k], (1 - weight) * fresh[k] + weight * shows, 1.5) << x << " " << y;
      }
    }
  EXPECT_GT(seen, roll_ == 0 ? 15000 : 8000);
  EXPECT_GT(mixed, seen / 2);
}

// To interpolate between the old frame's texels would blur what they show.
TEST_F(FrameFadeTest, of_the_same_method_nearly_nothing_is_mixed) {
  const SoftwareTarget &old = draw(1, 0), &now = draw(0, 3);
  const double all = mean_difference(old.color(), now.color());
  ASSERT_GT(all, 1.0);
  FrameFade fade;
  fade.begin(old, camera(0));
  fade.mix(now, camera(3));
  EXPECT_LT(mean_difference(fade.target().color(), now.color()), 0.1 * all);
}

TEST_F(FrameFadeTest, ends_where_what_is_left_is_not_seen) {
  width_ = 189;
  FrameFade fade;
  fade.begin(draw(1, 0), camera(0));
  fade.mix(draw(0, 0), camera(0));
  EXPECT_FALSE(fade.goes_on());
  // In one tile alone: by fewer levels in each frame, until the mean of the tile is below kUnseen.
  const SoftwareTarget& now = draw(0, 0);
  const SoftwareTarget old = darker(now);
  const int size = FrameTile::kSize;
  for (const bool in_a_tile : {true, false}) {
    Rgba8Image color = now.color();
    const int from = in_a_tile ? size : size / 2;
    for (int y = 0; y < size; ++y)
      for (int x = from; x < from + size; ++x) color(x, y) = old.color()(x, y);
    fade.begin(showing(color, now), camera(0));
    int frames = 0;
    std::vector<double> sums(3);
    for (; fade.goes_on(); ++frames) {
      fade.mix(now, camera(0));
      std::fill(sums.begin(), sums.end(), 0);
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < 2 * size; ++x)
          for (int k = 0; k < 3; ++k)
            sums[std::size_t(x / size)] +=
                std::abs(int(fade.target().color()(x, y)[k]) - int(now.color()(x, y)[k]));
      const double most = *std::max_element(sums.begin(), sums.end()) / (3 * size * size);
      EXPECT_EQ(fade.goes_on(), most >= FrameFade::kUnseen && frames + 1 < FrameFade::kFrames)
          << most;
    }
    EXPECT_GT(frames, 1);
  }
}

// What it shows may shine otherwise.
TEST_F(FrameFadeTest, of_what_the_eye_passes_close_by_the_old_frame_does_not_count) {
  const SoftwareTarget& now = draw(0, 0);
  const SoftwareTarget old = darker(now);
  const double all = mean_difference(old.color(), now.color());
  FrameFade fade;
  double last = all;
  for (const double way : {0.0, 0.5, 1000.0}) {
    Camera from = camera(0);
    from.world_from_eye[3] += way * from.world_from_eye[2];  // it came from behind
    fade.begin(old, from);
    fade.mix(now, camera(0));
    const double mixed = mean_difference(fade.target().color(), now.color());
    EXPECT_LT(mixed, last) << way;
    last = mixed;
  }
  EXPECT_EQ(last, 0);
}

TEST_F(FrameFadeTest, objects_are_those_of_the_new_frame) {
  const SoftwareTarget old = darker(draw(1, 0));
  draw(0, 1);
  FrameFade fade;
  fade.begin(old, camera(0));
  fade.mix(*frames_[0]->software_target(), camera(1));
  ASSERT_TRUE(frames_[0]->draw_objects().ok());
  fade.draw_objects();
  EXPECT_TRUE(fade.target().objects() == frames_[0]->software_target()->objects());
}

// Each pixel is the new frame's where it shows what lies in the box, and else as if nothing had
// moved.
TEST_F(FrameFadeTest, what_has_moved_is_new_at_once) {
  const SoftwareTarget& now = draw(0, 0);
  const SoftwareTarget old = darker(now);
  PlacedScene placed(scene_);
  placed.set_time(0);
  const Box box = placed.bounds()[scene_.objects.size() / 2];
  const Camera eye = camera(0);
  const BoxView view = view_of_box(eye_from_world(eye), box, Projection::perspective);
  const RasterRect rect = rect_of_box(eye, view);
  FrameFade fade;
  fade.begin(old, eye);
  fade.mix(now, eye);
  const Rgba8Image all = fade.target().color();
  fade.begin(old, eye);
  fade.mix(now, eye, {&box, 1});
  const auto lies_in = [&](int x, int y, double share) {
    if (x < 0 || y < 0 || x >= now.width() || y >= now.height()) return false;
    const double z = 1 / double(now.inverse_z()(x, y));
    return z > view.nearest / share && z < view.farthest * share;
  };
  int as_new = 0, as_mixed = 0;
  for (int y = 0; y < now.height(); ++y)
    for (int x = 0; x < now.width(); ++x) {
      // The rectangle is a pixel wider; at its rim either may be.
      const bool within = x + 0.5 > rect.left && x + 0.5 < rect.right && y + 0.5 > rect.top &&
                          y + 0.5 < rect.bottom;
      bool beside = false;
      for (int v = y - 1; v <= y + 1; ++v)
        for (int u = x - 1; u <= x + 1; ++u)
          beside = beside || (lies_in(u, v, 1.001) && u > rect.left - 2 && u < rect.right + 2 &&
                              v > rect.top - 2 && v < rect.bottom + 2);
      const bool is_new = within && lies_in(x, y, 0.999);
      const glm::u8vec4 shown = fade.target().color()(x, y);
      if (is_new) {
        ASSERT_EQ(shown, now.color()(x, y)) << x << ' ' << y;
      } else if (!beside) {
        ASSERT_EQ(shown, all(x, y)) << x << ' ' << y;
      }
      as_new += is_new && now.color()(x, y) != all(x, y);
      as_mixed += !beside && now.color()(x, y) != all(x, y);
    }
  EXPECT_GT(as_new, 100);
  EXPECT_GT(as_mixed, 1000);
  // In a tile in which more has moved than is told apart nothing is mixed.
  const std::vector<Box> many(70, box);
  fade.begin(old, eye);
  fade.mix(now, eye, many);
  int in_tile = 0, elsewhere = 0;
  const auto touches = [&](int from, double least, double most) {
    return from < most && from + FrameTile::kSize > least;
  };
  for (int y = 0; y < now.height(); ++y)
    for (int x = 0; x < now.width(); ++x) {
      const int left = x / FrameTile::kSize * FrameTile::kSize,
                top = y / FrameTile::kSize * FrameTile::kSize;
      const bool inside =
                     touches(left, rect.left, rect.right) && touches(top, rect.top, rect.bottom),
                 beside = touches(left, rect.left - 2, rect.right + 2) &&
                          touches(top, rect.top - 2, rect.bottom + 2);
      const glm::u8vec4 shown = fade.target().color()(x, y);
      if (inside) {
        ASSERT_EQ(shown, now.color()(x, y));
      } else if (!beside) {
        ASSERT_EQ(shown, all(x, y));
      }
      const bool outside = x < rect.left - 2 || x > rect.right + 2;
      in_tile += inside && outside && now.color()(x, y) != all(x, y);
      elsewhere += !beside && now.color()(x, y) != all(x, y);
    }
  EXPECT_GT(in_tile, 100);
  EXPECT_GT(elsewhere, 100);
  // What is behind the eye is not seen, and what reaches from there to beside it.
  const glm::vec3 behind(eye.position() - 10.0 * eye.forward());
  const glm::vec3 right(100.0 * glm::dvec3(eye.world_from_eye[0])), forward(eye.forward());
  Box beside_eye{behind + right, behind + right};
  beside_eye.add(behind + right + 20.0f * forward);
  for (const Box& unseen : {Box{behind - 1.0f, behind + 1.0f}, beside_eye}) {
    fade.begin(old, eye);
    fade.mix(now, eye, {&unseen, 1});
    EXPECT_TRUE(fade.target().color() == all);
  }
}

// Cars on a bridge were seen twice while a frame of 0.3 s before faded out.
TEST_F(FrameFadeTest, of_what_moves_nothing_is_seen_twice) {
  const auto built = make_builtin("builtin:bridge?triangles=200000");
  ASSERT_TRUE(built.ok());
  SoftwareBackend backend(built->scene, 4);
  Result<Method> made = make_method("direct-raster", {}, backend);
  ASSERT_TRUE(made.ok());
  FrameFade fade;
  // Of the eye, in metres.
  for (const double way : {0.0, 0.3}) {
    const Camera eye = camera_at(built->path, frame_time(built->path, 0), 320, 180);
    Camera before = eye;
    before.world_from_eye[3] -= way * eye.world_from_eye[0];
    MovedObjects moved(built->scene);
    ASSERT_TRUE(made->frames->draw(before, 0).ok());
    const SoftwareTarget old =
        showing(made->frames->software_target()->color(), *made->frames->software_target());
    moved.begin_fade(0, false);
    EXPECT_TRUE(moved.since(0).empty());
    ASSERT_TRUE(made->frames->draw(eye, 0.3).ok());
    const SoftwareTarget& now = *made->frames->software_target();
    const std::span<const Box> boxes = moved.since(0.3);
    EXPECT_GT(boxes.size(), 3u);
    const auto mixed = [&](const SoftwareTarget& from, std::span<const Box> told) {
      fade.begin(from, before);
      fade.mix(now, eye, told);
      return mean_difference(fade.target().color(), now.color());
    };
    // All that differs is what has moved, but for a few pixels at the corners of silhouettes; and,
    // of an eye that moves, some at edges.
    const double twice = mixed(old, {}), once = mixed(old, boxes);
    EXPECT_GT(twice, 0.1) << way;
    EXPECT_LE(once, (way > 0 ? 0.2 : 0.002) * twice) << way;
    // Another method's frame does fade out, but for a small part.
    const SoftwareTarget other = darker(old);
    EXPECT_GT(mixed(other, boxes), 0.7 * mixed(other, {})) << way;
  }
}

TEST(MovedObjects, boxes_hold_where_things_were_and_where_they_are) {
  const auto built = make_builtin("builtin:bridge?triangles=200000");
  ASSERT_TRUE(built.ok());
  MovedObjects moved(built->scene);
  moved.begin_fade(0, false);
  moved.begin_fade(0.2, true);  // within that fade
  const std::span<const Box> boxes = moved.since(0.3);
  std::vector<Box> wanted(built->scene.objects.size());
  PlacedScene placed(built->scene);
  for (const double time : {0.0, 0.2, 0.3}) {
    placed.set_time(time);
    for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i].add(placed.bounds()[i]);
  }
  std::size_t at = 0;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (!built->scene.objects[i].moving) continue;
    ASSERT_LT(at, boxes.size());
    EXPECT_EQ(boxes[at].min, wanted[i].min);
    EXPECT_EQ(boxes[at].max, wanted[i].max);
    ++at;
  }
  EXPECT_EQ(at, boxes.size());
  EXPECT_GT(at, 3u);
}

}  // namespace
}  // namespace rilievo
