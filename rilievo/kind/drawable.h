// What can be drawn of a representation, many times over, and what does the cache need to know?
//
// A drawable is one representation, or a set of many of one kind (an atlas of nailboards, the nodes
// of an environment), ready to be drawn by one backend. Instances of it stand for objects of the
// scene. How wrong an instance is and what it costs are plain data, so that whoever plans a frame
// knows no kind by name.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "rilievo/core/bounds.h"
#include "rilievo/core/camera.h"
#include "rilievo/core/depth_image.h"

namespace rilievo {

// What drawing writes besides depth.
enum class Output {
  color,      // sRGB-encoded, premultiplied
  object_id,  // object identifiers; see Instance::object
};

struct Instance {
  // The rigid motion, or uniform scale, from the world in which the pictures were captured.
  glm::dmat4 world_from_capture{1.0};
  // Which member of the drawable's set; 0 where there is but one.
  std::uint32_t item = 0;
  // What Output::object_id writes; kNoObject: the identifiers captured with the pictures.
  std::uint32_t object = kNoObject;
  // Cross-fade range: drawn only where the pixel's hash lies in [from, to).
  float from = 0, to = 1;
  // Index among the instances of the one of which all other pixels are drawn, if there is one.
  std::optional<std::uint32_t> partner = {};
};

// How many pixels may an instance be off in a frame? Evaluated by a function of the kind over plain
// data, without allocation, in about a microsecond, on any thread.
struct ErrorModel {
  // Upper bound in pixels for the frame's camera; infinite where the instance must not be drawn.
  using Bound = double (*)(const ErrorModel&, const glm::dmat4& world_from_capture,
                           const Camera& frame);
  Bound bound = nullptr;
  Box bounds;        // of what is shown, world at capture
  double texel = 0;  // metres: the coarsest texel at the centre of the bounds

  [[nodiscard]] double bound_px(const glm::dmat4& world_from_capture, const Camera& frame) const {
    return bound ? bound(*this, world_from_capture, frame)
                 : std::numeric_limits<double>::infinity();
  }

  // The kind's own terms: any plain struct.
  template <typename Terms>
  void store(const Terms& terms) {
    static_assert(std::is_trivially_copyable_v<Terms> && sizeof(Terms) <= sizeof(terms_));
    std::memcpy(terms_.data(), &terms, sizeof(Terms));
  }
  template <typename Terms>
  [[nodiscard]] Terms load() const {
    static_assert(std::is_trivially_copyable_v<Terms> && sizeof(Terms) <= sizeof(terms_));
    Terms terms;
    std::memcpy(&terms, terms_.data(), sizeof(Terms));
    return terms;
  }

 private:
  std::array<std::byte, 384> terms_{};
};

// What drawing an instance costs, in triangles: how many the renderer draws in the same time.
struct CostTerms {
  double fixed = 0;
  double per_pixel = 0;  // of the rectangle around the instance
};

class Drawable {
 public:
  virtual ~Drawable() = default;

  // The kind's name: statistics are kept by it.
  [[nodiscard]] virtual std::string_view kind() const = 0;

  // Draws all instances into the backend's current target, with depth.
  virtual void draw(const Camera& frame, std::span<const Instance> instances, Output output) = 0;
  // Draws lines around the instances, hidden behind what has been drawn before (S1.8).
  virtual void draw_outlines(const Camera& frame, std::span<const Instance> instances) = 0;

  [[nodiscard]] virtual ErrorModel error_model(std::uint32_t item) const = 0;
  [[nodiscard]] virtual CostTerms cost_terms(std::uint32_t item) const = 0;
  // Memory that it takes to draw.
  [[nodiscard]] virtual std::size_t bytes() const = 0;

  // Appends how far from where they belong the instances show their samples, pixels; every
  // `step`-th texel in x and y. Slow. A kind that cannot tell appends nothing.
  virtual void append_errors(const Camera& /*frame*/, std::span<const Instance> /*instances*/,
                             int /*step*/, std::vector<float>& /*errors_px*/) const {}
  // The pictures that an instance is drawn from, if the kind keeps them.
  [[nodiscard]] virtual std::vector<DepthImage> read_pictures(const Instance& /*instance*/) const {
    return {};
  }
};

}  // namespace rilievo
