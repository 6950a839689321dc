// What a frame has to draw, and what each method would take for it by a model: guesses before any
// frame was drawn, which AutoDecision (auto_decision.h) replaces by what it measures.
#pragma once

namespace rilievo {

// A frame of so many pixels and triangles in view, on so many threads. Rays take 4 samples a pixel.
struct FrameLoad {
  double triangles = 0, pixels = 1;
  double level_triangles = 0;  // that levels of detail leave, about
  int threads = 1;
  bool masked = false;  // textures cut surfaces out, as leaves': rays go on through them
  double covered = 0;   // pixels in which objects may be seen, at most

  // The polygons are so few, for each pixel, that pixels take the time, and nothing can gain.
  static constexpr double kFits = 0.02;
  [[nodiscard]] bool fits() const { return triangles <= kFits * pixels; }
  // So few that no picture of an object costs less: it has as many texels. Levels may.
  static constexpr double kFew = 0.25;
  [[nodiscard]] bool few() const { return triangles <= kFew * pixels; }
  // Of what takes so many ms on the machine of these models.
  [[nodiscard]] double by_threads(double ms) const;
  [[nodiscard]] double direct_ms() const;
  // Direct drawing without triangles: no method takes much less.
  [[nodiscard]] double pixels_ms() const;
  [[nodiscard]] double levels_ms() const;
  [[nodiscard]] double rays_ms() const;
  // Without their share of direct drawing, which captures them and fills their holes.
  [[nodiscard]] double keyframes_ms() const;
  static constexpr double kKeyframesOfDirect = 0.13;
};

// `off` times as much as its model says a method was found to take, and has not drawn since: after
// one more frame. What one frame took beside the others may be other programs' work; what was
// `counted` is no one's, but of the place where the eye was.
[[nodiscard]] double remembered_off(double off, bool counted);

}  // namespace rilievo
