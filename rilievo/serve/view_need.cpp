#include "rilievo/serve/view_need.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace rilievo {
namespace {

// Things may have moved by this share of the frame's height.
constexpr double kDueShare = 1.0 / 15;
// Rays of the grid.
constexpr int kAcross = 11, kDown = 7;
// A view counts as covered if this share of its rays is.
constexpr double kCovered = 0.995, kMuchCovered = 0.6;
// A view this many times farther than a due one still shows the place.
constexpr double kUseful = 4;
// An eye moves if it needs fewer than so many seconds to where another view is due. It should then
// have a view ahead of it, and another one as soon as it has passed that by a share of what is due.
constexpr double kMoving = 1 / 20.0, kAhead = 2, kPassed = 0.1;
// A surround lasts so many times longer than a view.
constexpr double kSurroundLasts = 8;
// With a longer lead, in seconds, the surround comes before fine views and lasts half as long.
constexpr double kLongLead = 0.2, kSurroundFirst = 25;
constexpr double kFaceTangent = 1.02;

double distance(const Camera& a, const Camera& b) {
  return glm::length(a.position() - b.position());
}

bool same_view(const Camera& a, const Camera& b) {
  double most = 0;
  for (int c = 0; c < 3; ++c)
    most = std::max(most, glm::length(a.world_from_eye[c] - b.world_from_eye[c]));
  // An angle of a tenth of a pixel.
  return most < 1e-4 && distance(a, b) < 1e-2 * a.z_near;
}

}  // namespace

double covered_share(const Camera& frame, std::span<const Camera* const> views) {
  const glm::dmat3 world_from_eye(frame.world_from_eye);
  int covered = 0;
  for (int j = 0; j < kDown; ++j)
    for (int i = 0; i < kAcross; ++i) {
      const ImageWindow& w = frame.window;
      const double x = w.left + (w.right - w.left) * i / (kAcross - 1);
      const double y = w.bottom + (w.top - w.bottom) * j / (kDown - 1);
      const glm::dvec3 ray = world_from_eye * glm::dvec3(x, y, -1);
      covered += std::ranges::any_of(views, [&](const Camera* view) {
        const glm::dvec3 in = glm::transpose(glm::dmat3(view->world_from_eye)) * ray;
        if (!(in.z < 0)) return false;
        const double u = in.x / -in.z, v = in.y / -in.z;
        return view->window.left <= u && u <= view->window.right && view->window.bottom <= v &&
               v <= view->window.top;
      });
    }
  return covered / double(kAcross * kDown);
}

double due_distance(double typical_inverse_z, double cell, const Camera& frame) {
  if (cell > 0) return cell;
  const double moved = kDueShare * (frame.window.top - frame.window.bottom);
  return moved / std::max(typical_inverse_z, 1e-9);
}

ViewNeed view_need(std::span<const HeldPicture> held, const LivePose& arrival, const Camera& frame,
                   double cell, bool stands, double lead) {
  ViewNeed need;
  need.frame = frame;
  std::vector<const Camera*> near, useful;
  double nearest_share = HUGE_VAL;  // the distance of the nearest fine view, over what is due
  bool exact = false, ahead = false, moves = false;
  const double speed = glm::length(arrival.velocity);
  std::array<bool, 6> faces{};
  for (const HeldPicture& one : held) {
    const Camera& view = one.camera;
    const double due = due_distance(one.typical_inverse_z, cell, frame);
    const double share = distance(view, frame) / due;
    const int face = one.face;
    if (face >= 0) {
      // A cell of fixed size says nothing of how long the surround lasts.
      const double times = lead > kLongLead ? kSurroundLasts / 2 : kSurroundLasts;
      const double lasts = times * due_distance(one.typical_inverse_z, 0, frame);
      faces[std::size_t(face)] =
          faces[std::size_t(face)] || distance(view, frame) < std::max(lasts, times * cell);
      if (share < kUseful) useful.push_back(&view);
      continue;
    }
    if (share < kUseful) useful.push_back(&view);
    if (!one.fine) continue;
    if (share < 1) near.push_back(&view);
    // Only of those that show something of the frame.
    const Camera* const alone[] = {&view};
    if (covered_share(frame, alone) > 0.5) {
      nearest_share = std::min(nearest_share, share);
      moves = moves || speed > kMoving * due;
      const double along = glm::dot(view.position() - frame.position(), arrival.velocity);
      ahead = ahead || (share < kAhead && along > -kPassed * due * speed);
    }
    exact = exact || same_view(view, frame);
  }
  const double useful_share = covered_share(frame, useful);
  if (useful_share < kMuchCovered) {
    need.score = 40 * (2 - useful_share), need.wanted = Wanted::coarse_view;
    return need;
  }
  // The face that the eye looks at most is the first to be of use in a turn.
  std::optional<int> missing;
  double best = -2;
  for (int face = 0; face < 6; ++face) {
    if (faces[std::size_t(face)]) continue;
    const Camera side = surround_camera(arrival.eye, face, 1, 1, 2);
    const double facing = glm::dot(side.forward(), frame.forward());
    if (facing > best) best = facing, missing = face;
  }
  // An eye that stands looks where it will look, too.
  if (missing && lead > kLongLead && !stands && nearest_share < HUGE_VAL) {
    need.score = kSurroundFirst, need.wanted = Wanted::surround, need.face = *missing;
    return need;
  }
  const double near_share = covered_share(frame, near);
  if (near_share < kCovered || nearest_share > 1 || (moves && !ahead)) {
    need.score = 1 + 10 * (1 - near_share) + std::min(nearest_share, 10.0);
    return need;
  }
  if (stands && !exact) {
    need.score = 0.5, need.wanted = Wanted::exact_view;
    return need;
  }
  if (missing) need.score = 0.25, need.wanted = Wanted::surround, need.face = *missing;
  return need;
}

bool shows(const HeldPicture& picture, const Camera& frame, double cell, double margin) {
  const double due = due_distance(picture.typical_inverse_z, cell, frame);
  if (distance(picture.camera, frame) > margin * due) return false;
  const Camera* const alone[] = {&picture.camera};
  return covered_share(frame, alone) >= kCovered;
}

Camera surround_camera(const glm::dvec3& eye, int face, int texels, double z_near, double z_far) {
  glm::dvec3 forward(0.0), up(0.0, 1.0, 0.0);
  forward[face / 2] = face % 2 == 0 ? 1 : -1;
  if (face / 2 == 1) up = {0, 0, 1};
  Camera camera = look_at(eye, eye + forward, up, 1, texels, texels, z_near, z_far);
  camera.window = {-kFaceTangent, kFaceTangent, -kFaceTangent, kFaceTangent};
  return camera;
}

}  // namespace rilievo
