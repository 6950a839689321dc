// What is left out against a z-buffer that leaves nothing out.
#include "rilievo/nailboard/visible_cells.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "rilievo/core/image.h"
#include "rilievo/core/sanitized_test_helpers.h"

namespace rilievo {
namespace {

constexpr int kWidth = 307, kHeight = 181;  // cut through cells

struct Texel {
  double delta = -1;  // below 0: shows nothing
  bool opaque = false;
};

struct Picture {
  PlacedPolygon standing;
  Image<Texel> texels;  // row 0 at the bottom
  AtlasSlot slot;
};

// Patches of texels: opaque, ragged and empty ones.
Image<Texel> random_texels(std::mt19937& rng, int width, int height) {
  std::uniform_real_distribution<double> u(0, 1);
  Image<Texel> texels(width, height);
  constexpr int kPatch = 61;  // ends within blocks
  for (int y = 0; y < height; y += kPatch)
    for (int x = 0; x < width; x += kPatch) {
      const double kind = u(rng), base = u(rng);
      for (int j = y; j < std::min(y + kPatch, height); ++j)
        for (int i = x; i < std::min(x + kPatch, width); ++i) {
          if (kind < 0.25 || (kind < 0.45 && u(rng) < 0.5)) continue;
          texels(i, j) = {std::clamp(base + 0.2 * (u(rng) - 0.5), 0.0, 1.0),
                          kind > 0.55 || u(rng) < 0.5};
        }
    }
  return texels;
}

std::vector<OcclusionTile> blocks_of(const Image<Texel>& texels) {
  std::vector<OcclusionTile> blocks;
  for (int y = 0; y < texels.height(); y += kBlockTexels)
    for (int x = 0; x < texels.width(); x += kBlockTexels) {
      double nearest = 2, farthest = 0;
      unsigned covered = 0, opaque = 0;
      for (int j = y; j < y + kBlockTexels; ++j)
        for (int i = x; i < x + kBlockTexels; ++i) {
          if (i >= texels.width() || j >= texels.height() || texels(i, j).delta < 0) continue;
          const unsigned bit = 1u << (i - x + kBlockTexels * (j - y));
          covered |= bit, opaque |= texels(i, j).opaque ? bit : 0;
          nearest = std::min(nearest, texels(i, j).delta);
          farthest = std::max(farthest, texels(i, j).delta);
        }
      blocks.push_back({nearest > 1 ? std::uint8_t(255) : std::uint8_t(std::floor(254 * nearest)),
                        std::uint8_t(std::ceil(254 * farthest)), std::uint16_t(covered),
                        std::uint16_t(opaque)});
    }
  return blocks;
}

// A picture taken from near the frame's eye (the origin), which looks along -z.
Picture random_picture(std::mt19937& rng, AtlasAllocator& allocator) {
  std::uniform_real_distribution<double> u(-1, 1);
  Picture p;
  const int width = 20 + int(rng() % 300), height = 20 + int(rng() % 240);
  p.texels = random_texels(rng, width, height);
  p.slot = *allocator.allocate(width, height);
  PlacedPolygon& s = p.standing;
  s.eye = 0.3 * glm::dvec3(u(rng), u(rng), u(rng));
  s.z_near = 4 + 6 * (1 + u(rng));
  s.z_far = s.z_near * (1.05 + 0.4 * (1 + u(rng)));
  s.plane_z = 2 * s.z_near * s.z_far / (s.z_near + s.z_far);
  s.relief = rng() % 4 != 0;
  s.hides = rng() % 5 != 0;
  // Axes turned a little against the frame's; texels about as large as pixels.
  const glm::dvec3 forward = glm::normalize(glm::dvec3(0.1 * u(rng), 0.1 * u(rng), -1));
  const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0.1 * u(rng), 1, 0)));
  const glm::dvec3 up = glm::cross(right, forward);
  const double texel = s.plane_z * 0.0035 * (1 + 0.2 * u(rng));
  const glm::dvec3 middle =
      s.eye + s.plane_z * (forward + 0.45 * u(rng) * right + 0.3 * u(rng) * up);
  s.u_axis = texel * width * right, s.v_axis = texel * height * up;
  s.origin = middle - 0.5 * (s.u_axis + s.v_axis);
  return p;
}

// Random pictures and their blocks, which the pictures refer to.
struct Gallery {
  AtlasAllocator allocator{8};
  OcclusionTiles blocks{8};
  std::vector<Picture> pictures;

  Gallery(std::mt19937& rng, int count) {
    for (int i = 0; i < count; ++i) {
      pictures.push_back(random_picture(rng, allocator));
      blocks.assign(pictures.back().slot, blocks_of(pictures.back().texels));
      pictures.back().standing.blocks = blocks.view(pictures.back().slot);
    }
  }
  Gallery(const Gallery&) = delete;
  Gallery& operator=(const Gallery&) = delete;

  [[nodiscard]] std::vector<PlacedPolygon> standing() const {
    std::vector<PlacedPolygon> all;
    for (const Picture& p : pictures) all.push_back(p.standing);
    return all;
  }
};

// At the origin, looking along -z.
Camera frame_camera() {
  return look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.75, kWidth, kHeight, 0.5, 60);
}

struct Frame {
  Image<float> eye_z{kWidth, kHeight, INFINITY};
  Image<int> picture{kWidth, kHeight, -1};
};

// Are all the texels opaque whose colours the bilinear filter takes at (u, v)?
bool opaque_around(const Picture& p, double u, double v) {
  for (const double du : {-0.5, 0.5})
    for (const double dv : {-0.5, 0.5}) {
      const int x = std::clamp(int(std::floor(u + du)), 0, p.texels.width() - 1);
      const int y = std::clamp(int(std::floor(v + dv)), 0, p.texels.height() - 1);
      if (!p.texels(x, y).opaque) return false;
    }
  return true;
}

// Draws what `draw` admits of `p`, by intersecting every pixel's ray with the polygon.
template <class Draw>
void draw_into(Frame& frame, const Picture& p, int name, const glm::dmat4& clip_from_relative,
               Draw draw, bool filtered = false) {
  const PlacedPolygon& s = p.standing;
  const glm::dmat4 inverse = glm::inverse(clip_from_relative);
  const glm::dvec3 normal = glm::cross(s.u_axis, s.v_axis);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const glm::dvec4 h =
          inverse * glm::dvec4((2 * x + 1.0) / kWidth - 1, (2 * y + 1.0) / kHeight - 1, 0.5, 1);
      const glm::dvec3 ray = glm::dvec3(h) / h.w;
      const double t = glm::dot(normal, s.origin) / glm::dot(normal, ray);
      if (!(t > 0)) continue;
      const glm::dvec3 at = t * ray, from = at - s.origin;
      const double u = glm::dot(from, s.u_axis) / glm::dot(s.u_axis, s.u_axis) * p.slot.width;
      const double v = glm::dot(from, s.v_axis) / glm::dot(s.v_axis, s.v_axis) * p.slot.height;
      if (u < 0 || v < 0 || u >= p.slot.width || v >= p.slot.height) continue;
      Texel texel = p.texels(int(u), int(v));
      if (filtered) texel.opaque = opaque_around(p, u, v);
      if (texel.delta < 0 || !draw(texel, x, y)) continue;
      const double d = 1 / (1 / s.z_near + texel.delta * (1 / s.z_far - 1 / s.z_near));
      const glm::dvec3 surface = s.relief ? s.eye + (at - s.eye) * (d / s.plane_z) : at;
      if (float(-surface.z) < frame.eye_z(x, y)) {
        frame.eye_z(x, y) = float(-surface.z);
        frame.picture(x, y) = name;
      }
    }
}

// Points of the polygon go to the frame and come back as their texels.
void check_map(const glm::dmat3& texel_from_raster, const Picture& p,
               const glm::dmat4& clip_from_relative) {
  const PlacedPolygon& s = p.standing;
  for (const double u : {0.0, 0.3, 1.0})
    for (const double v : {0.0, 0.8, 1.0}) {
      const glm::dvec4 clip =
          clip_from_relative * glm::dvec4(s.origin + u * s.u_axis + v * s.v_axis, 1);
      const glm::dvec3 at =
          texel_from_raster * glm::dvec3(0.5 * kWidth * (clip.x / clip.w + 1),
                                         0.5 * kHeight * (clip.y / clip.w + 1), 1);
      EXPECT_GT(at.z, 0);
      // Rounding of doubles in an inverse of a well-conditioned matrix.
      EXPECT_NEAR(at.x / at.z, u * p.slot.width, 1e-8);
      EXPECT_NEAR(at.y / at.z, v * p.slot.height, 1e-8);
    }
}

TEST(VisibleCells, leave_out_nothing_that_shows) {
  std::mt19937 rng(1);
  const Camera camera = frame_camera();
  const glm::dmat4 clip = clip_from_eye(camera);
  double drawn_count = 0, on_polygon = 0, shown = 0, left_out = 0;
  for (int round = 0; round < sanitized_cases(60); ++round) {
    Gallery gallery(rng, 12);
    std::vector<Picture>& pictures = gallery.pictures;
    std::sort(pictures.begin(), pictures.end(), [](const Picture& a, const Picture& b) {
      return a.standing.plane_z < b.standing.plane_z;
    });
    // Two at about the same place, as where one fades into the other.
    pictures[8].standing = pictures[4].standing;
    pictures[8].standing.eye.x += 0.05;
    pictures[8].standing.z_near *= 0.98;
    pictures[8].standing.blocks = gallery.blocks.view(pictures[8].slot);
    std::vector<PlacedPolygon> standing = gallery.standing();
    // Some fade, alone or each into the other.
    for (const std::size_t i : {1u, 4u, 8u}) standing[i].share = true;
    for (const auto& [i, k] : {std::pair{4u, 8u}, std::pair{8u, 4u}}) standing[i].partner = k;
    VisibleCells visible;
    visible.find(clip, kWidth, kHeight, camera.z_near, camera.z_far, standing);
    std::vector<glm::dmat3> maps;
    std::vector<Image<std::uint8_t>> drawn_pixels(pictures.size(), {kWidth, kHeight, 0});
    for (std::size_t k = 0; k < visible.drawn().size(); ++k) {
      const DrawnCells& c = visible.drawn()[k];
      ASSERT_EQ(standing[c.picture].share, k >= visible.drawn_before_shares());
      ASSERT_FALSE(c.whole());
      for (int y = c.y0; y < c.y1; ++y)
        for (int x = c.x0; x < c.x1; ++x) drawn_pixels[c.picture](x, y) = 1;
    }
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      maps.push_back(visible.texel_from_raster(i));
      check_map(maps[i], pictures[i], clip);
    }
    // Of 4 and 8 complementary pixels; of 1 some.
    const auto has_pixel = [](std::size_t i, int x, int y) {
      const bool even = (x * 7 + y * 3) % 5 < 2;
      return i == 8 ? !even : i == 1 || i == 4 ? even : true;
    };

    // Texels that are not opaque may show or not: both ways; and what a filter mixes with them.
    for (const auto& [ragged, filtered] : {std::pair{true, false}, {false, false}, {false, true}}) {
      Frame all, some;
      for (std::size_t i = 0; i < pictures.size(); ++i) {
        const auto shows = [&, mixed = ragged](const Texel& texel) {
          return texel.opaque || (mixed && pictures[i].standing.hides);
        };
        const auto show = [&](const Texel& texel, int x, int y) {
          return shows(texel) && has_pixel(i, x, y);
        };
        const auto show_some = [&](const Texel& texel, int x, int y) {
          return show(texel, x, y) && drawn_pixels[i](x, y);
        };
        draw_into(all, pictures[i], int(i), clip, show, filtered);
        draw_into(some, pictures[i], int(i), clip, show_some, filtered);
      }
      ASSERT_EQ(all.picture, some.picture) << "round " << round;
      ASSERT_EQ(all.eye_z, some.eye_z) << "round " << round;
    }
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      Frame alone;
      draw_into(alone, pictures[i], int(i), clip, [](const Texel&, int, int) { return true; });
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
          const glm::dvec3 t = maps[i] * glm::dvec3(x + 0.5, y + 0.5, 1);
          on_polygon += 0 <= t.x && t.x < t.z * pictures[i].slot.width && 0 <= t.y &&
                        t.y < t.z * pictures[i].slot.height;
          drawn_count += drawn_pixels[i](x, y);
          shown += alone.picture(x, y) >= 0;
          left_out += alone.picture(x, y) >= 0 && !drawn_pixels[i](x, y);
        }
    }
  }
  // And something is left out: of what shows something, and more of what does not.
  EXPECT_GT(left_out, 0.1 * shown);
  EXPECT_LT(drawn_count, 0.9 * on_polygon);
  RecordProperty("left_out_share", std::to_string(left_out / shown));
  RecordProperty("drawn_share", std::to_string(drawn_count / on_polygon));
}

TEST(VisibleCells, are_the_same_on_one_thread_and_on_many) {
  std::mt19937 rng(4);
  const Gallery gallery(rng, 12);
  const std::vector<PlacedPolygon> standing = gallery.standing();
  const Camera camera = frame_camera();
  const auto find = [&] {
    VisibleCells visible;
    visible.find(clip_from_eye(camera), kWidth, kHeight, camera.z_near, camera.z_far, standing);
    return std::vector<DrawnCells>(visible.drawn().begin(), visible.drawn().end());
  };
  const std::vector<DrawnCells> many = find();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(find(), many);
  EXPECT_GT(many.size(), 12u);
}

TEST(VisibleCells, rectangles_end_at_the_tiles_that_show_something) {
  const Camera camera = frame_camera();
  // A texel a pixel, the first at pixel (16, 16).
  PlacedPolygon standing;
  const glm::dvec2 pixel(10 * (camera.window.right - camera.window.left) / kWidth,
                         10 * (camera.window.top - camera.window.bottom) / kHeight);
  constexpr int kSide = 40;
  standing.u_axis = {kSide * pixel.x, 0, 0}, standing.v_axis = {0, kSide * pixel.y, 0};
  standing.origin = {10 * camera.window.left + 16 * pixel.x,
                     10 * camera.window.bottom + 16 * pixel.y, -10};
  standing.z_near = 9, standing.z_far = 11, standing.plane_z = 10;
  Image<Texel> texels(kSide, kSide);
  for (int y = 5; y < 7; ++y)
    for (int x = 9; x < 15; ++x) texels(x, y) = {0.5, true};
  AtlasAllocator allocator(1);
  OcclusionTiles blocks(1);
  const AtlasSlot slot = *allocator.allocate(kSide, kSide);
  blocks.assign(slot, blocks_of(texels));
  standing.blocks = blocks.view(slot);
  VisibleCells visible;
  visible.find(clip_from_eye(camera), kWidth, kHeight, camera.z_near, camera.z_far, {&standing, 1});
  // Pixels 25 ... 30, 21 ... 22: two tiles side by side, the upper half of one cell.
  ASSERT_EQ(visible.drawn().size(), 1u);
  EXPECT_EQ(visible.drawn()[0], (DrawnCells{0, 24, 20, 32, 24}));
}

TEST(VisibleCells, a_polygon_that_reaches_behind_the_eye_is_drawn_whole) {
  std::mt19937 rng(2);
  const Gallery gallery(rng, 1);
  std::vector<PlacedPolygon> standing = gallery.standing();
  standing[0].u_axis = {1, 0, 40};
  standing[0].origin = {-0.5, -1, -20};
  const Camera camera = frame_camera();
  VisibleCells visible;
  visible.find(clip_from_eye(camera), kWidth, kHeight, camera.z_near, camera.z_far, standing);
  ASSERT_EQ(visible.drawn().size(), 1u);
  EXPECT_EQ(visible.drawn()[0].picture, 0u);
  EXPECT_TRUE(visible.drawn()[0].whole());
}

// What is cut off by the near plane hides nothing.
TEST(VisibleCells, a_polygon_that_reaches_before_the_near_plane_is_drawn_whole) {
  std::mt19937 rng(2);
  const Gallery gallery(rng, 1);
  std::vector<PlacedPolygon> standing = gallery.standing();
  const Camera camera = frame_camera();
  standing[0].origin = {-0.5, -1, -0.6 * camera.z_near};
  standing[0].u_axis = {1, 0, -20};
  standing[0].v_axis = {0, 2, 0};
  VisibleCells visible;
  visible.find(clip_from_eye(camera), kWidth, kHeight, camera.z_near, camera.z_far, standing);
  ASSERT_EQ(visible.drawn().size(), 1u);
  EXPECT_TRUE(visible.drawn()[0].whole());
}

TEST(OcclusionTiles, know_the_range_of_their_picture_and_nothing_of_its_neighbours) {
  std::mt19937 rng(3);
  const Gallery gallery(rng, 20);
  for (const Picture& p : gallery.pictures) {
    double nearest = 2, farthest = -1;
    for (const Texel& texel : p.texels.texels())
      if (texel.delta >= 0) {
        nearest = std::min(nearest, texel.delta);
        farthest = std::max(farthest, texel.delta);
      }
    const auto range = delta_range(p.standing.blocks);
    ASSERT_EQ(range.has_value(), farthest >= 0);
    if (!range) continue;
    // Rounded outwards, by less than a step.
    EXPECT_LE(range->nearest, nearest);
    EXPECT_GT(range->nearest, nearest - 1.0 / 254);
    EXPECT_GE(range->farthest, farthest);
    EXPECT_LT(range->farthest, farthest + 1.0 / 254);
  }
}

}  // namespace
}  // namespace rilievo
