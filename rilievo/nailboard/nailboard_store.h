// Captures a scene's pictures and keeps them as nailboards, in textures or in memory.
//
// A chooser (the cache, or method/pictures.h) decides; a store carries out. Pictures are numbered
// by slots, as the chooser likes. nailboard/gl/atlas_store.h keeps textures,
// nailboard/software/software_store.h memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "rilievo/capture/capture_by.h"
#include "rilievo/core/camera.h"
#include "rilievo/core/picture_geometry.h"
#include "rilievo/kind/drawable.h"
#include "rilievo/nailboard/gap_table.h"
#include "rilievo/nailboard/nailboard.h"

namespace rilievo {

class PlacedRaster;
struct RasterPicture;

// Who draws frames.
enum class DrawnBy { software, opengl };

// How pictures are captured and kept.
struct NailboardStoreOptions {
  std::size_t max_bytes = std::size_t(256) << 20;
  int delta_bits = 8;
  DepthMode depth_mode = DepthMode::exact;
  int samples = 4;  // of a texel: those of the frame that is drawn into
  CaptureBy capture_by = CaptureBy::automatic;
};

// Keeps pictures for one backend.
class NailboardStore {
 public:
  virtual ~NailboardStore() = default;

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
  [[nodiscard]] virtual PlacedRaster* rasterizer() = 0;

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
  // A copy of a picture.
  [[nodiscard]] virtual Nailboard read(std::uint32_t slot,
                                       const PictureGeometry& geometry) const = 0;
  // How much of each instance of pictures() was seen in the last frame of colours, from 0 to 1.
  // Leaves `shares` as it is where the backend does not count (OpenGL).
  virtual void find_seen_shares(std::vector<float>& /*shares*/) {}
};

}  // namespace rilievo
