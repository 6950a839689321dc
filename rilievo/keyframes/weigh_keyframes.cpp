#include "rilievo/keyframes/weigh_keyframes.h"

#include <algorithm>

namespace rilievo {
namespace {

// How much less a coarse keyframe counts.
constexpr float kCoarseWeight = 1e-4f;
// A keyframe whose weight is a smaller share of the largest is spare.
constexpr float kSpareWeight = 0.4f;

}  // namespace

double eye_distance(const Keyframe& keyframe, const Camera& frame) {
  return glm::length(keyframe.camera.position() - frame.position());
}

float keyframe_weight(const Keyframe& keyframe, const Camera& frame, double sum) {
  const double near = 1 / (eye_distance(keyframe, frame) / std::max(sum, 1e-12) + 1e-3);
  return float(near * near) * (keyframe.coarse ? kCoarseWeight : 1.0f);
}

void spare_weak(std::span<WarpedKeyframe> keyframes) {
  float most = 0;
  for (const WarpedKeyframe& one : keyframes) most = std::max(most, one.weight);
  for (WarpedKeyframe& one : keyframes) {
    const float less = one.weight - kSpareWeight * most;
    one.spare = less <= 0;
    if (!one.spare) one.weight = less;
  }
}

}  // namespace rilievo
