#include "rilievo/nailboard/gl/atlas_boards.h"

#include <utility>

namespace rilievo {
namespace {

// Eight layers of a megatexel: a screen that is full of reliefs a few times over.
constexpr std::size_t kBoardBytes = std::size_t(58) << 20;

}  // namespace

// Draws by the store's shaders.
class AtlasBoards::Drawer final : public BoardDrawer {
 public:
  explicit Drawer(AtlasBoards& boards) : boards_(boards) {}

  void draw(const Camera& frame, std::span<const PlacedBoard> boards, Output output) override {
    place(boards);
    if (output == Output::color)
      boards_.drawer_.draw(boards_.atlas_, frame, DepthMode::exact, placed_);
    else
      boards_.drawer_.draw_objects(boards_.atlas_, frame, DepthMode::exact, placed_);
  }
  void draw_outlines(const Camera& frame, std::span<const PlacedBoard> boards) override {
    place(boards);
    boards_.drawer_.draw_outlines(frame, placed_);
  }

 private:
  void place(std::span<const PlacedBoard> boards) {
    placed_.clear();
    for (const PlacedBoard& one : boards)
      placed_.push_back({boards_.places_[one.board.index].slot, one.geometry, glm::dmat4(1.0),
                         one.object, one.from, one.to, std::nullopt});
  }

  AtlasBoards& boards_;
  std::vector<NailboardInstance> placed_;  // kept, so that drawing does not allocate
};

Result<std::unique_ptr<AtlasBoards>> AtlasBoards::create() {
  Result<NailboardAtlas> atlas =
      NailboardAtlas::create({.max_bytes = kBoardBytes, .delta_bits = 16, .samples = 1});
  if (!atlas) return atlas.error();
  Result<NailboardDrawer> drawer = NailboardDrawer::create(SampleRounding::nearest);
  if (!drawer) return drawer.error();
  return std::unique_ptr<AtlasBoards>(new AtlasBoards(std::move(*atlas), std::move(*drawer)));
}

bool AtlasBoards::is_there(const PrewarpedBoard& board) const {
  return board.index < places_.size() && places_[board.index].taken &&
         places_[board.index].generation == board.generation;
}

std::optional<PrewarpedBoard> AtlasBoards::place(int width, int height) {
  std::optional<AtlasSlot> slot = atlas_.allocate(width, height);
  while (!slot) {
    Place* oldest = nullptr;
    for (Place& place : places_)
      if (place.taken && place.used < now_ && (!oldest || place.used < oldest->used))
        oldest = &place;
    if (!oldest) return std::nullopt;
    atlas_.free(oldest->slot);
    oldest->taken = false;
    slot = atlas_.allocate(width, height);
  }
  std::uint32_t index = 0;
  while (index < places_.size() && places_[index].taken) ++index;
  if (index == places_.size()) places_.emplace_back();
  Place& place = places_[index];
  place = {*slot, place.generation + 1, now_, true};
  return PrewarpedBoard{index, place.generation};
}

bool AtlasBoards::use(const PrewarpedBoard& board) {
  if (!is_there(board)) return false;
  places_[board.index].used = now_;
  return true;
}

void AtlasBoards::release(const PrewarpedBoard& board) {
  if (!is_there(board)) return;
  atlas_.free(places_[board.index].slot);
  places_[board.index].taken = false;
}

void AtlasBoards::write(const PrewarpedBoard& board, const EncodedPiece& picture) {
  atlas_.write(places_[board.index].slot, picture.color, picture.picture);
}

void AtlasBoards::write(const PrewarpedBoard& board, const Prewarped& picture,
                        const PicturePiece& piece) {
  encode_prewarped(picture, piece, encoded_);
  write(board, encoded_);
}

void AtlasBoards::write_objects(const PrewarpedBoard& board,
                                std::span<const std::uint32_t> objects) {
  atlas_.write_objects(places_[board.index].slot, objects);
}

std::unique_ptr<BoardDrawer> AtlasBoards::make_drawer() { return std::make_unique<Drawer>(*this); }

}  // namespace rilievo
