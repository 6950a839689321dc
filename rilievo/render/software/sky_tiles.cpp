#include "rilievo/render/software/sky_tiles.h"

#include <algorithm>
#include <cmath>

#include "rilievo/core/color.h"

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/render/software/sky_tiles.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rilievo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

// All samples of a block that show nothing.
void draw_sky_block(const SkyTiles::View& view, FrameTile& tile, int block, int x, int y) {
  const hn::CappedTag<float, 8> f;
  const hn::RebindToSigned<decltype(f)> i32;
  const hn::RebindToUnsigned<decltype(f)> u32;
  const auto nothing = hn::Set(f, tile.nothing);
  const int planes = tile.planes(block), lanes = int(hn::Lanes(f));
  for (int i = 0; i < FrameTile::kBlockPixels; i += lanes) {
    auto any = hn::Le(hn::Load(f, tile.first[block].inverse_z + i), nothing);
    for (int s = 1; s < planes; ++s)
      any = hn::Or(any, hn::Le(hn::Load(f, tile.plane(block, s).inverse_z + i), nothing));
    if (hn::AllFalse(f, any)) continue;
    // A vector never reaches into another row.
    const auto px = hn::Add(hn::Iota(f, 0), hn::Set(f, float(x + i % FrameTile::kBlock) + 0.5f));
    const float py = float(y + i / FrameTile::kBlock) + 0.5f;
    const auto axis = [&](int k) {
      return hn::Add(hn::Set(f, view.first[k] + py * view.per_y[k]),
                     hn::Mul(px, hn::Set(f, view.per_x[k])));
    };
    const auto dx = axis(0), dy = axis(1), dz = axis(2);
    const auto length =
        hn::Sqrt(hn::Add(hn::Mul(dx, dx), hn::Add(hn::Mul(dy, dy), hn::Mul(dz, dz))));
    const auto elevation = hn::Div(dy, length);
    const auto place = hn::Mul(hn::Sqrt(hn::Min(hn::Abs(elevation), hn::Set(f, 1.0f))),
                               hn::Set(f, float(SkyTiles::kEntries - 1)));
    auto entry = hn::ConvertTo(i32, hn::Add(place, hn::Set(f, 0.5f)));
    entry = hn::Add(entry, hn::IfThenElseZero(hn::RebindMask(i32, hn::Lt(elevation, hn::Zero(f))),
                                              hn::Set(i32, SkyTiles::kEntries)));
    const auto color = hn::GatherIndex(u32, view.table, entry);
    for (int s = 0; s < planes; ++s) {
      FrameTile::Plane& plane = tile.plane(block, s);
      const auto empty = hn::RebindMask(u32, hn::Le(hn::Load(f, plane.inverse_z + i), nothing));
      hn::Store(hn::IfThenElse(empty, color, hn::Load(u32, plane.content + i)), u32,
                plane.content + i);
    }
  }
}

void draw_sky(const SkyTiles::View& view, FrameTile& tile) {
  for (int block = 0; block < FrameTile::kBlockCount; ++block) {
    if (!tile.changed[block] && tile.farthest[block] > tile.nothing) continue;
    const int x = tile.x + block % FrameTile::kBlocks * FrameTile::kBlock,
              y = tile.y + block / FrameTile::kBlocks * FrameTile::kBlock;
    if (x < tile.width && y < tile.height) draw_sky_block(view, tile, block, x, y);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(draw_sky);

void SkyTiles::set(const Sky& sky) {
  if (!table_.empty() && sky == sky_) return;
  sky_ = sky;
  table_.clear();
  for (const bool below : {false, true})
    for (int i = 0; i < kEntries; ++i) {
      const float root = float(i) / float(kEntries - 1);
      const float elevation = (below ? -1.0f : 1.0f) * root * root;
      // As scene_shaders.cpp has it.
      const glm::vec3 above =
          glm::mix(sky.horizon, sky.zenith, std::sqrt(std::clamp(elevation, 0.0f, 1.0f)));
      const float t = std::clamp(elevation / -0.08f, 0.0f, 1.0f);
      const glm::vec3 color = glm::mix(above, sky.ground, t * t * (3 - 2 * t));
      std::uint32_t bytes = 0xff000000u;
      for (int c = 0; c < 3; ++c)
        bytes |= std::uint32_t(srgb_from_linear(std::clamp(color[c], 0.0f, 1.0f)) * 255 + 0.5f)
                 << (8 * c);
      table_.push_back(bytes);
    }
}

void SkyTiles::place(const Camera& camera) {
  const glm::dmat3 axes(camera.world_from_eye);
  const ImageWindow& w = camera.window;
  first_ = glm::vec3(axes * glm::dvec3(w.left, w.top, -1));
  per_x_ = glm::vec3((w.right - w.left) / camera.width * axes[0]);
  per_y_ = glm::vec3((w.bottom - w.top) / camera.height * axes[1]);
}

void SkyTiles::draw_tile(FrameTile& tile) const {
  if (tile.of != TileContent::color) return;
  HWY_DYNAMIC_DISPATCH(draw_sky)({table_.data(), first_, per_x_, per_y_}, tile);
}

}  // namespace rilievo
#endif
