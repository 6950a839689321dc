#include "rilievo/render/software/software_target.h"

#include <algorithm>
#include <bit>
#include <memory>

#include "rilievo/core/depth.h"
#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/render/software/resolve_tile.h"

namespace rilievo {
namespace {

static_assert(std::endian::native == std::endian::little, "colours are bytes of a word");
static_assert(sizeof(glm::u8vec4) == sizeof(std::uint32_t));

}  // namespace

SoftwareTarget::SoftwareTarget(int width, int height, int samples)
    : samples_(samples), color_(width, height), inverse_z_(width, height) {
  RILIEVO_EXPECTS(1 <= width && width <= 16384 && 1 <= height && height <= 16384);
  RILIEVO_EXPECTS(samples == 1 || samples == 4);
}

void SoftwareTarget::draw_tiles(TileContent of, double z_far,
                                std::span<const TileDrawer* const> drawers,
                                std::uint32_t background) {
  RILIEVO_EXPECTS(z_far > 0);
  nothing_ = float(1 / z_far);
  const int across = tiles_across(width());
  auto* content = of == TileContent::color
                      ? reinterpret_cast<std::uint32_t*>(color_.texels().data())
                      : objects_.texels().data();
  float* inverse_z = inverse_z_.texels().data();
  parallel_for(0, across * tiles_across(height()), [&](int i) {
    // A thread's own, kept: a steady frame allocates nothing and touches no new page.
    static thread_local const auto memory = std::make_unique<FrameTile>();
    FrameTile& tile = *memory;
    tile.x = i % across * FrameTile::kSize, tile.y = i / across * FrameTile::kSize;
    tile.width = width(), tile.height = height();
    tile.samples = of == TileContent::color ? samples_ : 1;
    tile.of = of;
    tile.nothing = nothing_;
    tile.clear(background);
    for (const TileDrawer* drawer : drawers) drawer->draw_tile(tile);
    resolve_tile(tile, content, inverse_z, std::size_t(width()));
  });
}

void SoftwareTarget::draw(double z_far, std::span<const TileDrawer* const> drawers,
                          glm::u8vec4 background) {
  draw_tiles(TileContent::color, z_far, drawers, std::bit_cast<std::uint32_t>(background));
}

void SoftwareTarget::draw_objects(double z_far, std::span<const TileDrawer* const> drawers) {
  if (objects_.empty()) objects_ = Image<std::uint32_t>(width(), height());
  draw_tiles(TileContent::object_id, z_far, drawers, 0);
}

Image<float> SoftwareTarget::eye_z() const {
  Image<float> depth(width(), height());
  const std::span<const float> from = inverse_z_.texels();
  for (std::size_t i = 0; i < from.size(); ++i)
    depth.texels()[i] = from[i] > nothing_ ? 1 / from[i] : kNoDepth;
  return depth;
}

}  // namespace rilievo
