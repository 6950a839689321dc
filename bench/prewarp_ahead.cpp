#include "bench/prewarp_ahead.h"

#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "rilievo/core/parallel_for.h"

namespace rilievo::bench {
namespace {

constexpr unsigned kLeastCores = 4;

// A picture, and what it was warped for.
struct Ahead {
  Prewarped picture;
  std::optional<Camera> camera;
  int after = -1;  // the relief that was shown before
  int picked = -1;
};

}  // namespace

struct PrewarpAhead::State {
  const ReliefSet& set;
  bool beside;
  std::vector<Prewarp> prewarps;
  Ahead now, next;

  void warp(const Camera& camera, int after, Ahead& to) {
    to.camera = camera;
    to.after = after;
    to.picked = pick_relief(set, camera.position(), after);
    if (to.picked < 0 ||
        !prewarps[std::size_t(to.picked)].warp(camera.position(), &camera, to.picture)) {
      to.picture.color.clear();
      to.picture.delta.clear();
    }
  }
};

PrewarpAhead::PrewarpAhead(const ReliefSet& set, const PrewarpOptions& options, Overlap overlap)
    : state_(new State{
          set,
          overlap == Overlap::always ||
              (overlap == Overlap::automatic && std::thread::hardware_concurrency() >= kLeastCores),
          {},
          {},
          {}}) {
  for (const LayeredRelief& relief : set.reliefs) state_->prewarps.emplace_back(relief, options);
}
PrewarpAhead::~PrewarpAhead() = default;
PrewarpAhead::PrewarpAhead(PrewarpAhead&&) noexcept = default;
PrewarpAhead& PrewarpAhead::operator=(PrewarpAhead&&) noexcept = default;

int PrewarpAhead::picked() const { return state_->now.picked; }

void PrewarpAhead::frame(const Camera& camera, const Camera* next,
                         const std::function<void(const Prewarped& picture)>& draw) {
  State& s = *state_;
  const int before = s.now.picked;
  if (s.next.camera == camera && s.next.after == before)
    std::swap(s.now, s.next);
  else
    s.warp(camera, before, s.now);
  s.next.camera.reset();
  if (!s.beside || !next) {
    draw(s.now.picture);
    return;
  }
  parallel_for(0, 2, [&](int which) {
    if (which == 0)
      draw(s.now.picture);
    else
      s.warp(*next, s.now.picked, s.next);
  });
}

}  // namespace rilievo::bench
