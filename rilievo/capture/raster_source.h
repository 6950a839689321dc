// How does the library's own rasteriser serve as a source of pictures, without OpenGL?
//
// Captures a scene as it is placed now. Perspective cameras, any objects, wherever they are. The
// same surfaces, depths, identifiers and shading as OpenGL's; blended parts are absent. On
// processors several times as fast as OpenGL there. Uses all cores; the result does not depend on
// the number of threads.
#pragma once

#include <cstddef>
#include <vector>

#include "rilievo/capture/capture_source.h"
#include "rilievo/render/placed_scene.h"
#include "rilievo/render/raster/raster_picture.h"

namespace rilievo {

// A scene in the rasteriser as a capture source.
class RasterSource final : public CaptureSource {
 public:
  // The memory for drawing pictures of up to `size` texels a side.
  [[nodiscard]] static std::size_t bytes(int size, int samples) {
    return PictureRasterizer::bytes(size, samples);
  }
  // Can it capture with so many samples per texel?
  [[nodiscard]] static bool can_sample(int samples) { return samples == 1 || samples == 4; }

  // `placed` must outlive the source.
  explicit RasterSource(const PlacedScene& placed) : placed_(placed), rasterizer_(placed.scene()) {}

  [[nodiscard]] std::string_view name() const override { return placed_.scene().name; }
  [[nodiscard]] Box bounds(std::span<const std::uint32_t> objects) const override;
  // Fails for an invalid camera, or one that is not perspective or larger than
  // SampleRaster::kMaxSize, for other numbers of samples than 1 and 4, and for `farthest` of
  // objects that reach beyond the far plane.
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override;
  [[nodiscard]] const Scene* scene() const override { return &placed_.scene(); }

  // The same as nailboards keep it: bytes of sRGB and window_z, of `objects` that lie in front of
  // the eye (not empty), as PictureRasterizer draws them. Valid until the next call; does not
  // allocate once its buffers are large enough.
  [[nodiscard]] const RasterPicture& draw(const Camera& camera,
                                          std::span<const std::uint32_t> objects, int samples) {
    rasterizer_.draw(camera, objects, placed_.poses(), samples, picture_);
    return picture_;
  }
  // The last picture that draw() returned.
  [[nodiscard]] const RasterPicture& picture() const { return picture_; }
  [[nodiscard]] const std::vector<float>& draw_farthest(const Camera& camera,
                                                        std::span<const std::uint32_t> objects) {
    rasterizer_.draw_farthest(camera, objects, placed_.poses(), farthest_);
    return farthest_;
  }
  // The same in two steps, for captures on another thread: place() finds where the objects are now,
  // and the others draw what was placed. Any thread may call place() while one thread draws.
  void place(const Camera& camera, std::span<const std::uint32_t> objects,
             std::vector<PlacedMesh>& placed) const {
    rasterizer_.place(camera, objects, placed_.poses(), placed);
  }
  void draw(const Camera& camera, std::span<const PlacedMesh> placed, int samples,
            RasterPicture& picture) {
    rasterizer_.draw(camera, placed, samples, picture);
  }
  [[nodiscard]] const std::vector<float>& draw_farthest(const Camera& camera,
                                                        std::span<const PlacedMesh> placed) {
    rasterizer_.draw_farthest(camera, placed, farthest_);
    return farthest_;
  }
  [[nodiscard]] const ObjectPicture& draw_objects(const Camera& camera,
                                                  std::span<const std::uint32_t> objects) {
    rasterizer_.draw_objects(camera, objects, placed_.poses(), objects_);
    return objects_;
  }

 private:
  const PlacedScene& placed_;
  PictureRasterizer rasterizer_;
  RasterPicture picture_;
  std::vector<float> farthest_;
  ObjectPicture objects_;
  std::vector<std::uint32_t> visible_;
};

}  // namespace rilievo
