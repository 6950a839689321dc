// How are nailboards a drawable? As an atlas of thousands of pictures, drawn in one call.
//
// An item is a picture in a slot of the atlas. The code that captures assigns items to slots; the
// set owns the atlas and its memory. Needs a current OpenGL context.
#pragma once

#include <memory>
#include <vector>

#include "rilievo/kind/drawable.h"
#include "rilievo/nailboard/error_model.h"
#include "rilievo/nailboard/gl/nailboard_atlas.h"
#include "rilievo/nailboard/gl/nailboard_drawer.h"

namespace rilievo {

// An atlas of nailboards.
class NailboardSet final : public Drawable {
 public:
  // Allocates the atlas. Fails if the driver cannot.
  [[nodiscard]] static Result<std::unique_ptr<NailboardSet>> create(const AtlasOptions& options,
                                                                    DepthMode mode);

  [[nodiscard]] NailboardAtlas& atlas() { return atlas_; }
  [[nodiscard]] const NailboardAtlas& atlas() const { return atlas_; }

  // Makes `item` the picture in `slot`.
  void set_item(std::uint32_t item, const AtlasSlot& slot, const PictureGeometry& geometry);

  [[nodiscard]] std::string_view kind() const override { return "nailboard"; }
  void draw(const Camera& frame, std::span<const Instance> instances, Output output) override;
  void draw_outlines(const Camera& frame, std::span<const Instance> instances) override;
  [[nodiscard]] ErrorModel error_model(std::uint32_t item) const override;
  [[nodiscard]] CostTerms cost_terms(std::uint32_t item) const override;
  [[nodiscard]] std::size_t bytes() const override { return atlas_.bytes(); }
  // One picture, with its camera moved along with the object.
  [[nodiscard]] std::vector<DepthImage> read_pictures(const Instance& instance) const override;

 private:
  struct Item {
    AtlasSlot slot;
    PictureGeometry geometry;
  };
  NailboardSet(NailboardAtlas atlas, NailboardDrawer drawer, DepthMode mode)
      : atlas_(std::move(atlas)), drawer_(std::move(drawer)), mode_(mode) {}
  void place(std::span<const Instance> instances);

  NailboardAtlas atlas_;
  NailboardDrawer drawer_;
  DepthMode mode_;
  std::vector<Item> items_;
  std::vector<NailboardInstance> placed_;  // kept, so that drawing does not allocate
};

}  // namespace rilievo
