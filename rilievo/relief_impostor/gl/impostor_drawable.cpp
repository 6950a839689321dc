#include "rilievo/relief_impostor/gl/impostor_drawable.h"

#include "rilievo/core/expects.h"

namespace rilievo {

Result<std::unique_ptr<ImpostorDrawable>> ImpostorDrawable::create(std::size_t impostors) {
  Result<PrewarpedBoards> boards = PrewarpedBoards::create();
  if (!boards) return boards.error();
  return std::unique_ptr<ImpostorDrawable>(new ImpostorDrawable(*std::move(boards), impostors));
}

bool ImpostorDrawable::show(std::size_t impostor, const ImpostorFrame& frame) {
  RILIEVO_EXPECTS(impostor < shown_.size() && frame.board && frame.encoded);
  Shown& shown = shown_[impostor];
  const bool there = shown.board && boards_.use(*shown.board);
  if (there && shown.number == frame.board_number) return true;
  const Prewarped& board = *frame.board;
  const Camera& before = shown.geometry.capture;
  if (!there || before.width != board.width() || before.height != board.height()) {
    if (there) boards_.release(*shown.board);
    shown.board = boards_.place(board.width(), board.height());
    if (!shown.board) return false;
  }
  boards_.atlas().write(boards_.slot(*shown.board), frame.encoded->color, frame.encoded->picture);
  shown.geometry = board.geometry;
  shown.number = frame.board_number;
  return true;
}

void ImpostorDrawable::place(std::span<const Instance> instances) {
  placed_.clear();
  for (const Instance& instance : instances) {
    const Shown& shown = shown_[instance.item];
    if (shown.board)
      placed_.push_back({boards_.slot(*shown.board),
                         placed(shown.geometry, instance.world_from_capture), glm::dmat4(1.0),
                         instance.object, instance.from, instance.to, std::nullopt});
  }
}

void ImpostorDrawable::draw(const Camera& frame, std::span<const Instance> instances,
                            Output output) {
  place(instances);
  if (output == Output::color)
    boards_.drawer().draw(boards_.atlas(), frame, DepthMode::exact, placed_);
  else
    boards_.drawer().draw_objects(boards_.atlas(), frame, DepthMode::exact, placed_);
}

void ImpostorDrawable::draw_outlines(const Camera& frame, std::span<const Instance> instances) {
  place(instances);
  boards_.drawer().draw_outlines(frame, placed_);
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
