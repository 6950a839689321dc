// How are relief impostors drawn? As nailboards, which background workers have warped already.
//
// The frame hands what is new to the boards and draws it; warping and encoding are not its work.
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "rilievo/kind/drawable.h"
#include "rilievo/nailboard/prewarped_boards.h"
#include "rilievo/relief_impostor/impostor_workers.h"

namespace rilievo {

// The name of the method, and in statistics.
inline constexpr std::string_view kReliefImpostorName = "relief-impostor";

// The impostors of a scene; Instance::item tells them from each other.
class ImpostorDrawable final : public Drawable {
 public:
  // Draws from `boards`, which decide on the backend.
  ImpostorDrawable(std::unique_ptr<PrewarpedBoards> boards, std::size_t impostors)
      : boards_(std::move(boards)), drawer_(boards_->make_drawer()), shown_(impostors) {}

  // Before the show() calls of a frame.
  void begin() { boards_->begin(); }
  // Takes what a frame shows of an impostor: from now on it is drawn. False if there is no room for
  // it. Requires frame.board.
  [[nodiscard]] bool show(std::size_t impostor, const ImpostorFrame& frame);

  [[nodiscard]] std::string_view kind() const override { return kReliefImpostorName; }
  // Draws those instances whose impostors have been shown.
  void draw(const Camera& frame, std::span<const Instance> instances, Output output) override;
  void draw_outlines(const Camera& frame, std::span<const Instance> instances) override;
  [[nodiscard]] const TileDrawer* tiles() const override { return drawer_->tiles(); }
  [[nodiscard]] const TileDrawer* outline_tiles() const override {
    return drawer_->outline_tiles();
  }
  // Nobody plans with them.
  [[nodiscard]] ErrorModel error_model(std::uint32_t) const override { return {}; }
  [[nodiscard]] CostTerms cost_terms(std::uint32_t) const override { return {}; }
  [[nodiscard]] std::size_t bytes() const override;

 private:
  void place(std::span<const Instance> instances);

  struct Shown {
    std::optional<PrewarpedBoard> board;
    PictureGeometry geometry;  // at capture
    std::uint64_t number = 0;
  };
  std::unique_ptr<PrewarpedBoards> boards_;
  std::unique_ptr<BoardDrawer> drawer_;
  std::vector<Shown> shown_;
  std::vector<PlacedBoard> placed_;  // kept, so that drawing does not allocate
};

}  // namespace rilievo
