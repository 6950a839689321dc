#include "rilievo/relief_impostor/impostor_drawable.h"

#include "rilievo/core/expects.h"

namespace rilievo {

bool ImpostorDrawable::show(std::size_t impostor, const ImpostorFrame& frame) {
  RILIEVO_EXPECTS(impostor < shown_.size() && frame.board && frame.encoded);
  Shown& shown = shown_[impostor];
  const bool there = shown.board && boards_->use(*shown.board);
  if (there && shown.number == frame.board_number) return true;
  const Prewarped& board = *frame.board;
  const Camera& before = shown.geometry.capture;
  if (!there || before.width != board.width() || before.height != board.height()) {
    if (there) boards_->release(*shown.board);
    shown.board = boards_->place(board.width(), board.height());
    if (!shown.board) return false;
  }
  boards_->write(*shown.board, *frame.encoded);
  shown.geometry = board.geometry;
  shown.number = frame.board_number;
  return true;
}

void ImpostorDrawable::place(std::span<const Instance> instances) {
  placed_.clear();
  for (const Instance& instance : instances) {
    const Shown& shown = shown_[instance.item];
    if (shown.board)
      placed_.push_back({*shown.board, placed(shown.geometry, instance.world_from_capture),
                         instance.object, instance.from, instance.to});
  }
}

void ImpostorDrawable::draw(const Camera& frame, std::span<const Instance> instances,
                            Output output) {
  place(instances);
  drawer_->draw(frame, placed_, output);
}

void ImpostorDrawable::draw_outlines(const Camera& frame, std::span<const Instance> instances) {
  place(instances);
  drawer_->draw_outlines(frame, placed_);
}

std::size_t ImpostorDrawable::bytes() const {
  std::size_t sum = 0;
  for (const Shown& shown : shown_)
    if (shown.board)
      sum += 6 * std::size_t(shown.geometry.capture.width) *
             std::size_t(shown.geometry.capture.height);
  return sum;
}

}  // namespace rilievo
