#include "rilievo/cache/plan/eye_motion.h"

#include <algorithm>
#include <cmath>

namespace rilievo {
namespace {

// The rotation vector of a rigid map: its axis times its angle.
glm::dvec3 rotation_vector(const glm::dmat3& m) {
  // The antisymmetric part is sin(angle) times the axis, the trace 1 + 2 cos(angle).
  const glm::dvec3 axis = 0.5 * glm::dvec3(m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0]);
  const double sine = glm::length(axis), cosine = 0.5 * (m[0][0] + m[1][1] + m[2][2] - 1);
  // A half turn in one frame has no direction, and no turn has none either.
  return sine > 1e-12 ? axis / sine * std::atan2(sine, cosine) : glm::dvec3(0);
}

// By how many times a motion may become faster or slower from frame to frame.
constexpr double kMostGrowth = 8;

// More than a frame that took longer explains, or an eye that starts to walk. What goes on for two
// frames, within 60 degrees of the same direction, is a motion, and so is the first.
bool jumps(const glm::dvec3& now, const glm::dvec3& before, double longest) {
  const double length = glm::length(now), length_before = glm::length(before);
  if (longest <= 0 || length <= kMostGrowth * longest || length_before > kMostGrowth * length)
    return false;
  return length > kMostGrowth * length_before ||
         glm::dot(now, before) < 0.5 * length * length_before;
}

// An eye that stood has jumped if its first turn is larger, radians.
constexpr double kFirstTurn = 0.5;

// `now`, no longer than `before`.
glm::dvec3 no_longer(const glm::dvec3& now, const glm::dvec3& before) {
  const double length = glm::length(now);
  return length > 0 ? now * std::min(1.0, glm::length(before) / length) : now;
}

}  // namespace

FrameView follow(EyeMotion& motion, const Camera& camera) {
  FrameView view;
  view.camera = camera;
  if (motion.frames > 0) {
    const glm::dvec3 step = camera.position() - motion.last.position();
    const glm::dvec3 turn = rotation_vector(glm::dmat3(camera.world_from_eye) *
                                            glm::transpose(glm::dmat3(motion.last.world_from_eye)));
    // The first step has nothing to be compared with.
    view.velocity = motion.frames > 1 ? no_longer(step, motion.step) : step;
    view.turn = motion.frames > 1 ? no_longer(turn, motion.turn) : turn;
    view.step = glm::length(step);
    view.started = motion.longest_step == 0 && motion.longest_turn == 0 &&
                   (view.step > 0 || glm::length(turn) > 0);
    view.jumped = motion.frames > 1 && (jumps(step, motion.step, motion.longest_step) ||
                                        jumps(turn, motion.turn, motion.longest_turn) ||
                                        (view.started && glm::length(turn) > kFirstTurn));
    motion.step = step, motion.turn = turn;
    if (!view.jumped) {
      motion.longest_step = std::max(motion.longest_step, glm::length(step));
      motion.longest_turn = std::max(motion.longest_turn, glm::length(turn));
    }
  }
  motion.last = camera;
  ++motion.frames;
  return view;
}

}  // namespace rilievo
