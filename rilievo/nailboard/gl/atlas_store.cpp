#include "rilievo/nailboard/gl/atlas_store.h"

#include <optional>
#include <utility>
#include <vector>

#include "rilievo/gl/context.h"
#include "rilievo/nailboard/gl/nailboard_capture.h"

namespace rilievo {
namespace {

// Pictures in an atlas of textures, captured by OpenGL or by the rasteriser.
class AtlasStore final : public NailboardStore {
 public:
  AtlasStore(SceneRenderer& renderer, NailboardCapture pictures)
      : renderer_(renderer), pictures_(std::move(pictures)) {}

  [[nodiscard]] NailboardSet& pictures() override { return pictures_.set(); }

  [[nodiscard]] int max_picture_size() const override {
    return pictures_.set().atlas().max_picture_size();
  }
  [[nodiscard]] int texel_cell() const override { return AtlasAllocator::kCell; }
  [[nodiscard]] std::uint64_t max_texels() const override {
    return std::uint64_t(pictures_.set().atlas().allocator().layers()) *
           AtlasAllocator::kLayerSize * AtlasAllocator::kLayerSize;
  }
  [[nodiscard]] std::size_t bytes() const override { return pictures_.set().bytes(); }
  [[nodiscard]] DrawnBy drawn_by() const override { return DrawnBy::opengl; }
  [[nodiscard]] PlacedRaster* rasterizer() override { return pictures_.rasterizer(); }

  [[nodiscard]] bool allocate(std::uint32_t slot, int width, int height) override {
    if (slot >= slots_.size()) slots_.resize(slot + 1);
    slots_[slot] = pictures_.set().atlas().allocate(width, height);
    return slots_[slot].has_value();
  }
  void free(std::uint32_t slot) override {
    pictures_.set().atlas().free(*slots_[slot]);
    slots_[slot].reset();
  }
  void capture(std::uint32_t slot, const Camera& camera,
               std::span<const std::uint32_t> objects) override {
    pictures_.capture(camera, objects, *slots_[slot]);
  }
  [[nodiscard]] int written_bits() const override { return pictures_.set().atlas().delta_bits(); }
  void write(std::uint32_t slot, const RasterPicture& picture, int) override {
    pictures_.set().atlas().write(*slots_[slot], picture);
  }
  [[nodiscard]] GapTable gaps(const Camera& camera,
                              std::span<const std::uint32_t> objects) override {
    return pictures_.gaps(camera, objects);
  }
  [[nodiscard]] std::optional<DeltaRange> delta_range(std::uint32_t slot) override {
    return rilievo::delta_range(pictures_.set().atlas().blocks(*slots_[slot]));
  }
  void finish() override { gl::finish(); }
  void capture_objects(std::uint32_t slot, const Camera& camera,
                       std::span<const std::uint32_t> objects) override {
    pictures_.set().atlas().capture_objects(renderer_, camera, objects, *slots_[slot]);
  }
  void write_objects(std::uint32_t slot, std::span<const std::uint32_t> objects) override {
    pictures_.set().atlas().write_objects(*slots_[slot], objects);
  }
  void show(std::uint32_t slot, const PictureGeometry& geometry) override {
    pictures_.set().set_item(slot, *slots_[slot], geometry);
  }
  [[nodiscard]] Nailboard read(std::uint32_t slot, const PictureGeometry& geometry) const override {
    return pictures_.set().atlas().read(*slots_[slot], geometry);
  }

 private:
  SceneRenderer& renderer_;
  NailboardCapture pictures_;
  std::vector<std::optional<AtlasSlot>> slots_;
};

}  // namespace

Result<std::unique_ptr<NailboardStore>> make_atlas_store(SceneRenderer& renderer,
                                                         const NailboardStoreOptions& options) {
  Result<NailboardCapture> pictures = NailboardCapture::create(
      renderer, options.capture_by, {options.max_bytes, options.delta_bits, options.samples},
      options.depth_mode);
  if (!pictures) return pictures.error();
  return {std::make_unique<AtlasStore>(renderer, std::move(*pictures))};
}

}  // namespace rilievo
