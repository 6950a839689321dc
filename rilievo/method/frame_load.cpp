#include "rilievo/method/frame_load.h"

#include <algorithm>

namespace rilievo {
namespace {

// What was measured with kThreads threads (AVX-512, no GPU): direct-raster, direct-rays, keyframes.
constexpr int kThreads = 2;
constexpr double kDirectPixelMs = 18e-6, kDirectTriangleMs = 11e-6;
constexpr double kRaysPixelMs = 180e-6, kMaskedTimes = 4, kKeyframesPixelMs = 13e-6,
                 kKeyframesSkyMs = 8e-6;

// The share of a frame in what is forgotten of how far off a model is.
constexpr double kForgottenOfLook = 0.005, kForgottenOfCounted = 0.001;

}  // namespace

double FrameLoad::by_threads(double ms) const { return ms * kThreads / threads; }
double FrameLoad::pixels_ms() const { return by_threads(kDirectPixelMs * pixels); }
double FrameLoad::direct_ms() const {
  return pixels_ms() + by_threads(kDirectTriangleMs * triangles);
}
double FrameLoad::levels_ms() const {
  return pixels_ms() + by_threads(kDirectTriangleMs * level_triangles);
}
double FrameLoad::rays_ms() const {
  return (masked ? kMaskedTimes : 1) * by_threads(kRaysPixelMs * pixels);
}
double FrameLoad::keyframes_ms() const {
  const double things = std::min(covered, pixels);
  return by_threads(kKeyframesPixelMs * things + kKeyframesSkyMs * (pixels - things));
}

double remembered_off(double off, bool counted) {
  return off + std::min(1 - off, 0.0) * (counted ? kForgottenOfCounted : kForgottenOfLook);
}

}  // namespace rilievo
