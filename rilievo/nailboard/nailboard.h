// The nailboard: a picture with depth on one flat polygon (S1.1 to S1.4).
//
// The polygon is the picture's window on the plane eye_z == plane_z in front of the capturing eye.
// Its texels hold colour and Delta: window_z of the picture's own tight frustum in few bits. Drawn
// from another eye, a texel lands where the polygon is, with the depth of the surface it shows.
#pragma once

#include <cstdint>

#include "rilievo/core/color.h"
#include "rilievo/core/depth_image.h"
#include "rilievo/core/picture_geometry.h"

namespace rilievo {

// window_z in `frame` of the point that texel position `raster` of the picture shows at `delta` in
// [0, 1]. The picture is where it was captured; to draw an object that has moved since, move the
// frame's camera against it.
[[nodiscard]] double exact_depth(const PictureGeometry& picture, const Camera& frame,
                                 const glm::dvec2& raster, double delta);

// Eq. (4) at the same place: z_N and z_F belong to the points where the line of sight through the
// polygon at `raster` meets the picture's near and far planes.
[[nodiscard]] double linear_depth(const PictureGeometry& picture, const Camera& frame,
                                  const glm::dvec2& raster, double delta);

// The polygon's own depth there.
[[nodiscard]] double flat_depth(const PictureGeometry& picture, const Camera& frame,
                                const glm::dvec2& raster);

// What the GPU holds, as bytes. Colours are sRGB-encoded, then multiplied by alpha (= coverage), so
// that they can be interpolated and go into a frame as they are.
struct Nailboard {
  PictureGeometry geometry;
  Rgba8Image color;
  // Codes; delta_transparent(bits) where there is nothing. An empty texel beside others has the
  // nearest one's depth: their colours, interpolated, reach into it.
  Image<std::uint16_t> delta;
};

[[nodiscard]] Nailboard make_nailboard(const DepthImage& picture, int delta_bits);

// And back: linear colour that rounds to the same bytes, eye_z that encodes to the same codes.
[[nodiscard]] DepthImage depth_image_from(const Nailboard& nailboard);

}  // namespace rilievo
