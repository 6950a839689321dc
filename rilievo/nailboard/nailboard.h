// A nailboard: a picture with depth on one flat polygon (S1.1 to S1.4).
//
// The polygon is the picture's window on the plane eye_z == plane_z in front of the capture eye.
// Its texels hold colour and Delta: window_z of the picture's own tight frustum in few bits. Drawn
// from another eye, a texel appears where the polygon is, with the depth of the surface that it
// shows.
#pragma once

#include <cstdint>

#include "rilievo/core/color.h"
#include "rilievo/core/depth_image.h"
#include "rilievo/core/picture_geometry.h"

namespace rilievo {

// The window_z in `frame` of the point that the picture shows at texel position `raster` with Delta
// `delta` in [0, 1]. The picture stays where it was captured; for an object that has moved since,
// move the frame's camera the opposite way.
[[nodiscard]] double exact_depth(const PictureGeometry& picture, const Camera& frame,
                                 const glm::dvec2& raster, double delta);

// The same by eq. (4): z_N and z_F are the depths of the points where the line of sight through the
// polygon at `raster` meets the picture's near and far planes.
[[nodiscard]] double linear_depth(const PictureGeometry& picture, const Camera& frame,
                                  const glm::dvec2& raster, double delta);

// The window_z of the polygon itself at `raster`.
[[nodiscard]] double flat_depth(const PictureGeometry& picture, const Camera& frame,
                                const glm::dvec2& raster);

// A nailboard as stored on the GPU. Colours are sRGB-encoded, then multiplied by alpha (=
// coverage), so that they can be interpolated and written into a frame without conversion.
struct Nailboard {
  PictureGeometry geometry;
  Rgba8Image color;
  // Codes; delta_transparent(bits) where the picture shows nothing. An empty texel with covered
  // neighbours has the depth of the nearest one, because colours are interpolated into it.
  Image<std::uint16_t> delta;
};

// Encodes a perspective picture with `delta_bits` bits (2 to 16) of Delta.
[[nodiscard]] Nailboard make_nailboard(const DepthImage& picture, int delta_bits);

// Decodes a nailboard: linear colours and eye_z that encode to the same bytes and codes.
[[nodiscard]] DepthImage depth_image_from(const Nailboard& nailboard);

}  // namespace rilievo
