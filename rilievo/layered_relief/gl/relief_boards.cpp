#include "rilievo/layered_relief/gl/relief_boards.h"

#include <utility>

namespace rilievo {
namespace {

// Eight layers of a megatexel: a screen that is full of reliefs a few times over.
constexpr std::size_t kBytes = std::size_t(58) << 20;

}  // namespace

Result<ReliefBoards> ReliefBoards::create() {
  Result<NailboardAtlas> atlas =
      NailboardAtlas::create({.max_bytes = kBytes, .delta_bits = 16, .samples = 1});
  if (!atlas) return atlas.error();
  Result<NailboardDrawer> drawer = NailboardDrawer::create();
  if (!drawer) return drawer.error();
  return ReliefBoards(std::move(*atlas), std::move(*drawer));
}

bool ReliefBoards::is_there(const Board& board) const {
  return board.index < places_.size() && places_[board.index].taken &&
         places_[board.index].generation == board.generation;
}

std::optional<ReliefBoards::Board> ReliefBoards::place(int width, int height) {
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

bool ReliefBoards::use(const Board& board) {
  if (!is_there(board)) return false;
  places_[board.index].used = now_;
  return true;
}

void ReliefBoards::release(const Board& board) {
  if (!is_there(board)) return;
  atlas_.free(places_[board.index].slot);
  places_[board.index].taken = false;
}

}  // namespace rilievo
