// Which triangles does a tile of a frame show, ready to be shaded? Internal to render/raster.
//
// A SampleBuffer of a tile's size, with rows from the bottom, and the colours of its samples. A
// thread's own.
#pragma once

#include <cstdint>
#include <vector>

#include "rilievo/render/shading/band_shader.h"
#include "rilievo/render/software/frame_tile.h"

namespace rilievo {

// The first sample of a pixel; y counts from the top.
[[nodiscard]] inline std::size_t first_sample(const SampleBuffer& in, int x, int y) {
  return in.row(in.height - 1 - y) + std::size_t(x) * std::size_t(in.samples);
}

// The samples of one tile.
struct TileSamples {
  SampleBuffer samples;
  std::vector<std::uint32_t> colors;  // of samples that are covered, once they are shaded
  BandShader shader;

  // Empties it.
  void begin(int count) {
    constexpr std::size_t kTexels = std::size_t(FrameTile::kSize) * FrameTile::kSize;
    samples.width = samples.height = FrameTile::kSize;
    samples.samples = count;
    samples.stride = std::size_t(FrameTile::kSize) * std::size_t(count);
    samples.depth.assign(kTexels * std::size_t(count), 1.0f);
    samples.triangle.resize(kTexels * std::size_t(count));
    colors.resize(kTexels * std::size_t(count));
  }

  // Shades row `row` of the tile's blocks, from the top. `whole` is the view of the frame.
  void shade_blocks(const PictureView& whole, const FrameTile& tile, int row) {
    // The tile's lowest row can lie below the frame.
    PictureRays rays = whole.rays;
    const auto left = float(tile.x), bottom = float(tile.height - tile.y - FrameTile::kSize);
    rays.first += left * rays.per_x + bottom * rays.per_y;
    const PictureView part{samples,      whole.meshes,     rays,
                           whole.lights, ColorScale::srgb, colors.data()};
    const int from = FrameTile::kSize - (row + 1) * FrameTile::kBlock;  // rows run upwards
    shader.shade(part, from, from + FrameTile::kBlock);
  }
};
static_assert(FrameTile::kBlock <= BandShader::kBand);

}  // namespace rilievo
