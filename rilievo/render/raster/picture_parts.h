// A picture by the rasteriser in parts, between which other things are drawn.
//
// Finds what is visible object after object, near ones first, then shades rows. The picture is that
// of PictureRasterizer::capture() with one sample a texel, but that of surfaces that are equally
// near the first one stays. Keeps its memory.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include "rilievo/core/depth_image.h"
#include "rilievo/render/raster/frame_raster.h"
#include "rilievo/render/shading/picture_shader.h"

namespace rilievo {

// Rasterises pictures of one scene.
class PictureParts {
 public:
  // `scene` must be valid and outlive the object; the materials are its.
  PictureParts(const Scene& scene, std::shared_ptr<const SurfaceMaterials> materials)
      : raster_(scene, std::move(materials)) {}

  // Begins a picture of the opaque and masked parts of `objects`, as `placed` places them now.
  // `staggered`: as SampleBuffer's. Requires a valid perspective camera of at most
  // SampleRaster::kMaxSize texels a side.
  void begin(const Camera& camera, const PlacedScene& placed,
             std::span<const std::uint32_t> objects, bool staggered = false);
  // As PictureInParts::advance() and read() (capture/capture_source.h).
  int advance(double share);
  void read(int from, int to, bool with_sky, DepthImage& picture);

 private:
  FrameRaster raster_;
  PictureShader shader_;
  Camera camera_;
  bool found_ = false;
  double work_ = 0, left_to_find_ = 0;  // in triangles
  double rows_ = 0;                     // that can be read
};

}  // namespace rilievo
