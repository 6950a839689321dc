// Pre-warped pictures on the GPU, which many objects share: room for what a frame draws.
//
// Whoever needs room takes that of the picture that was used longest ago. Needs a current OpenGL
// context.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "rilievo/nailboard/gl/nailboard_atlas.h"
#include "rilievo/nailboard/gl/nailboard_drawer.h"
#include "rilievo/nailboard/prewarped_boards.h"

namespace rilievo {

// An atlas of pre-warped pictures, and what draws them.
class AtlasBoards final : public PrewarpedBoards {
 public:
  // Fails if the driver refuses the memory or the shaders.
  [[nodiscard]] static Result<std::unique_ptr<AtlasBoards>> create();

  void begin() override { ++now_; }
  [[nodiscard]] std::optional<PrewarpedBoard> place(int width, int height) override;
  [[nodiscard]] bool use(const PrewarpedBoard& board) override;
  void release(const PrewarpedBoard& board) override;
  void write(const PrewarpedBoard& board, const EncodedPiece& picture) override;
  void write(const PrewarpedBoard& board, const Prewarped& picture,
             const PicturePiece& piece) override;
  void write_objects(const PrewarpedBoard& board, std::span<const std::uint32_t> objects) override;
  // On a software rasteriser with two cores, where a triangle takes 280 ns: a pixel is encoded,
  // uploaded and drawn.
  [[nodiscard]] CostTerms cost_terms() const override { return {500, 0.08}; }
  [[nodiscard]] std::unique_ptr<BoardDrawer> make_drawer() override;

 private:
  class Drawer;
  struct Place {
    AtlasSlot slot;
    std::uint32_t generation = 0;
    std::uint64_t used = 0;
    bool taken = false;
  };
  AtlasBoards(NailboardAtlas atlas, NailboardDrawer drawer)
      : atlas_(std::move(atlas)), drawer_(std::move(drawer)) {}
  [[nodiscard]] bool is_there(const PrewarpedBoard& board) const;

  NailboardAtlas atlas_;
  NailboardDrawer drawer_;
  std::vector<Place> places_;
  std::uint64_t now_ = 0;
  EncodedPiece encoded_;  // kept, so that writing does not allocate
};

}  // namespace rilievo
