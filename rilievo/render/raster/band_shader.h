// What colour has each texel of a picture whose samples are known?
//
// Shades each triangle once in each texel where it is seen, at the texel's middle, and averages
// over the samples, as OpenGL does with several samples a pixel. Behind raster_picture.h.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rilievo/render/raster/raster_picture.h"
#include "rilievo/render/raster/sample_raster.h"
#include "rilievo/render/raster/surface_points.h"
#include "rilievo/render/shading/surface_shading.h"

namespace rilievo {

// A RasterInstance as shading needs it.
struct PlacedMesh {
  const Mesh* mesh = nullptr;
  SurfacePlacement surface;
};

// What is the same for all texels of a picture.
struct PictureView {
  const SampleRaster& raster;
  std::span<const RasterInstance> instances;
  std::span<const PlacedMesh> placed;  // the same
  // The ways from the eye through the middles of texels, world axes: of the lower left one, and
  // from one to the next.
  glm::vec3 first_ray, ray_per_x, ray_per_y;
  SurfaceLights lights;
};

// Shades rows of texels, a few at once. Keeps its buffers; each thread needs one of its own.
class BandShader {
 public:
  static constexpr int kBand = 8;  // rows at most

  // Fills rows [from, to) of the picture, which has its size.
  void shade(const PictureView& view, int from, int to, RasterPicture& picture);

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFu;

  // A triangle in a texel.
  struct Seen {
    std::uint32_t triangle;  // of its instance
    std::uint32_t next;      // index of another one of its instance, or kNone
    std::uint16_t x, row;    // texel of the band
    std::uint16_t samples;
  };
  // Of a surface that waits to be shaded.
  struct Share {
    std::size_t texel;  // of the band
    float samples;
  };

  void find_seen(const PictureView& view, int y, int row, RasterPicture& picture);
  void add_seen(const PictureView& view, std::uint32_t name, int x, int row, int samples);
  void add_instance(const PictureView& view, std::uint32_t instance, int from);
  void append(const PictureView& view, const PlacedMesh& placed);
  void flush(const PictureView& view);

  std::vector<Seen> seen_;
  std::vector<std::uint32_t> first_of_;  // by instance: index into seen_, or kNone
  std::vector<std::uint32_t> met_;       // instances that are seen
  std::uint32_t instance_ = 0;           // the last one met
  TriangleRays rays_;
  Surfaces surfaces_;
  SurfaceColors colors_;
  Share shares_[Surfaces::kMost];  // of the surfaces
  std::vector<glm::vec3> sums_;    // by texel of the band
};

}  // namespace rilievo
