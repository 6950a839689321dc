// What have both ways in common of drawing layered impostors without OpenGL, by surfaces and by
// slices? Internal to `layered_impostor/software`.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <utility>

#include "rilievo/kind/drawable.h"
#include "rilievo/layered_impostor/draw_options.h"
#include "rilievo/layered_impostor/drawable_terms.h"
#include "rilievo/layered_impostor/layered_impostor.h"
#include "rilievo/layered_impostor/layered_kind.h"
#include "rilievo/layered_impostor/picture_textures.h"
#include "rilievo/render/software/frame_tile.h"
#include "rilievo/render/software/line_tiles.h"

namespace rilievo {

// A premultiplied, encoded colour as tiles hold it, opaque.
[[nodiscard]] inline std::uint32_t opaque_content(const glm::vec4& color) {
  std::uint32_t content = 0xff000000u;
  for (int c = 0; c < 3; ++c)
    content |=
        std::uint32_t(std::clamp(color[c] / std::max(color.a, 1e-3f), 0.0f, 1.0f) * 255.0f + 0.5f)
        << (8 * c);
  return content;
}

// Does a sample of a pixel show what covers the pixel by `alpha`? The nearest number of the four
// samples does (SampleRounding::nearest).
[[nodiscard]] inline bool covers_sample(float alpha, int sample) {
  return sample < int(4 * alpha + 0.5f);
}

// Knows the impostor; who derives from it keeps its texels as it draws them, and draws.
class ImpostorTiles : public Drawable, public TileDrawer {
 public:
  [[nodiscard]] std::string_view kind() const final { return kLayeredImpostorName; }
  void draw_outlines(const Camera& frame, std::span<const Instance> instances) final {
    outlines_.begin(frame);
    for (const Instance& instance : instances)
      outlines_.add_box(glm::dvec3(impostor_.bounds.min), glm::dvec3(impostor_.bounds.max),
                        instance.world_from_capture);
  }
  [[nodiscard]] const TileDrawer* tiles() const final { return this; }
  [[nodiscard]] const TileDrawer* outline_tiles() const final { return &outlines_; }

  [[nodiscard]] ErrorModel error_model(std::uint32_t) const final { return error_; }
  [[nodiscard]] CostTerms cost_terms(std::uint32_t) const final { return cost_; }
  [[nodiscard]] std::size_t bytes() const final { return bytes_; }

 protected:
  ImpostorTiles(LayeredImpostor impostor, const LayeredOptions& options)
      : impostor_(std::move(impostor)),
        options_(options),
        objects_(shown_objects(impostor_.pictures)),
        error_(layered_error_model(impostor_, options)),
        cost_(layered_cost_terms(impostor_, options.method)) {}

  LayeredImpostor impostor_;  // without the texels that are kept apart
  LayeredOptions options_;
  ShownObjects objects_;
  std::size_t bytes_ = 0;  // of the texels

 private:
  ErrorModel error_;
  CostTerms cost_;
  LineTiles outlines_;
};

}  // namespace rilievo
