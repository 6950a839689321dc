#include "rilievo/layered_impostor/slice_rects.h"

#include <algorithm>

namespace rilievo {
namespace {

TexelRect common(const TexelRect& a, const TexelRect& b) {
  return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

// Runs of tiles in a row; those with the same ends as one right above make it higher.
std::vector<TexelRect> rects_of(const Image<std::uint8_t>& tiles, const TexelRect& within) {
  std::vector<TexelRect> rects;
  for (int j = 0; j < tiles.height(); ++j)
    for (int i = 0; i < tiles.width(); ++i) {
      if (!tiles(i, j)) continue;
      const int begin = i;
      while (i < tiles.width() && tiles(i, j)) ++i;
      const TexelRect run{begin * kSliceTile, j * kSliceTile, i * kSliceTile, (j + 1) * kSliceTile};
      const auto above = std::find_if(rects.begin(), rects.end(), [&](const TexelRect& r) {
        return r.x0 == run.x0 && r.x1 == run.x1 && r.y1 == run.y0;
      });
      if (above == rects.end())
        rects.push_back(run);
      else
        above->y1 = run.y1;
    }
  for (TexelRect& rect : rects) rect = common(rect, within);
  return rects;
}

}  // namespace

std::vector<std::vector<TexelRect>> slice_rects(const LayeredImpostor& impostor, int view) {
  const std::vector<Slice>& slices = impostor.slices[std::size_t(view)];
  const Image<SurfaceTexel>& texels = impostor.surfaces[std::size_t(view)].texels;
  const int columns = (texels.width() + kSliceTile - 1) / kSliceTile;
  const int rows = (texels.height() + kSliceTile - 1) / kSliceTile;
  std::vector<Image<std::uint8_t>> tiles(slices.size(), Image<std::uint8_t>(columns, rows, 0));
  for (int y = 0; y < texels.height(); ++y)
    for (int x = 0; x < texels.width(); ++x) {
      const SurfaceTexel& texel = texels(x, y);
      if (texel.q == 0) continue;
      const DepthInterval interval = sliced_interval(texel, impostor.slicing);
      // Both ends ascend with the layer: the layers of a texel are one run.
      auto slice = std::partition_point(slices.begin(), slices.end(),
                                        [&](const Slice& s) { return s.back <= interval.front; });
      for (; slice != slices.end() && shows(*slice, interval); ++slice)
        tiles[std::size_t(slice - slices.begin())](x / kSliceTile, y / kSliceTile) = 1;
    }
  std::vector<std::vector<TexelRect>> rects;
  for (std::size_t s = 0; s < slices.size(); ++s) {
    std::vector<TexelRect> few = rects_of(tiles[s], slices[s].rect);
    std::size_t area = 0;
    for (const TexelRect& rect : few) area += rect.area();
    if (2 * area > slices[s].rect.area()) few = {slices[s].rect};
    rects.push_back(std::move(few));
  }
  return rects;
}

}  // namespace rilievo
