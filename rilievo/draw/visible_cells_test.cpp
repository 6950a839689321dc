// What is left out against a z-buffer that leaves nothing out.
#include "rilievo/draw/visible_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "rilievo/core/image.h"

namespace rilievo {
namespace {

constexpr int kWidth = 160, kHeight = 96;

struct Texel {
  double delta = -1;  // below 0: shows nothing
  bool opaque = false;
};

struct Picture {
  StandingPicture standing;
  Image<Texel> texels;  // row 0 at the bottom
  AtlasSlot slot;
};

// Patches of texels: opaque, ragged and empty ones.
Image<Texel> random_texels(std::mt19937& rng, int width, int height) {
  std::uniform_real_distribution<double> u(0, 1);
  Image<Texel> texels(width, height);
  for (int y = 0; y < height; y += 32)
    for (int x = 0; x < width; x += 32) {
      const double kind = u(rng), base = u(rng);
      for (int j = y; j < std::min(y + 32, height); ++j)
        for (int i = x; i < std::min(x + 32, width); ++i) {
          if (kind < 0.25 || (kind < 0.45 && u(rng) < 0.5)) continue;
          texels(i, j) = {std::clamp(base + 0.2 * (u(rng) - 0.5), 0.0, 1.0),
                          kind > 0.55 || u(rng) < 0.5};
        }
    }
  return texels;
}

std::vector<PictureBlock> blocks_of(const Image<Texel>& texels) {
  std::vector<PictureBlock> blocks;
  for (int y = 0; y < texels.height(); y += kBlockTexels)
    for (int x = 0; x < texels.width(); x += kBlockTexels) {
      double nearest = 2, farthest = 0;
      bool opaque = true;
      for (int j = y; j < y + kBlockTexels; ++j)
        for (int i = x; i < x + kBlockTexels; ++i) {
          if (i >= texels.width() || j >= texels.height() || texels(i, j).delta < 0) {
            opaque = false;
            continue;
          }
          opaque &= texels(i, j).opaque;
          nearest = std::min(nearest, texels(i, j).delta);
          farthest = std::max(farthest, texels(i, j).delta);
        }
      blocks.push_back({nearest > 1 ? std::uint8_t(255) : std::uint8_t(std::floor(254 * nearest)),
                        std::uint8_t(2 * std::ceil(127 * farthest) + (opaque ? 1 : 0))});
    }
  return blocks;
}

// A picture taken from near the frame's eye (the origin), which looks along -z.
Picture random_picture(std::mt19937& rng, AtlasAllocator& allocator) {
  std::uniform_real_distribution<double> u(-1, 1);
  Picture p;
  const int width = 20 + int(rng() % 150), height = 20 + int(rng() % 120);
  p.texels = random_texels(rng, width, height);
  p.slot = *allocator.allocate(width, height);
  StandingPicture& s = p.standing;
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
  const double texel = s.plane_z * 0.007 * (1 + 0.2 * u(rng));
  const glm::dvec3 middle =
      s.eye + s.plane_z * (forward + 0.45 * u(rng) * right + 0.3 * u(rng) * up);
  s.u_axis = texel * width * right, s.v_axis = texel * height * up;
  s.origin = middle - 0.5 * (s.u_axis + s.v_axis);
  return p;
}

struct Frame {
  Image<float> eye_z{kWidth, kHeight, INFINITY};
  Image<int> picture{kWidth, kHeight, -1};
};

// Draws the texels of `p` that `draw` admits, by intersecting every pixel's ray with the polygon.
template <class Draw>
void draw_into(Frame& frame, const Picture& p, int name, const glm::dmat4& clip_from_relative,
               Draw draw) {
  const StandingPicture& s = p.standing;
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
      const Texel& texel = p.texels(int(u), int(v));
      if (texel.delta < 0 || !draw(texel, u, v)) continue;
      const double d = 1 / (1 / s.z_near + texel.delta * (1 / s.z_far - 1 / s.z_near));
      const glm::dvec3 surface = s.relief ? s.eye + (at - s.eye) * (d / s.plane_z) : at;
      if (float(-surface.z) < frame.eye_z(x, y)) {
        frame.eye_z(x, y) = float(-surface.z);
        frame.picture(x, y) = name;
      }
    }
}

TEST(VisibleCells, leave_out_nothing_that_shows) {
  std::mt19937 rng(1);
  const Camera camera = look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.75, kWidth, kHeight, 0.5, 60);
  const glm::dmat4 clip = clip_from_eye(camera);
  double whole = 0, drawn_texels = 0, hidden_cells = 0, cells_with_texels = 0;
  for (int round = 0; round < 60; ++round) {
    AtlasAllocator allocator(8);
    PictureBlocks blocks(8);
    std::vector<Picture> pictures;
    for (int i = 0; i < 12; ++i) {
      pictures.push_back(random_picture(rng, allocator));
      blocks.assign(pictures.back().slot, blocks_of(pictures.back().texels));
    }
    std::sort(pictures.begin(), pictures.end(), [](const Picture& a, const Picture& b) {
      return a.standing.plane_z < b.standing.plane_z;
    });
    VisibleCells visible;
    visible.begin(clip, kWidth, kHeight, camera.z_near, camera.z_far);
    std::vector<DrawnCells> drawn;
    for (std::size_t i = 0; i < pictures.size(); ++i)
      visible.append(std::uint32_t(i), pictures[i].standing, blocks.view(pictures[i].slot), drawn);

    // Texels that are not opaque may show or not: both ways.
    for (const bool ragged : {true, false}) {
      Frame all, some;
      for (std::size_t i = 0; i < pictures.size(); ++i) {
        const auto shows = [&](const Texel& texel) {
          return texel.opaque || (ragged && pictures[i].standing.hides);
        };
        draw_into(all, pictures[i], int(i), clip,
                  [&](const Texel& texel, double, double) { return shows(texel); });
        draw_into(some, pictures[i], int(i), clip, [&](const Texel& texel, double u, double v) {
          if (!shows(texel)) return false;
          return std::any_of(drawn.begin(), drawn.end(), [&](const DrawnCells& c) {
            return c.picture == i && c.x0 <= u && u < c.x1 && c.y0 <= v && v < c.y1;
          });
        });
      }
      ASSERT_EQ(all.picture, some.picture) << "round " << round;
      ASSERT_EQ(all.eye_z, some.eye_z) << "round " << round;
    }
    for (const DrawnCells& c : drawn) drawn_texels += double(c.x1 - c.x0) * double(c.y1 - c.y0);
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      const Picture& p = pictures[i];
      whole += double(p.slot.width) * p.slot.height;
      for (int y = 0; y < cells_across(p.slot.height); ++y)
        for (int x = 0; x < cells_across(p.slot.width); ++x) {
          if (blocks.view(p.slot).cell(x, y) == 255) continue;
          ++cells_with_texels;
          hidden_cells += std::none_of(drawn.begin(), drawn.end(), [&](const DrawnCells& c) {
            return c.picture == i && c.x0 <= 16 * x + 8 && 16 * x + 8 < c.x1 &&
                   c.y0 <= 16 * y + 8 && 16 * y + 8 < c.y1;
          });
        }
    }
  }
  // And something is left out: much of what lies outside the frame, is empty, or is hidden.
  EXPECT_LT(drawn_texels, 0.8 * whole);
  EXPECT_GT(hidden_cells, 0.1 * cells_with_texels);
  RecordProperty("drawn_share", std::to_string(drawn_texels / whole));
}

TEST(VisibleCells, a_polygon_that_reaches_behind_the_eye_is_drawn_whole) {
  std::mt19937 rng(2);
  AtlasAllocator allocator(1);
  PictureBlocks blocks(1);
  Picture p = random_picture(rng, allocator);
  blocks.assign(p.slot, blocks_of(p.texels));
  p.standing.u_axis = {1, 0, 40};
  p.standing.origin = {-0.5, -1, -20};
  const Camera camera = look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.75, kWidth, kHeight, 0.5, 60);
  VisibleCells visible;
  visible.begin(clip_from_eye(camera), kWidth, kHeight, camera.z_near, camera.z_far);
  std::vector<DrawnCells> drawn;
  visible.append(3, p.standing, blocks.view(p.slot), drawn);
  ASSERT_EQ(drawn.size(), 1u);
  EXPECT_EQ(drawn[0],
            (DrawnCells{3, 0, 0, std::uint16_t(p.slot.width), std::uint16_t(p.slot.height)}));
}

TEST(PictureBlocks, know_the_range_of_their_picture_and_nothing_of_its_neighbours) {
  std::mt19937 rng(3);
  AtlasAllocator allocator(2);
  PictureBlocks blocks(2);
  std::vector<Picture> pictures;
  for (int i = 0; i < 20; ++i) {
    pictures.push_back(random_picture(rng, allocator));
    blocks.assign(pictures.back().slot, blocks_of(pictures.back().texels));
  }
  for (const Picture& p : pictures) {
    double nearest = 2, farthest = -1;
    for (const Texel& texel : p.texels.texels())
      if (texel.delta >= 0) {
        nearest = std::min(nearest, texel.delta);
        farthest = std::max(farthest, texel.delta);
      }
    const auto range = delta_range(blocks.view(p.slot));
    ASSERT_EQ(range.has_value(), farthest >= 0);
    if (!range) continue;
    // Rounded outwards, by less than a step.
    EXPECT_LE(range->nearest, nearest);
    EXPECT_GT(range->nearest, nearest - 1.0 / 254);
    EXPECT_GE(range->farthest, farthest);
    EXPECT_LT(range->farthest, farthest + 1.0 / 127);
  }
}

}  // namespace
}  // namespace rilievo
