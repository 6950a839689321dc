// What do rays show of a layered impostor? Internal to `layered_impostor/software`.
//
// By the rules of warp_surfaces() (layered_impostor/warp.h): the surfaces of the views that serve
// are marched through one after the other. Colours are encoded as frames are.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/core/image.h"
#include "rilievo/layered_impostor/layered_impostor.h"
#include "rilievo/layered_impostor/pixel_march.h"
#include "rilievo/layered_impostor/software/march_rays.h"
#include "rilievo/layered_impostor/software/placed_layered.h"

namespace rilievo {

// A raster position, and the stretch of eye_z along its ray that is looked at.
struct Gaze {
  glm::dvec2 at{0.0};
  double begin = 0, end = 1e300;
};

// The pictures of an impostor as rays look them up.
class LayeredRays {
 public:
  static constexpr int kCount = MarchRays::kCount;

  // Takes the texels of pictures and surfaces out of the impostor.
  explicit LayeredRays(LayeredImpostor& impostor);

  // What those gazes show whose bit is set. `first_decides`: of the views that know it the best one
  // alone is asked.
  void look(const PlacedLayered& placed, const std::array<Gaze, kCount>& gazes,
            std::uint32_t wanted, SeenLayered (&shown)[kCount], bool first_decides = false) const;

  // Of the texels.
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Picture {
    Camera camera;
    bool complete = false, sees_through = false;  // as LayeredImpostor's
    Image<glm::u8vec4> color;
    Image<std::uint32_t> object;  // empty if all show one
    MarchSurface surface;
  };
  struct Look;
  void find_order(const PlacedLayered& placed, Look& look) const;
  static double eye_z_at(const MarchedView& view, const MarchRays& rays, std::size_t ray,
                         const glm::dvec3& along, float t);
  // Where a ray ended; `along` is its direction as the view's picture has it.
  [[nodiscard]] SeenLayered seen_at(const PlacedLayered& placed, const MarchedView& view,
                                    const MarchRays& rays, std::size_t ray,
                                    const glm::dvec3& along) const;

  RayBounds bounds_;
  bool several_objects_ = false;
  std::vector<Picture> pictures_;
};

}  // namespace rilievo
