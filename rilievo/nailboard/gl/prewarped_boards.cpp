#include "rilievo/nailboard/gl/prewarped_boards.h"

#include <utility>

namespace rilievo {
namespace {

// Eight layers of a megatexel: a screen that is full of reliefs a few times over.
constexpr std::size_t kBoardBytes = std::size_t(58) << 20;

}  // namespace

Result<PrewarpedBoards> PrewarpedBoards::create() {
  Result<NailboardAtlas> atlas =
      NailboardAtlas::create({.max_bytes = kBoardBytes, .delta_bits = 16, .samples = 1});
  if (!atlas) return atlas.error();
  Result<NailboardDrawer> drawer = NailboardDrawer::create();
  if (!drawer) return drawer.error();
  return PrewarpedBoards(std::move(*atlas), std::move(*drawer));
}

bool PrewarpedBoards::is_there(const Board& board) const {
  return board.index < places_.size() && places_[board.index].taken &&
         places_[board.index].generation == board.generation;
}

std::optional<PrewarpedBoards::Board> PrewarpedBoards::place(int width, int height) {
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
  return Board{index, place.generation};
}

bool PrewarpedBoards::use(const Board& board) {
  if (!is_there(board)) return false;
  places_[board.index].used = now_;
  return true;
}

void PrewarpedBoards::release(const Board& board) {
  if (!is_there(board)) return;
  atlas_.free(places_[board.index].slot);
  places_[board.index].taken = false;
}

}  // namespace rilievo
