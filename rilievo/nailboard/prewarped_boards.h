// Room for pre-warped pictures until they are drawn: textures, or memory.
//
// Several drawables share one store. A picture is good for one eye; a store with limited room takes
// that of the picture that was used longest ago.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "rilievo/kind/drawable.h"
#include "rilievo/nailboard/encode_prewarped.h"

namespace rilievo {

// Names a place in a store; it may be taken by others from one draw call to the next.
struct PrewarpedBoard {
  std::uint32_t index = 0, generation = 0;
};

// A picture of the store, placed in the world.
struct PlacedBoard {
  PrewarpedBoard board;
  PictureGeometry geometry;
  // The object identifier to write; kNoObject: those written with the picture.
  std::uint32_t object = kNoObject;
  // The cross-fade range; see Instance.
  float from = 0, to = 1;
};

// Draws the boards of one drawable.
class BoardDrawer {
 public:
  virtual ~BoardDrawer() = default;
  // As Drawable's functions of the same names.
  virtual void draw(const Camera& frame, std::span<const PlacedBoard> boards, Output output) = 0;
  virtual void draw_outlines(const Camera& frame, std::span<const PlacedBoard> boards) = 0;
  [[nodiscard]] virtual const TileDrawer* tiles() const { return nullptr; }
  [[nodiscard]] virtual const TileDrawer* outline_tiles() const { return nullptr; }
};

// Keeps pre-warped pictures for one backend.
class PrewarpedBoards {
 public:
  virtual ~PrewarpedBoards() = default;

  // Until the next call of this, what is placed or used stays.
  virtual void begin() = 0;
  // Nothing if what has been placed since begin() leaves no room.
  [[nodiscard]] virtual std::optional<PrewarpedBoard> place(int width, int height) = 0;
  // Is it still there? Then it stays.
  [[nodiscard]] virtual bool use(const PrewarpedBoard& board) = 0;
  virtual void release(const PrewarpedBoard& board) = 0;
  // The picture, of the size that was asked for: encoded before, or a piece of one that is not; and
  // the identifiers of its texels, rows from the bottom.
  virtual void write(const PrewarpedBoard& board, const EncodedPiece& picture) = 0;
  virtual void write(const PrewarpedBoard& board, const Prewarped& picture,
                     const PicturePiece& piece) = 0;
  virtual void write_objects(const PrewarpedBoard& board,
                             std::span<const std::uint32_t> objects) = 0;
  // The cost of a picture besides its warp, in triangles: of writing and drawing it; per_pixel of
  // the frame.
  [[nodiscard]] virtual CostTerms cost_terms() const = 0;
  // A drawer, which the store must outlive.
  [[nodiscard]] virtual std::unique_ptr<BoardDrawer> make_drawer() = 0;
};

}  // namespace rilievo
