#include "rilievo/relief_impostor/impostor_state.h"

#include <algorithm>

namespace rilievo {

ImpostorStep next_step(const ImpostorSituation& now, const ImpostorLimits& limits) {
  ImpostorStep step;
  const ImpostorShown otherwise = now.drawable ? ImpostorShown::object : ImpostorShown::nothing;
  const bool usable = now.picture && now.stretch <= std::numeric_limits<double>::max();
  const bool good = usable && !now.empty && (now.stretch <= limits.drop || !now.drawable);

  // What is seen: wrong by its eye, or because it has deformed, which no warp mends.
  const double off_px = std::max(now.moved_px, now.shown_deformed_px);
  if (!good || !now.warped)
    step.shown = otherwise;
  else if (off_px <= limits.still_px)
    step.shown = ImpostorShown::fresh;
  else if (off_px <= limits.stale_px || !now.drawable)
    step.shown = ImpostorShown::stale;
  else
    step.shown = otherwise;
  // Content without triangles: an old warp is better than nothing.
  if (!now.drawable && now.warped && !now.empty && step.shown == ImpostorShown::nothing)
    step.shown = ImpostorShown::stale;

  // A picture is warped whenever that changes a pixel.
  step.order_warp = good && !now.warping && (!now.warped || now.moved_px > limits.still_px);

  // A picture is rendered if there is none that will do, or a better one can be had.
  const bool wanted =
      !now.empty && (!usable || now.deformed_px > limits.still_px ||
                     std::max(now.stretch, now.later_stretch) > limits.refresh || !now.final);
  const bool serves = now.rendering && now.rendered_stretch <= std::max(limits.refresh, 1.0);
  // What is on its way is given up only if the one that is there is bad and it would be no better.
  step.cancel_render =
      now.rendering && !serves && wanted && (!usable || now.rendered_stretch > now.stretch);
  step.order_render = wanted && (!now.rendering || step.cancel_render);
  return step;
}

double render_priority(const ImpostorSituation& now) {
  if (!now.picture) return now.drawable ? 1e6 : 2e6;
  return std::min(now.stretch, 1e5) + (now.final ? 0.0 : 0.5);
}

}  // namespace rilievo
