// The pre-warp of the next frame, run beside the drawing of this one (S4, section 6: pipelined).
//
// It works where the next frame's camera is known: along a path, or predicted. Pictures are the
// same with and without, and after a wrong prediction. Where processors draw, both take all cores:
// measured on two, it gains nothing (`rilievo bench relief-run`), so that by default it is done
// from four cores on.
#pragma once

#include <functional>
#include <memory>

#include "rilievo/layered_relief/relief_set.h"

namespace rilievo::bench {

// When the next frame is warped beside the drawing.
enum class Overlap {
  never,
  automatic,  // on machines with at least four cores
  always,
};

// The pictures of a walk past a set of reliefs.
class PrewarpAhead {
 public:
  // `set` must outlive the object.
  explicit PrewarpAhead(const ReliefSet& set, const PrewarpOptions& options = {},
                        Overlap overlap = Overlap::automatic);
  ~PrewarpAhead();
  PrewarpAhead(PrewarpAhead&&) noexcept;
  PrewarpAhead& operator=(PrewarpAhead&&) noexcept;

  // Calls draw(picture) once, with what `camera` sees of the relief that pick_relief() selects; the
  // picture has no texels if there is none. Warps for `next` (null: not known) meanwhile. draw()
  // runs on any thread, so it must not need an OpenGL context; it may use parallel_for.
  void frame(const Camera& camera, const Camera* next,
             const std::function<void(const Prewarped& picture)>& draw);

  // The relief of the last frame's picture; -1: none.
  [[nodiscard]] int picked() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rilievo::bench
