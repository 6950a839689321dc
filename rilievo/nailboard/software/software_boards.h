// Pre-warped pictures in memory: what a frame draws of them is drawn from where it was written.
//
// There is always room. Freed places keep their memory for the next pictures.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "rilievo/nailboard/prewarped_boards.h"
#include "rilievo/nailboard/software/software_nailboard.h"

namespace rilievo {

// Nailboards of 16 bits, and what draws them into tiles.
class SoftwareBoards final : public PrewarpedBoards {
 public:
  void begin() override {}
  [[nodiscard]] std::optional<PrewarpedBoard> place(int width, int height) override;
  [[nodiscard]] bool use(const PrewarpedBoard& board) override;
  void release(const PrewarpedBoard& board) override;
  void write(const PrewarpedBoard& board, const EncodedPiece& picture) override;
  void write(const PrewarpedBoard& board, const Prewarped& picture,
             const PicturePiece& piece) override;
  void write_objects(const PrewarpedBoard& board, std::span<const std::uint32_t> objects) override;
  // The same cores write a texel in 2 ns, of which there are two a pixel, and draw a pixel in 3 ns.
  [[nodiscard]] CostTerms cost_terms() const override { return {100, 0.025}; }
  [[nodiscard]] std::unique_ptr<BoardDrawer> make_drawer() override;

 private:
  class Drawer;
  struct Place {
    std::unique_ptr<SoftwareNailboard> picture;  // stays where it is
    int width = 0, height = 0;
    std::uint32_t generation = 0;
    bool taken = false;
  };
  std::vector<Place> places_;
};

}  // namespace rilievo
