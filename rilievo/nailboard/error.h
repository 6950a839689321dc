// How far from where it belongs is what a flat picture with depth shows, in a new frame?
//
// A picture's samples lie on the rays of its capture camera, between the distances of `slab`. All
// are drawn on one flat rectangle: the capture camera's image window on the plane eye_z = plane_z
// of its eye space. Delta moves a sample in the z-buffer only, along the frame's line of sight, not
// on the screen. So the screen position suffers from the flatness (parallax) and from the texels'
// size (magnification); the depth suffers from Delta's few bits and from the linear approximation
// of eq. (4) (S1.3).
//
// The object may have moved as a rigid body since the capture. Rounding of the GPU's floats is not
// counted. Pure, no allocation, any thread; about a microsecond.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/core/camera.h"
#include "rilievo/warp/parallax.h"

namespace rilievo {

// What the object did since the capture: world_now_from_world_then.
struct RigidMotion {
  glm::dmat4 now_from_then{1.0};
};

// Upper bounds over everything that the picture draws inside the frame, and over everything that it
// ought to draw there. Infinite where there is no bound: the eye in the picture's slab, a rectangle
// that the frame's near plane cuts, a motion that is not rigid (to 1e-4).
struct PictureError {
  // May any point of the capture's frustum lie in the frame? If not, nothing of the picture does,
  // neither as drawn nor as it should be, and all bounds are 0.
  bool in_frame = false;
  // Pixels between where a sample is drawn and where its true position projects, for every sample
  // with either of them in the frame: a sample that belongs into the frame is drawn there, or at
  // most so far beside it.
  double parallax_px = 0;
  // A pixel shows the texel in whose cell its centre falls: pixels from there to the texel's
  // centre, less the half diagonal of a pixel by which polygons are off too; 0 while texels are
  // smaller than pixels.
  double magnification_px = 0;
  // parallax_px + magnification_px. For every pixel centre q that shows a sample whose true
  // position projects to s, |q - s| <= total_px + sqrt(1/2).
  double total_px = 0;
  // |drawn - true| / true, of the distance along the frame's -z (eye_z) of a sample drawn in the
  // frame.
  double depth_relative = 0;
  // A surface point that the capture did not see because another hid it lies within so many pixels
  // of that other one, both at their true positions: how wide a strip the picture may lack.
  double disocclusion_px = 0;
};

// Requires perspective cameras that pass validate().
[[nodiscard]] PictureError bound_error(const PictureGeometry& picture, const Camera& frame,
                                       const RigidMotion& motion = {});

// Its total_px alone, for less: what a cache asks for every picture in every frame.
[[nodiscard]] double bound_total_px(const PictureGeometry& picture, const Camera& frame,
                                    const RigidMotion& motion = {});

}  // namespace rilievo
