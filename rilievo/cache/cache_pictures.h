// Who makes a scene's pictures, and where are they kept? Textures, or memory.
//
// The cache (scene_cache.h) or a PictureChooser decides; a store carries out. Pictures are numbered
// by slots: those of the cache's plan (policy.h), or the chooser's objects.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "rilievo/cache/machine_costs.h"
#include "rilievo/core/camera.h"
#include "rilievo/core/picture_geometry.h"
#include "rilievo/kind/drawable.h"
#include "rilievo/nailboard/gap_table.h"

namespace rilievo {

class RasterSource;
struct RasterPicture;

// Keeps pictures for one backend.
class CachePictures {
 public:
  virtual ~CachePictures() = default;

  // The largest size of a picture, texels a side.
  [[nodiscard]] virtual int max_picture_size() const = 0;
  // Sizes are rounded up to multiples of this.
  [[nodiscard]] virtual int texel_cell() const = 0;
  // The most texels that all pictures have together.
  [[nodiscard]] virtual std::uint64_t max_texels() const = 0;
  // The memory of pictures, bytes.
  [[nodiscard]] virtual std::size_t bytes() const = 0;
  // Who draws frames from the pictures?
  [[nodiscard]] virtual DrawnBy drawn_by() const = 0;
  // The rasteriser that captures pictures; null: OpenGL does, whose captures cost other things.
  [[nodiscard]] virtual RasterSource* rasterizer() = 0;

  // Makes room for a picture; false if there is none.
  [[nodiscard]] virtual bool allocate(std::uint32_t slot, int width, int height) = 0;
  virtual void free(std::uint32_t slot) = 0;
  // Captures `objects` (opaque parts) where they are now. The slot has the camera's size.
  virtual void capture(std::uint32_t slot, const Camera& camera,
                       std::span<const std::uint32_t> objects) = 0;
  // Writes a picture that others have captured. It has the slot's size. `delta_bits`: those of
  // capture(), or written_bits().
  virtual void write(std::uint32_t slot, const RasterPicture& picture, int delta_bits) = 0;
  [[nodiscard]] virtual int written_bits() const = 0;
  // The gap table of the picture that was captured last.
  [[nodiscard]] virtual GapTable gaps(const Camera& camera,
                                      std::span<const std::uint32_t> objects) = 0;
  // The Deltas of a picture; none if it is empty. Can wait until captures are complete.
  [[nodiscard]] virtual std::optional<DeltaRange> delta_range(std::uint32_t slot) = 0;
  // Waits until captures are complete.
  virtual void finish() = 0;
  // Captures the object identifiers of a picture.
  virtual void capture_objects(std::uint32_t slot, const Camera& camera,
                               std::span<const std::uint32_t> objects) = 0;
  // Writes identifiers that others have captured: a texel each, rows from the bottom.
  virtual void write_objects(std::uint32_t slot, std::span<const std::uint32_t> objects) = 0;
  // The set that draws them, and lives as long as the store.
  [[nodiscard]] virtual Drawable& pictures() = 0;
  // Item `slot` of pictures() is this picture from now on.
  virtual void show(std::uint32_t slot, const PictureGeometry& geometry) = 0;
};

}  // namespace rilievo
