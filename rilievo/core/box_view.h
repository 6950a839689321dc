// Where does a box lie before an eye?
#pragma once

#include <algorithm>

#include "rilievo/core/bounds.h"
#include "rilievo/core/camera.h"

namespace rilievo {

// The rectangle around the corners of a box, on the plane z = -1 (parallel: in metres), and their
// distances along the view. It is right only if `nearest` is positive, or the view parallel.
struct BoxView {
  ImageWindow window{1e300, -1e300, 1e300, -1e300};
  double nearest = 1e300, farthest = -1e300;
};

// The view of a box, not empty, by an eye that looks along its -z.
[[nodiscard]] inline BoxView view_of_box(const glm::dmat4& eye_from_world, const Box& box,
                                         Projection projection) {
  BoxView view;
  for (const glm::vec3& corner : box.corners()) {
    const glm::dvec3 p(eye_from_world * glm::dvec4(corner, 1));
    const double scale = projection == Projection::parallel ? 1.0 : 1.0 / -p.z;
    view.nearest = std::min(view.nearest, -p.z), view.farthest = std::max(view.farthest, -p.z);
    view.window.left = std::min(view.window.left, p.x * scale);
    view.window.right = std::max(view.window.right, p.x * scale);
    view.window.bottom = std::min(view.window.bottom, p.y * scale);
    view.window.top = std::max(view.window.top, p.y * scale);
  }
  return view;
}

// A rectangle of a picture, in raster space.
struct RasterRect {
  double left = 0, top = 0, right = 0, bottom = 0;
  [[nodiscard]] bool empty() const { return !(right > left && bottom > top); }
};

// The rectangle of a perspective camera's picture in which a box appears, by its view; all of it if
// the box reaches the near plane.
[[nodiscard]] inline RasterRect rect_of_box(const Camera& camera, const BoxView& view) {
  RasterRect rect{0, 0, double(camera.width), double(camera.height)};
  if (!(view.nearest > camera.z_near)) return rect;
  const ImageWindow& w = camera.window;
  const double across = camera.width / (w.right - w.left),
               down = camera.height / (w.top - w.bottom);
  rect.left = std::max(rect.left, (view.window.left - w.left) * across);
  rect.right = std::min(rect.right, (view.window.right - w.left) * across);
  rect.top = std::max(rect.top, (w.top - view.window.top) * down);
  rect.bottom = std::min(rect.bottom, (w.top - view.window.bottom) * down);
  return rect;
}

}  // namespace rilievo
