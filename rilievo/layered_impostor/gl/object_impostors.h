// Layered impostors that stand for single objects of a scene, wherever those are.
//
// Objects of one model whose poses differ by a translation share an impostor: light is baked into
// it, and only a translation leaves the light where it was (the sun's, that is: lamps and their
// falloff move along). An object that is turned against another needs pictures of its own. An
// object that moves carries its impostor along, and with it the light that it was baked in.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "rilievo/layered_impostor/error.h"
#include "rilievo/layered_impostor/gl/bake_layered.h"
#include "rilievo/layered_impostor/gl/layered_pictures.h"

namespace rilievo {

struct ObjectImpostor {
  LayeredPictures pictures;
  LayeredErrorFigures error;
  // Of the texels that show something, the share at whose edges the surface ends: next to nothing
  // for a ball, a tenth for a teapot, a quarter for a tree. The walk goes on behind each.
  double raggedness = 0;
  std::vector<std::uint32_t> objects{};  // indices into Scene::objects, ascending
  glm::dmat4 object_from_impostor{1.0};  // the inverse of the pose that it was baked at
};

// The motion from the world of the baking to where the object is: LayeredInstance's. Nothing if it
// stretches.
[[nodiscard]] std::optional<glm::dmat4> motion_of(const ObjectImpostor& impostor,
                                                  const glm::mat4& pose);

struct ObjectImpostorOptions {
  // `fills` is decided by the way they are drawn; `progress` counts the views of all impostors.
  BakeOptions bake;
  LayeredMethod method = LayeredMethod::surfaces;
  std::uint64_t min_triangles = 300;               // lighter objects get none
  std::size_t max_bytes = std::size_t(256) << 20;  // of texture memory; the impostors that stand
                                                   // for most triangles come first
};

// Bakes at the renderer's time, ready to draw by `method` alone. An object that has nothing to take
// pictures of, or for which there is no memory left, gets none.
[[nodiscard]] Result<std::vector<ObjectImpostor>> bake_object_impostors(
    SceneRenderer& renderer, const ObjectImpostorOptions& options);

}  // namespace rilievo
