// How does a picture get better while it is made? Texel by texel, coarse first (S5.5).
//
// The order in which software shaders of single rays fill a picture: one texel in 64, in 16, in 4,
// all of them, then 4, 16, ... samples of each. With several samples, silhouettes are antialiased
// on both sides: a texel whose centre shows nothing has the colours and the coverage of its
// samples, with the depth of the first that shows something, if its neighbour's centre or one of
// its first four samples shows something: a cable that is thinner than a texel stays in one piece.
// The picture depends neither on the number of threads nor on whether somebody looks at the coarse
// ones.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string_view>

#include "rilievo/capture/capture_source.h"

namespace rilievo {

// What the rays of one picture see. Called by any number of threads at once.
class RayShader {
 public:
  // What a texel shows.
  struct Seen {
    float eye_z = 0;
    std::uint32_t object = 1;
  };

  virtual ~RayShader() = default;
  // What the ray of a raster position sees.
  [[nodiscard]] virtual std::optional<Seen> nearest(const glm::dvec2& raster) const = 0;
  // eye_z of the last surface along it; kNoDepth: none.
  [[nodiscard]] virtual float farthest(const glm::dvec2& raster) const = 0;
  // Linear light at a place of texel (x, y), from its *lower* left corner; premultiplied. `sample`:
  // its index in the texel.
  [[nodiscard]] virtual glm::vec4 light(int x, int y, const glm::dvec2& place,
                                        int sample) const = 0;
};

// Makes the picture of a request; obeys request.control. Takes 1 to 4096 samples a texel: 1 and 4
// lie where they lie in every other source. Fails for an invalid camera, and with_sky. `name`: of
// the source.
[[nodiscard]] Result<CapturedPicture> refine_picture(const RayShader& shader,
                                                     const CaptureRequest& request,
                                                     std::string_view name);

}  // namespace rilievo
