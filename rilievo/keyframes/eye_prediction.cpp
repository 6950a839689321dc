#include "rilievo/keyframes/eye_prediction.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <utility>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

// The share of the last step in the mean: steps differ by as much as frames take.
constexpr double kNewest = 0.15;
// A step that is as many times longer than the mean is a jump; shorter than this share of the
// distance between the near plane and the eye it is none.
constexpr double kJump = 20, kLeastJump = 50;
constexpr double kJumpTurn = 0.7;  // radians
// A frame that takes long makes one long step: one counts as at most so many times the one before.
constexpr double kLongStep = 2;

glm::dvec3 rotation_between(const Camera& from, const Camera& to) {
  const glm::dmat3 turn =
      glm::dmat3(to.world_from_eye) * glm::transpose(glm::dmat3(from.world_from_eye));
  const glm::dquat q = glm::quat_cast(turn);
  const glm::dvec3 axis(q.x, q.y, q.z);
  const double sine = glm::length(axis);
  if (sine < 1e-12) return glm::dvec3(0);
  const double angle = 2 * std::atan2(sine, q.w);
  return axis / sine * (angle > glm::pi<double>() ? angle - 2 * glm::pi<double>() : angle);
}

// All of it after none.
glm::dvec3 shortened(const glm::dvec3& step, const glm::dvec3& before) {
  if (before == glm::dvec3(0)) return step;
  const double length = glm::length(step), most = kLongStep * glm::length(before);
  return length > most ? step * (most / length) : step;
}

}  // namespace

void EyePrediction::follow(const Camera& camera) {
  jumped_ = false;
  if (any_) {
    const glm::dvec3 step = camera.position() - last_.position();
    const glm::dvec3 turn = rotation_between(last_, camera);
    const double least = kLeastJump * camera.z_near;
    jumped_ = glm::length(step) > std::max(kJump * glm::length(step_), least) ||
              glm::length(turn) > kJumpTurn;
    const bool stands = step == glm::dvec3(0) && glm::length(turn) < 1e-9;
    const bool stood = std::exchange(stood_, stands), was_known = speed_known_;
    const bool stays = step_ == glm::dvec3(0) && turn_ == glm::dvec3(0);
    if (jumped_ || stands) {
      // An eye that stands does not drift on. But where frames come twice as often as the eye's
      // places, every second one stands.
      speed_known_ = jumped_ || stood || stays;
      step_ = turn_ = glm::dvec3(0);
      if (jumped_ || stood) last_step_ = last_turn_ = glm::dvec3(0);
    } else {
      // The first step says at least where the eye goes; the second one replaces it.
      speed_known_ = last_step_ != glm::dvec3(0) || last_turn_ != glm::dvec3(0);
      const double newest = stays || !was_known ? 1 : kNewest;
      step_ = glm::mix(step_, shortened(step, last_step_), newest);
      turn_ = glm::mix(turn_, shortened(turn, last_turn_), newest);
      last_step_ = step, last_turn_ = turn;
    }
  }
  any_ = true;
  last_ = camera;
}

double EyePrediction::turning_sideways() const {
  return std::abs(glm::dot(turn_, glm::dvec3(last_.world_from_eye[1])));
}
double EyePrediction::turning_upwards() const {
  return std::abs(glm::dot(turn_, glm::dvec3(last_.world_from_eye[0])));
}

Camera EyePrediction::after(double frames) const {
  RILIEVO_EXPECTS(any_);
  Camera camera = last_;
  glm::dmat3 axes(last_.world_from_eye);
  const double angle = glm::length(turn_);
  if (angle > 1e-9) {
    // Before now it turned as it does.
    const double turning =
        frames < 0 ? frames : kTurningFrames * (1 - std::exp(-frames / kTurningFrames));
    const double all = std::clamp(angle * turning, -kMostTurn, kMostTurn);
    axes = glm::mat3_cast(glm::angleAxis(all, turn_ / angle)) * axes;
    // Rigid, whatever rounding did.
    axes[2] = glm::normalize(axes[2]);
    axes[0] = glm::normalize(glm::cross(axes[1], axes[2]));
    axes[1] = glm::cross(axes[2], axes[0]);
  }
  camera.world_from_eye = glm::dmat4(axes);
  camera.world_from_eye[3] = glm::dvec4(last_.position() + frames * step_, 1);
  return camera;
}

}  // namespace rilievo
