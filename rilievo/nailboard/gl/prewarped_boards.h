// Pre-warped pictures on the GPU, which many objects share: room for what a frame draws.
//
// A picture is good for one eye; whoever needs room takes that of the one that was used longest
// ago. Needs a current OpenGL context.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "rilievo/nailboard/gl/nailboard_atlas.h"
#include "rilievo/nailboard/gl/nailboard_drawer.h"

namespace rilievo {

// An atlas of pre-warped pictures, and what draws them.
class PrewarpedBoards {
 public:
  // Fails if the driver refuses the memory or the shaders.
  [[nodiscard]] static Result<PrewarpedBoards> create();

  // Names a place; it may be taken by others from one draw call to the next.
  struct Board {
    std::uint32_t index = 0, generation = 0;
  };
  // Until the next call of this, what is placed or used stays.
  void begin() { ++now_; }
  // Nothing if what has been placed since begin() leaves no room.
  [[nodiscard]] std::optional<Board> place(int width, int height);
  // Is it still there? Then it stays.
  [[nodiscard]] bool use(const Board& board);
  void release(const Board& board);
  [[nodiscard]] const AtlasSlot& slot(const Board& board) const {
    return places_[board.index].slot;
  }

  [[nodiscard]] NailboardAtlas& atlas() { return atlas_; }
  [[nodiscard]] NailboardDrawer& drawer() { return drawer_; }

 private:
  struct Place {
    AtlasSlot slot;
    std::uint32_t generation = 0;
    std::uint64_t used = 0;
    bool taken = false;
  };
  PrewarpedBoards(NailboardAtlas atlas, NailboardDrawer drawer)
      : atlas_(std::move(atlas)), drawer_(std::move(drawer)) {}
  [[nodiscard]] bool is_there(const Board& board) const;

  NailboardAtlas atlas_;
  NailboardDrawer drawer_;
  std::vector<Place> places_;
  std::uint64_t now_ = 0;
};

}  // namespace rilievo
