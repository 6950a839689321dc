// The picture that a client needs next, and how urgently.
//
// Plain functions of what it holds and of where its eye will be. A ray of the frame is *covered* by
// a view whose window it passes through; a view is *near* if the eye has moved so little that what
// it typically shows has moved less than the limit.
#pragma once

#include <cstdint>
#include <span>

#include "rilievo/serve/message.h"

namespace rilievo {

// The share of a grid of the frame's rays that pass through the window of any of these views.
[[nodiscard]] double covered_share(const Camera& frame, std::span<const Camera* const> views);

// The eye's distance from a view's after which another is due. `typical_inverse_z`: what most
// things in the view do not exceed; `cell` is what was asked for, or 0.
[[nodiscard]] double due_distance(double typical_inverse_z, double cell, const Camera& frame);

// What to make.
enum class Wanted { coarse_view, fine_view, exact_view, surround };
struct ViewNeed {
  double score = 0;  // the larger the more urgent; 0: nothing is needed
  Wanted wanted = Wanted::fine_view;
  Camera frame;  // for which
  int face = 0;  // of the surround
};

// A picture that a client holds, or will soon.
struct HeldPicture {
  std::uint64_t id = 0;
  Camera camera;
  double typical_inverse_z = 0;
  bool fine = false;
  int face = -1;  // of a surround; -1: a view
};

// `arrival` is the pose when a picture made now is seen, in `lead` seconds; `stands`: the eye does
// not move. The longer the lead, the less certain is where the eye will look: then the surround
// comes before the next fine view, and lasts less long.
[[nodiscard]] ViewNeed view_need(std::span<const HeldPicture> held, const LivePose& arrival,
                                 const Camera& frame, double cell, bool stands, double lead = 0);

// Does this picture show a frame so well that none need be made? `margin` 0 to 1: the share of what
// is due by which its eye may be off.
[[nodiscard]] bool shows(const HeldPicture& picture, const Camera& frame, double cell,
                         double margin);

// The camera of a surround's face at an eye: +x, -x, +y, -y, +z, -z of the world.
[[nodiscard]] Camera surround_camera(const glm::dvec3& eye, int face, int texels, double z_near,
                                     double z_far);

}  // namespace rilievo
