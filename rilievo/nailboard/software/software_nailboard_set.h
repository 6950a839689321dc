// How are nailboards in memory a drawable? As a set of many, drawn into tiles.
//
// An item is a picture that somebody else keeps; the cache has them
// (nailboard/software/software_store.h).
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <string_view>
#include <vector>

#include "rilievo/kind/drawable.h"
#include "rilievo/nailboard/software/nailboard_composer.h"

namespace rilievo {

// A set of nailboards. draw() places the instances for the tiles that are drawn next.
class SoftwareNailboardSet final : public Drawable {
 public:
  explicit SoftwareNailboardSet(DepthMode mode) : mode_(mode) {}

  // Makes `item` this picture, which outlives its use. Requires a picture of the geometry's size
  // when the item is drawn.
  void set_item(std::uint32_t item, const SoftwareNailboard& picture,
                const PictureGeometry& geometry);

  // The same of a picture that the set keeps.
  void keep_item(std::uint32_t item, SoftwareNailboard picture, const PictureGeometry& geometry);

  [[nodiscard]] std::string_view kind() const override { return "nailboard"; }
  void draw(const Camera& frame, std::span<const Instance> instances, Output output) override;
  void draw_outlines(const Camera& frame, std::span<const Instance> instances) override;
  [[nodiscard]] const TileDrawer* tiles() const override { return &composer_; }
  [[nodiscard]] const TileDrawer* outline_tiles() const override { return &outlines_; }

  [[nodiscard]] ErrorModel error_model(std::uint32_t item) const override;
  [[nodiscard]] CostTerms cost_terms(std::uint32_t item) const override;
  // See NailboardComposer: of the instances of the last draw().
  void find_seen_shares(std::vector<float>& shares) const { composer_.find_seen_shares(shares); }
  // Of the pictures of all items.
  [[nodiscard]] std::size_t bytes() const override;
  // One picture, with its camera moved along with the object.
  [[nodiscard]] std::vector<DepthImage> read_pictures(const Instance& instance) const override;

 private:
  struct Item {
    const SoftwareNailboard* picture = nullptr;
    PictureGeometry geometry;
  };

  void place(std::span<const Instance> instances);

  DepthMode mode_;
  std::vector<Item> items_;
  std::deque<SoftwareNailboard> kept_;             // they stay where they are
  std::vector<SoftwareNailboardInstance> placed_;  // kept, so that drawing does not allocate
  NailboardComposer composer_;
  LineTiles outlines_;
};

}  // namespace rilievo
