#include "rilievo/nailboard/software/software_boards.h"

#include <cstddef>

#include "rilievo/core/expects.h"
#include "rilievo/nailboard/software/nailboard_composer.h"

namespace rilievo {
namespace {

constexpr int kBoardBits = 16;

}  // namespace

// Composes them.
class SoftwareBoards::Drawer final : public BoardDrawer {
 public:
  explicit Drawer(SoftwareBoards& boards) : boards_(boards) {}

  void draw(const Camera& frame, std::span<const PlacedBoard> boards, Output) override {
    place(boards);
    composer_.place(frame, DepthMode::exact, placed_);
  }
  void draw_outlines(const Camera& frame, std::span<const PlacedBoard> boards) override {
    place(boards);
    place_outlines(frame, placed_, outlines_);
  }
  [[nodiscard]] const TileDrawer* tiles() const override { return &composer_; }
  [[nodiscard]] const TileDrawer* outline_tiles() const override { return &outlines_; }

 private:
  void place(std::span<const PlacedBoard> boards) {
    placed_.clear();
    for (const PlacedBoard& one : boards)
      placed_.push_back({boards_.places_[one.board.index].picture.get(), one.geometry,
                         glm::dmat4(1.0), one.object, one.from, one.to});
  }

  SoftwareBoards& boards_;
  std::vector<SoftwareNailboardInstance> placed_;  // kept, so that drawing does not allocate
  NailboardComposer composer_{SampleRounding::nearest};
  LineTiles outlines_;
};

std::optional<PrewarpedBoard> SoftwareBoards::place(int width, int height) {
  std::uint32_t index = 0;
  while (index < places_.size() && places_[index].taken) ++index;
  if (index == places_.size()) places_.emplace_back();
  Place& place = places_[index];
  if (!place.picture) place.picture = std::make_unique<SoftwareNailboard>();
  place.width = width, place.height = height;
  place.taken = true;
  return PrewarpedBoard{index, ++place.generation};
}

bool SoftwareBoards::use(const PrewarpedBoard& board) {
  return board.index < places_.size() && places_[board.index].taken &&
         places_[board.index].generation == board.generation;
}

void SoftwareBoards::release(const PrewarpedBoard& board) {
  if (use(board)) places_[board.index].taken = false;
}

void SoftwareBoards::write(const PrewarpedBoard& board, const EncodedPiece& picture) {
  RILIEVO_EXPECTS(use(board));
  Place& place = places_[board.index];
  place.picture->assign(place.width, place.height, picture.color, picture.picture, kBoardBits);
}

void SoftwareBoards::write(const PrewarpedBoard& board, const Prewarped& picture,
                           const PicturePiece& piece) {
  RILIEVO_EXPECTS(use(board));
  places_[board.index].picture->assign(picture, piece);
}

void SoftwareBoards::write_objects(const PrewarpedBoard& board,
                                   std::span<const std::uint32_t> objects) {
  RILIEVO_EXPECTS(use(board));
  places_[board.index].picture->assign_objects(objects, true);
}

std::unique_ptr<BoardDrawer> SoftwareBoards::make_drawer() {
  return std::make_unique<Drawer>(*this);
}

}  // namespace rilievo
