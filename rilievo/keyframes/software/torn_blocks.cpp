#include "rilievo/keyframes/software/torn_blocks.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "rilievo/core/parallel_for.h"
#include "rilievo/core/random.h"

namespace rilievo {
namespace {

// A surface whose depth is within this share is shown; and at most so many pixels from where the
// ray meets it.
constexpr float kShown = 2 * kSameSurfaceDepth;
constexpr int kBesideRay = 2;

// Is the surface shown there, or something in front of it?
bool shows(const WarpedFrame& warped, const FramePixel& at, float inverse_z) {
  if (!(warped.inverse_z(at.x, at.y) < inverse_z * (1 - kShown))) return true;
  for (int y = std::max(at.y - kBesideRay, 0);
       y <= std::min(at.y + kBesideRay, warped.color.height() - 1); ++y)
    for (int x = std::max(at.x - kBesideRay, 0);
         x <= std::min(at.x + kBesideRay, warped.color.width() - 1); ++x)
      if (std::abs(warped.inverse_z(x, y) - inverse_z) <= inverse_z * kShown) return true;
  return false;
}

}  // namespace

std::size_t TornBlocks::look(const Camera& frame, std::span<const WarpedKeyframe> keyframes,
                             std::span<const std::uint32_t> objects, WarpedFrame& warped) {
  frame_ = frame;
  ++frames_;
  double way = HUGE_VAL;
  for (const WarpedKeyframe& one : keyframes)
    way = std::min(way, glm::distance(one.keyframe->camera.position(), frame.position()));
  torn_.clear();
  find_edges(frame, way, warped);
  looked_.assign(at_edge_.size(), false);
  looks_.clear();
  for (const Remembered& one : remembered_)
    if (one.block < at_edge_.size()) add(one.block, kRaysBeside);
  for (std::size_t i = 0; i < std::min(edges_.size(), std::size_t(kRays)); ++i)
    add(edges_[(next_ + i) % edges_.size()], 1);
  next_ += kRays;

  const auto most = std::size_t(most_torn_ * frame.width * frame.height);
  std::size_t holes = 0;
  while (!looks_.empty() && holes < most) {
    cast(objects, warped);
    const std::size_t first = torn_.size();
    for (const Look& one : looks_) {
      if (one.inverse_z == 0 || holes >= most) continue;
      holes += tear(one.block, one.inverse_z, warped);
      if (torn_.size() == first || torn_.back() != one.block) torn_.push_back(one.block);
    }
    looks_.clear();
    for (std::size_t i = first; i < torn_.size(); ++i) {
      const int bx = int(torn_[i]) % across_, by = int(torn_[i]) / across_;
      for (int y = std::max(by - 1, 0); y <= std::min(by + 1, down_ - 1); ++y)
        for (int x = std::max(bx - 1, 0); x <= std::min(bx + 1, across_ - 1); ++x)
          add(std::uint32_t(y * across_ + x), kRaysBeside);
    }
  }
  remember();
  return holes;
}

// Those that were torn now, and those that were so before and are not known to be whole.
void TornBlocks::remember() {
  looked_.assign(at_edge_.size(), false);
  scratch_.clear();
  for (const std::uint32_t block : torn_) {
    looked_[block] = true;
    scratch_.push_back({block, 0});
  }
  for (const Remembered& one : remembered_)
    if (one.block < looked_.size() && !looked_[one.block] && one.frames + 1 < kRemembered)
      scratch_.push_back({one.block, one.frames + 1});
  remembered_.swap(scratch_);
}

// Blocks in which something that is shown moves against something else by some pixels, while the
// eye goes so far.
void TornBlocks::find_edges(const Camera& frame, double way, const WarpedFrame& warped) {
  across_ = (frame.width + kSide - 1) / kSide, down_ = (frame.height + kSide - 1) / kSide;
  at_edge_.assign(std::size_t(across_ * down_), 0);
  edges_.clear();
  const double pixels = frame.width / (frame.window.right - frame.window.left) * way;
  if (!(pixels > 0)) return;
  const auto least = float(least_gap_ / pixels);
  // Every other row tells as much.
  parallel_for(0, down_, [&](int by) {
    const int y1 = std::min((by + 1) * kSide, frame.height);
    for (int bx = 0; bx < across_; ++bx) {
      const int x0 = bx * kSide, columns = std::min(kSide, frame.width - x0);
      float nearest = 0, farthest = HUGE_VALF;
      for (int y = by * kSide; y < y1; y += 2) {
        const float* depths = warped.inverse_z.row(y).data() + x0;
        for (int x = 0; x < columns; ++x)
          nearest = std::max(nearest, depths[x]), farthest = std::min(farthest, depths[x]);
      }
      at_edge_[std::size_t(by * across_ + bx)] = nearest - farthest > least;
    }
  });
  for (std::uint32_t block = 0; block < at_edge_.size(); ++block)
    if (at_edge_[block]) edges_.push_back(block);
}

// Rays at pixels of a block, if there are none yet: one, or one for each quarter.
void TornBlocks::add(std::uint32_t block, int rays) {
  if (looked_[block]) return;
  looked_[block] = true;
  const int x0 = int(block) % across_ * kSide, y0 = int(block) / across_ * kSide;
  Random random(combine(frames_, block));
  const int side = rays == 1 ? kSide : kSide / 2;
  for (int i = 0; i < rays; ++i) {
    const int x = x0 + i % 2 * side + random.below(side),
              y = y0 + i / 2 * side + random.below(side);
    if (x < frame_.width && y < frame_.height)
      looks_.push_back({block, {std::uint16_t(x), std::uint16_t(y)}, 0});
  }
}

void TornBlocks::cast(std::span<const std::uint32_t> objects, const WarpedFrame& warped) {
  parallel_for(std::size_t(0), looks_.size(), [&](std::size_t i) {
    Look& one = looks_[i];
    const std::uint32_t color = warped.color(one.at.x, one.at.y);
    if (color == 0 || color == kCoveredPixel) return;
    const std::optional<RayHit> hit = hit_at_pixel(rays_, frame_, one.at);
    // What is drawn as polygons, or moves, is shown otherwise.
    if (!hit || !std::ranges::binary_search(objects, hit->object - 1)) return;
    const auto inverse_z = float(1 / (frame_.z_near + double(hit->distance)));
    if (!shows(warped, one.at, inverse_z)) one.inverse_z = inverse_z;
  });
}

// Makes holes of what the block shows behind a surface, and returns how many.
std::size_t TornBlocks::tear(std::uint32_t block, float inverse_z, WarpedFrame& warped) const {
  const int x0 = int(block) % across_ * kSide, y0 = int(block) / across_ * kSide;
  std::size_t count = 0;
  for (int y = y0; y < std::min(y0 + kSide, frame_.height); ++y)
    for (int x = x0; x < std::min(x0 + kSide, frame_.width); ++x) {
      std::uint32_t& color = warped.color(x, y);
      float& depth = warped.inverse_z(x, y);
      if (color == 0 || color == kCoveredPixel || !(depth < inverse_z * (1 - kShown))) continue;
      color = 0, depth = 0;
      ++warped.holes_in_strip(y / WarpedFrame::kStrip, 0);
      ++count;
    }
  return count;
}

}  // namespace rilievo
