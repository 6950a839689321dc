// The composer against the formulas of nailboard/nailboard.h, pixel by pixel, in double precision.
#include "rilievo/nailboard/software/nailboard_composer.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <glm/gtc/matrix_transform.hpp>

#include "rilievo/core/sanitized_test_helpers.h"
#include "rilievo/nailboard/software/composer_test_helpers.h"
#include "rilievo/render/shading/simd_test_helpers.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo {
namespace {

constexpr int kFrameWidth = 150, kFrameHeight = 92;  // no whole number of tiles or blocks

// Of each row, every so many pixels are compared, from another one on in each row.
int pixel_step() { return 14 / sanitized_cases(14); }

// Pictures, as stored and as drawn.
struct Composition {
  Camera frame;
  std::vector<Nailboard> boards;
  std::vector<SoftwareNailboard> pictures;
  std::vector<SoftwareNailboardInstance> instances;
};

Composition random_composition(std::uint64_t seed, int count, int delta_bits, bool moving,
                               bool fading) {
  Random random(seed);
  Composition c;
  c.frame = random_frame(random, kFrameWidth, kFrameHeight);
  for (int i = 0; i < count; ++i)
    c.boards.push_back(random_picture(random, c.frame, delta_bits, 110));
  c.pictures.resize(c.boards.size());
  for (std::size_t i = 0; i < c.boards.size(); ++i) {
    c.pictures[i].assign(c.boards[i]);
    SoftwareNailboardInstance in{&c.pictures[i], c.boards[i].geometry, glm::dmat4(1),
                                 std::uint32_t(i + 1)};
    if (moving) {
      const glm::dvec3 at = in.geometry.capture.position();
      in.world_now_from_capture = glm::translate(
          glm::rotate(glm::translate(glm::dmat4(1), at), 0.1 * random.unit(), {0.6, 0.8, 0}), -at);
    }
    if (fading && i % 3 == 0) (i % 2 ? in.share_from : in.share_to) = random.unit();
    c.instances.push_back(in);
  }
  return c;
}

// What a picture shows at a pixel's centre, by definition.
struct Seen {
  bool any = false, unsure = false;            // unsure: rounding may decide otherwise
  bool covered[4] = {true, true, true, true};  // the samples on the polygon
  double window_z = 1;
  glm::dvec4 color{0};  // un-premultiplied, bytes; alpha in [0, 1]
  bool texel_empty = false;
  glm::ivec2 texel{0};
};

// A third of the texels show no object.
std::uint32_t object_of(const glm::ivec2& texel, std::size_t board) {
  return (texel.x + 5 * texel.y) % 3 == 0 ? kNoObject : std::uint32_t(board + 1);
}

Seen look(const Composition& c, std::size_t i, DepthMode mode, int samples, int px, int py) {
  const SoftwareNailboardInstance& in = c.instances[i];
  const Nailboard& board = c.boards[i];
  Camera frame = c.frame;
  frame.world_from_eye = glm::inverse(in.world_now_from_capture) * frame.world_from_eye;
  const Camera& capture = board.geometry.capture;
  const glm::dvec3 eye = frame.position();
  const auto on_picture = [&](double x, double y, double& t) {
    const glm::dvec3 direction = world_from_raster(frame, {x, y}, 1) - eye;
    t = (board.geometry.plane_z - glm::dot(capture.forward(), eye - capture.position())) /
        glm::dot(capture.forward(), direction);
    return glm::dvec2(raster_from_world(capture, eye + t * direction));
  };
  Seen seen;
  double t;
  const glm::dvec2 raster = on_picture(px + 0.5, py + 0.5, t);
  if (t <= frame.z_near || t >= frame.z_far) return seen;
  // Floats, through two divisions and affine terms of up to a few hundred texels.
  const auto edge = [](double v) { return std::abs(v - std::round(v)) < 1e-3; };
  const double w = capture.width, h = capture.height;
  const auto on_polygon = [&](const glm::dvec2& r) {
    if (r.x < -1e-3 || r.y < -1e-3 || r.x > w + 1e-3 || r.y > h + 1e-3) return false;
    seen.unsure = seen.unsure || std::min(r.x, r.y) < 1e-3 || std::min(w - r.x, h - r.y) < 1e-3;
    return r.x >= 0 && r.y >= 0 && r.x < w && r.y < h;
  };
  bool any = samples == 1 && on_polygon(raster);
  for (int s = 0; s < samples && samples > 1; ++s) {
    double unused;
    seen.covered[s] =
        on_polygon(on_picture(px + FrameTile::kSampleX[s], py + FrameTile::kSampleY[s], unused));
    any = any || seen.covered[s];
  }
  if (!any) return seen;
  seen.unsure = seen.unsure || edge(raster.x) || edge(raster.y);
  const glm::dvec2 at = glm::clamp(raster, glm::dvec2(0.5), glm::dvec2(w - 0.5, h - 0.5));
  const std::uint32_t code = board.delta(int(at.x), int(at.y));
  const int bits = board.geometry.delta_bits;
  if (code != delta_transparent(bits)) {
    seen.any = true;
    const double delta = decode_delta(code, bits);
    seen.window_z = mode == DepthMode::exact    ? exact_depth(board.geometry, frame, raster, delta)
                    : mode == DepthMode::linear ? linear_depth(board.geometry, frame, raster, delta)
                                                : flat_depth(board.geometry, frame, raster);
  }
  seen.texel = glm::ivec2(at);
  seen.texel_empty = board.color(seen.texel.x, seen.texel.y).a == 0;
  const glm::dvec2 from = glm::floor(at - 0.5), part = at - 0.5 - from;
  for (int k = 0; k < 4; ++k) {
    const int x = std::min(int(from.x) + k % 2, capture.width - 1),
              y = std::min(int(from.y) + k / 2, capture.height - 1);
    const double weight = (k % 2 ? part.x : 1 - part.x) * (k / 2 ? part.y : 1 - part.y);
    seen.color += weight * glm::dvec4(board.color(x, y));
  }
  if (seen.color.a > 0) seen.color *= glm::dvec4(glm::dvec3(255 / seen.color.a), 1 / 255.0);
  if (in.share_from > 0 || in.share_to < 1) {
    const auto fract = [](double v) { return v - std::floor(v); };
    const double hash =
        fract(52.9829189 * fract(0.06711056 * px + 0.00583715 * (kFrameHeight - 1 - py)));
    // The hash multiplies the rounding of a number near 10 by 53.
    seen.unsure = seen.unsure || std::abs(hash - in.share_from) < 2e-4 ||
                  std::abs(hash - in.share_to) < 2e-4 || hash < 2e-4 || hash > 1 - 2e-4;
    if (hash < in.share_from || hash >= in.share_to) seen.any = false;
  }
  return seen;
}

struct Sample {
  double window_z = 1;
  glm::dvec3 color{0};
  std::uint32_t object = kNoObject;
};

struct Twin {
  std::array<Sample, 4> samples;
  bool unsure = false;
  double least_alpha = 1;  // of what is shown
};

Twin slow_pixel(const Composition& c, DepthMode mode, int samples, int px, int py) {
  Twin twin;
  for (std::size_t i = 0; i < c.boards.size(); ++i) {
    const Seen seen = look(c, i, mode, samples, px, py);
    const double alpha = seen.color.a;
    const double thresholds[4] = {samples == 1 ? 0.5 : 0.125, 0.25, 0.5, 0.75};
    if (seen.unsure) twin.unsure = true;
    if (!seen.any) continue;
    for (int s = 0; s < samples; ++s) {
      Sample& sample = twin.samples[s];
      // 15 bits, twice rounded; depths near each other.
      if (std::abs(alpha - thresholds[s]) < 2e-4 ||
          std::abs(seen.window_z - sample.window_z) < 2e-6)
        twin.unsure = true;
      if (alpha < thresholds[s] || !seen.covered[s] || seen.window_z >= sample.window_z) continue;
      sample = {seen.window_z, glm::dvec3(seen.color), std::uint32_t(i + 1)};
      twin.least_alpha = std::min(twin.least_alpha, alpha);
    }
  }
  return twin;
}

void expect_same(const Composition& c, DepthMode mode, int samples, const SoftwareTarget& target) {
  int compared = 0, covered = 0;
  const int step = pixel_step();
  for (int y = 0; y < kFrameHeight; ++y)
    for (int x = y % step; x < kFrameWidth; x += step) {
      const Twin twin = slow_pixel(c, mode, samples, x, y);
      if (twin.unsure) continue;
      ++compared;
      glm::dvec3 mean(0);
      for (int s = 0; s < samples; ++s) mean += twin.samples[s].color / double(samples);
      const glm::u8vec4 drawn = target.color()(x, y);
      // Half a byte for the average, half for each sample's own rounding, and a few of 2^15 parts,
      // divided by alpha.
      const double tolerance = 1.05 + 0.05 / twin.least_alpha;
      for (int k = 0; k < 3; ++k)
        ASSERT_NEAR(drawn[k], mean[k], tolerance) << x << " " << y << " channel " << k;
      const Sample& first = twin.samples[0];
      const double inverse_z = target.inverse_z()(x, y);
      const double window_z = depth_from_eye_z(DepthKind::window_z, 1 / inverse_z, c.frame, {0, 0});
      // Floats: a few parts in 2^24 of 1 / eye_z, times z_near.
      ASSERT_NEAR(window_z, first.window_z, 2e-6) << x << " " << y;
      covered += first.object != kNoObject;
    }
  EXPECT_GT(compared * step, kFrameWidth * kFrameHeight * 9 / 10);
  EXPECT_GT(covered * step, kFrameWidth * kFrameHeight / 5);
}

TEST(NailboardComposer, draws_what_the_formulas_say) {
  int seed = 0;
  for (const int samples : {1, 4})
    for (const DepthMode mode : {DepthMode::exact, DepthMode::linear, DepthMode::flat})
      for (const int bits : {8, 16}) {
        SCOPED_TRACE(::testing::Message()
                     << samples << " samples, mode " << int(mode) << ", " << bits << " bits");
        ++seed;
        const Composition c = random_composition(seed, 24, bits, seed % 2, seed % 4 > 1);
        SoftwareTarget target(kFrameWidth, kFrameHeight, samples);
        NailboardComposer composer;
        composer.place(c.frame, mode, c.instances);
        const TileDrawer* drawers[] = {&composer};
        target.draw(c.frame.z_far, drawers);
        expect_same(c, mode, samples, target);
        if (HasFatalFailure()) return;
      }
}

TEST(NailboardComposer, identifies_the_object_that_a_pixel_shows) {
  for (int seed = 100; seed < 104; ++seed) {
    Composition c = random_composition(seed, 24, 8, false, false);
    // Half of them with identifiers of their texels.
    for (std::size_t i = 0; i < c.instances.size(); i += 2) {
      Image<std::uint32_t> objects(c.boards[i].color.width(), c.boards[i].color.height());
      for (int y = 0; y < objects.height(); ++y)
        for (int x = 0; x < objects.width(); ++x) objects(x, y) = object_of({x, y}, i);
      c.pictures[i].assign_objects(objects.texels(), false);
      c.instances[i].object = kNoObject;
    }
    SoftwareTarget target(kFrameWidth, kFrameHeight, 4);
    NailboardComposer composer;
    composer.place(c.frame, DepthMode::exact, c.instances);
    const TileDrawer* drawers[] = {&composer};
    target.draw_objects(c.frame.z_far, drawers);
    int compared = 0;
    const int step = pixel_step();
    for (int y = 0; y < kFrameHeight; ++y)
      for (int x = y % step; x < kFrameWidth; x += step) {
        std::uint32_t nearest = kNoObject;
        double window_z = 1;
        bool unsure = false;
        for (std::size_t i = 0; i < c.boards.size(); ++i) {
          const Seen seen = look(c, i, DepthMode::exact, 1, x, y);
          unsure = unsure || seen.unsure;
          if (!seen.any) continue;
          unsure = unsure || std::abs(seen.color.a - 0.5) < 2e-4 ||
                   std::abs(seen.window_z - window_z) < 2e-6;
          if (seen.texel_empty || seen.color.a < 0.5 || seen.window_z >= window_z) continue;
          if (i % 2 == 0 && object_of(seen.texel, i) == kNoObject) continue;
          window_z = seen.window_z, nearest = std::uint32_t(i + 1);
        }
        if (unsure) continue;
        ++compared;
        ASSERT_EQ(target.objects()(x, y), nearest) << x << " " << y;
      }
    EXPECT_GT(compared * step, kFrameWidth * kFrameHeight * 8 / 10);
  }
}

TEST(NailboardComposer, draws_the_same_bytes_with_any_instruction_set_and_number_of_threads) {
  const Composition c = random_composition(7, 60, 8, true, true);
  for (const int samples : {1, 4}) {
    std::vector<SoftwareTarget> drawn;
    const auto draw = [&] {
      SoftwareTarget& target = drawn.emplace_back(kFrameWidth, kFrameHeight, samples);
      NailboardComposer composer;
      composer.place(c.frame, DepthMode::exact, c.instances);
      const TileDrawer* drawers[] = {&composer};
      target.draw(c.frame.z_far, drawers);
    };
    for_each_instruction_set([&](const char*) { draw(); });
    {
      const tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
      draw();
    }
    draw();
    for (const SoftwareTarget& other : drawn) {
      EXPECT_EQ(other.color(), drawn[0].color());
      EXPECT_EQ(other.inverse_z(), drawn[0].inverse_z());
    }
  }
}

// Order decides which of two equal depths stays, and what is skipped; nothing else.
TEST(NailboardComposer, skips_nothing_that_is_seen) {
  for (int seed = 200; seed < 200 + sanitized_cases(6); ++seed) {
    Composition c = random_composition(seed, 80, 16, false, false);
    SoftwareTarget together(kFrameWidth, kFrameHeight, 1), back_first(kFrameWidth, kFrameHeight, 1);
    NailboardComposer all;
    all.place(c.frame, DepthMode::exact, c.instances);
    const TileDrawer* drawers[] = {&all};
    together.draw(c.frame.z_far, drawers);
    // One composer for each picture, the farthest first: nothing hides anything.
    std::sort(c.instances.begin(), c.instances.end(), [&](const auto& a, const auto& b) {
      const auto distance = [&](const PictureGeometry& g) {
        return glm::length(g.capture.position() + g.plane_z * g.capture.forward() -
                           c.frame.position());
      };
      return distance(a.geometry) > distance(b.geometry);
    });
    std::vector<NailboardComposer> single(c.instances.size());
    std::vector<const TileDrawer*> each;
    for (std::size_t i = 0; i < single.size(); ++i) {
      single[i].place(c.frame, DepthMode::exact, {&c.instances[i], 1});
      each.push_back(&single[i]);
    }
    back_first.draw(c.frame.z_far, each);
    EXPECT_EQ(together.inverse_z(), back_first.inverse_z());
    EXPECT_EQ(together.color(), back_first.color());
  }
}

TEST(NailboardComposer, draws_a_polygon_that_reaches_behind_the_eye) {
  Random random(3);
  Composition c;
  c.frame = look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.5, kFrameWidth, kFrameHeight, 0.5, 40);
  Nailboard board = random_picture(random, c.frame, 8, 60);
  // 143 degrees wide; the frame looks 60 degrees to the side: two corners are behind its eye.
  Camera& capture = board.geometry.capture;
  capture.window = {-3, 3, -1, 1};
  capture.z_near = 4, capture.z_far = 8;
  board.geometry = picture_geometry(capture);
  board.geometry.delta_bits = 8;
  for (glm::u8vec4& texel : board.color.texels()) texel = {90, 120, 200, 255};
  for (std::uint16_t& code : board.delta.texels()) code = std::uint16_t(random.below(255));
  const glm::dvec3 eye = capture.position() + glm::dvec3(0.1, -0.05, 0.15);
  const glm::dvec3 gaze = 0.5 * capture.forward() + 0.866 * glm::dvec3(capture.world_from_eye[0]);
  c.frame = look_at(eye, eye + gaze, {0, 1, 0}, 0.5, kFrameWidth, kFrameHeight, 0.5, 40);
  c.boards.push_back(board);
  c.pictures.resize(1);
  c.pictures[0].assign(board);
  c.instances.push_back({&c.pictures[0], board.geometry});
  for (const DepthMode mode : {DepthMode::exact, DepthMode::linear, DepthMode::flat}) {
    SoftwareTarget target(kFrameWidth, kFrameHeight, 1);
    NailboardComposer composer;
    composer.place(c.frame, mode, c.instances);
    const TileDrawer* drawers[] = {&composer};
    target.draw(c.frame.z_far, drawers);
    expect_same(c, mode, 1, target);
  }
}

// By identifiers: what a pixel shows is seen; and by each picture alone: others only hide.
TEST(NailboardComposer, knows_how_much_of_each_picture_is_seen) {
  int hidden = 0, seen_in_part = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const Composition c = random_composition(seed, 40, 8, false, false);
    SoftwareTarget target(kFrameWidth, kFrameHeight, 4);
    NailboardComposer composer;
    const TileDrawer* drawers[] = {&composer};
    std::vector<float> all, alone;
    composer.place(c.frame, DepthMode::exact, c.instances);
    target.draw(c.frame.z_far, drawers);
    composer.find_seen_shares(all);
    ASSERT_EQ(all.size(), c.instances.size());
    target.draw_objects(c.frame.z_far, drawers);
    std::vector<int> pixels(c.instances.size() + 1, 0);
    for (const std::uint32_t object : target.objects().texels()) ++pixels[object];
    for (std::size_t i = 0; i < c.instances.size(); ++i) {
      composer.place(c.frame, DepthMode::exact, {&c.instances[i], 1});
      target.draw(c.frame.z_far, drawers);
      composer.find_seen_shares(alone);
      EXPECT_LE(all[i], alone[0]);
      EXPECT_LE(alone[0], 1.0f);
      if (pixels[i + 1] > 0) {
        EXPECT_GT(all[i], 0.0f) << seed << " " << i;
      }
      hidden += all[i] == 0 && alone[0] > 0;
      seen_in_part += all[i] > 0 && all[i] < alone[0];
    }
  }
  EXPECT_GT(hidden, 5);
  EXPECT_GT(seen_in_part, 20);
}

}  // namespace
}  // namespace rilievo
