// How is content without triangles captured? By sphere tracing of signed distances (S5.8).
//
// A capture source: the second software shader. The library's shading under the default sun and
// sky, with hard shadows. Progressive (refine_picture.h). One object; cameras of all kinds.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/capture/capture_source.h"
#include "rilievo/capture/shaders/distance_field.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// A field placed in the world, and how it looks.
struct FieldLook {
  glm::dvec3 center{0.0};  // world space
  double scale = 1;        // metres that a unit of the field is long
  glm::vec3 base_color{0.75f, 0.55f, 0.35f};
  float roughness = 0.5f, metallic = 0.0f;
};

// A distance field as a capture source.
class FieldShader final : public CaptureSource {
 public:
  explicit FieldShader(const DistanceField& field, const FieldLook& look = {})
      : field_(field), look_(look), sun_(default_sun()) {}

  [[nodiscard]] std::string_view name() const override { return field_.name; }
  [[nodiscard]] Box bounds(std::span<const std::uint32_t> objects) const override;
  // As refine_picture(). Requires that no objects are named but 0.
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override;

 private:
  DistanceField field_;
  FieldLook look_;
  Light sun_;
};

}  // namespace rilievo
