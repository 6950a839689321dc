// The error of a flat picture with depth in a new frame: how far off it shows things, at most.
//
// A picture's samples lie on the rays of its capture camera, at distances within `slab`. All are
// drawn on one flat rectangle: the capture camera's image window on the plane eye_z = plane_z of
// its eye space. Delta moves a sample only in the z-buffer, along the frame's line of sight, not on
// the screen. So flatness (parallax) and texel size (magnification) affect the screen position; the
// few bits of Delta and the linear approximation of eq. (4) (S1.3) affect the depth.
//
// The object can have moved as a rigid body since the capture. Rounding errors of the GPU are not
// included. Pure, no allocation, any thread; about a microsecond.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/core/camera.h"
#include "rilievo/warp/parallax.h"

namespace rilievo {

// The motion of the object since the capture: world_now_from_world_then.
struct RigidMotion {
  glm::dmat4 now_from_then{1.0};
};

// Upper bounds over everything that the picture draws inside the frame or should draw there. They
// are infinite where there is no bound: for an eye in the picture's slab, a rectangle that
// intersects the frame's near plane, or a motion that is not rigid (to 1e-4).
struct PictureError {
  // Can any point of the capture's frustum lie in the frame? If not, all bounds are 0.
  bool in_frame = false;
  // The distance in pixels between where a sample is drawn and where its true position projects, if
  // either lies in the frame.
  double parallax_px = 0;
  // A pixel shows the texel in whose cell its centre falls. This is the distance in pixels from the
  // pixel's centre to the texel's centre, less half a pixel's diagonal (the error of polygons); 0
  // while texels are smaller than pixels.
  double magnification_px = 0;
  // A point is a disc that faces the eye, and a line is a pixel wide, but a picture shows them as
  // its own eye and texels had them. This is the distance in pixels of a sample from the same place
  // of the disc that faces the frame's eye, and how far a strip of texels reaches beyond one of
  // pixels.
  double stroke_px = 0;
  // parallax_px + magnification_px + stroke_px. For each pixel centre q that shows a sample whose
  // true position projects to s, |q - s| <= total_px + sqrt(1/2).
  double total_px = 0;
  // |drawn - true| / true of the eye_z in the frame of a sample drawn in the frame.
  double depth_relative = 0;
  // The width in pixels of the strip that the picture can be missing: a surface point that was
  // hidden at capture lies within this distance of the point that hid it, both at their true
  // positions.
  double disocclusion_px = 0;
};

// All bounds. Requires perspective cameras that pass validate().
[[nodiscard]] PictureError bound_error(const PictureGeometry& picture, const Camera& frame,
                                       const RigidMotion& motion = {});

// total_px alone, faster: a cache evaluates it for every picture in every frame.
[[nodiscard]] double bound_total_px(const PictureGeometry& picture, const Camera& frame,
                                    const RigidMotion& motion = {});

}  // namespace rilievo
