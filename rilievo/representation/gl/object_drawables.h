// Representations that stand for single objects of a scene, wherever those are.
//
// Objects of one model whose poses differ by a translation share one: light is baked into it, and
// only a translation leaves the light where it was (the sun's, that is: lamps and their falloff
// move along). An object that is turned against another needs one of its own. An object that moves
// carries its representation along, and with it the light that it was baked in.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "rilievo/kind/kind.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo {

struct ObjectDrawable {
  std::unique_ptr<Drawable> drawable;
  std::vector<std::uint32_t> objects;   // indices into Scene::objects, ascending
  glm::dmat4 object_from_capture{1.0};  // the inverse of the pose at which it was baked
};

// The motion from the world of the bake to where an object with this pose is; nothing if it
// stretches.
[[nodiscard]] std::optional<glm::dmat4> motion_of(const ObjectDrawable& drawable,
                                                  const glm::mat4& pose);

struct ObjectDrawablesOptions {
  OptionValues bake, draw;                         // of the kind
  std::uint64_t min_triangles = 300;               // lighter objects get none
  std::size_t max_bytes = std::size_t(256) << 20;  // by DrawableFactory::expected_bytes; those that
                                                   // stand for most triangles come first
  Progress progress;                               // of all objects together
};

// Bakes at the renderer's time. An object that has nothing to take pictures of, or for which there
// is no memory left, gets none. `factory` must outlive them.
[[nodiscard]] Result<std::vector<ObjectDrawable>> bake_object_drawables(
    SceneRenderer& renderer, const Kind& kind, DrawableFactory& factory,
    const ObjectDrawablesOptions& options);

}  // namespace rilievo
