// A drawable draws a representation, in many instances, and tells the cache its error and its cost.
//
// A drawable is one representation, or a set of many of one kind (an atlas of nailboards, the nodes
// of an environment), ready to be drawn by one backend. Its instances stand for objects of the
// scene. The error and the cost of an instance are plain data, so that code that plans a frame
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

class TileDrawer;
struct Sky;

// The output of drawing besides depth.
enum class Output {
  color,      // sRGB-encoded, premultiplied
  object_id,  // object identifiers; see Instance::object
};

// One placed copy of a drawable, or of an item of it.
struct Instance {
  // Placement relative to the world at capture: a rigid motion, or a uniform scale.
  glm::dmat4 world_from_capture{1.0};
  // The member of the drawable's set; 0 if there is only one.
  std::uint32_t item = 0;
  // The identifier that Output::object_id writes. kNoObject: those captured with the pictures.
  std::uint32_t object = kNoObject;
  // Cross-fade range: drawn only where the pixel's hash lies in [from, to).
  float from = 0, to = 1;
  // The index of the instance that is drawn at all other pixels, if there is one.
  std::optional<std::uint32_t> partner = {};
};

// The identifier that Output::object_id writes for an instance whose pictures show one object,
// `only`, or name none (kNoObject).
[[nodiscard]] inline std::uint32_t object_of(const Instance& instance, std::uint32_t only) {
  return instance.object != kNoObject ? instance.object : only;
}

// An upper bound of an instance's error in a frame. The kind's own function evaluates it, on any
// thread. Most functions read plain data, do not allocate, and take about a microsecond. That of
// environment nodes asks the drawable, which must outlive the model: it allocates, takes a lock,
// and takes some ten microseconds a node, or tens of milliseconds if a node must be loaded first.
struct ErrorModel {
  // The bound in pixels of the frame; infinite if the instance must not be drawn.
  using Bound = double (*)(const ErrorModel&, const glm::dmat4& world_from_capture,
                           const Camera& frame);
  Bound bound = nullptr;
  // An upper bound of the width of cracks, in pixels, beside the error; null: there are none.
  Bound gap = nullptr;
  Box bounds;        // of what is shown, world space at capture
  double texel = 0;  // the coarsest texel at the centre of the bounds, metres

  // The bound; infinite for a model without a function.
  [[nodiscard]] double bound_px(const glm::dmat4& world_from_capture, const Camera& frame) const {
    return bound ? bound(*this, world_from_capture, frame)
                 : std::numeric_limits<double>::infinity();
  }

  // The bound of cracks.
  [[nodiscard]] double gap_px(const glm::dmat4& world_from_capture, const Camera& frame) const {
    return gap ? gap(*this, world_from_capture, frame) : 0;
  }

  // Stores the kind's own terms, a trivially copyable struct.
  template <typename Terms>
  void store(const Terms& terms) {
    static_assert(std::is_trivially_copyable_v<Terms> && sizeof(Terms) <= sizeof(terms_));
    std::memcpy(terms_.data(), &terms, sizeof(Terms));
  }
  // The terms stored; `Terms` must be the type that was stored.
  template <typename Terms>
  [[nodiscard]] Terms load() const {
    static_assert(std::is_trivially_copyable_v<Terms> && sizeof(Terms) <= sizeof(terms_));
    Terms terms;
    std::memcpy(&terms, terms_.data(), sizeof(Terms));
    return terms;
  }

 private:
  std::array<std::byte, 576> terms_{};
};

// The cost of drawing an instance. Work is in triangles that take 280 ns each, as those of the
// machine that the defaults of the cache were measured on (cache/plan/policy.h).
struct CostTerms {
  double fixed = 0;      // work
  double per_pixel = 0;  // work, of the rectangle around the instance on the screen
  double triangles = 0;  // the number that is drawn as such, whatever one takes
};

// A representation, or a set of them, ready to be drawn.
class Drawable {
 public:
  virtual ~Drawable() = default;

  // The kind's name; statistics are kept by name.
  [[nodiscard]] virtual std::string_view kind() const = 0;

  // Draws all instances, with depth, into the backend's current target.
  virtual void draw(const Camera& frame, std::span<const Instance> instances, Output output) = 0;
  // Draws outlines of the instances, with depth test (S1.8).
  virtual void draw_outlines(const Camera& frame, std::span<const Instance> instances) = 0;

  // Drawables without OpenGL: draw() and draw_outlines() only place the instances. This draws them
  // into the tiles of a SoftwareTarget; it lives as long as the drawable. Null: with OpenGL; and
  // for outlines, if there are none.
  [[nodiscard]] virtual const TileDrawer* tiles() const { return nullptr; }
  [[nodiscard]] virtual const TileDrawer* outline_tiles() const { return nullptr; }
  // The samples of a pixel in the frames of colours that follow, 1 or 4; for such drawables.
  virtual void set_samples(int /*samples*/) {}

  // The error and the cost of an item.
  [[nodiscard]] virtual ErrorModel error_model(std::uint32_t item) const = 0;
  [[nodiscard]] virtual CostTerms cost_terms(std::uint32_t item) const = 0;
  // The memory that it takes to draw, bytes.
  [[nodiscard]] virtual std::size_t bytes() const = 0;

  // The sky around what it shows, for directions in which its pictures show nothing; null: it knows
  // none. Lives as long as the drawable.
  [[nodiscard]] virtual const Sky* sky() const { return nullptr; }

  // The pictures from which an instance is drawn, if the kind keeps them.
  [[nodiscard]] virtual std::vector<DepthImage> read_pictures(const Instance& /*instance*/) const {
    return {};
  }
};

}  // namespace rilievo
