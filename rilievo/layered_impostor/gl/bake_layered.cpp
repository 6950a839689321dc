#include "rilievo/layered_impostor/gl/bake_layered.h"

#include <fmt/format.h>

#include <numeric>
#include <utility>
#include <vector>

#include "rilievo/layered_impostor/warp.h"

namespace rilievo {

Result<LayeredImpostor> bake_layered(SceneRenderer& renderer,
                                     std::span<const std::uint32_t> objects,
                                     const BakeOptions& options) {
  Box bounds;
  for (const std::uint32_t object : objects)
    if (renderer.has_opaque_parts(object)) bounds.add(renderer.object_bounds(object));
  if (bounds.empty())
    return Error{renderer.scene().name, "there is nothing opaque to take pictures of"};
  const ViewSet set = make_view_set(options.views);
  const int total = int(set.directions.size());
  std::vector<DepthImage> pictures;
  for (int view = 0; view < total; ++view) {
    if (options.progress) options.progress(view, total);
    const Result<Camera> camera =
        view_camera(bounds, set.directions[std::size_t(view)], options.camera);
    if (!camera) return Error{renderer.scene().name, camera.error().message()};
    Result<DepthImage> picture =
        capture_picture(renderer, *camera, objects, {.samples = options.samples});
    if (!picture) return picture.error();
    picture->name = fmt::format("view {:02}", view);
    pictures.push_back(std::move(*picture));
  }
  if (options.progress) options.progress(total, total);
  Result<LayeredImpostor> impostor = make_layered_impostor(std::move(pictures), options.slicing);
  if (!impostor) return impostor;
  impostor->name = renderer.scene().name;
  if (options.fills) find_fill_slices(*impostor);
  return impostor;
}

Result<LayeredImpostor> bake_layered(SceneRenderer& renderer, const BakeOptions& options) {
  std::vector<std::uint32_t> all(renderer.scene().objects.size());
  std::iota(all.begin(), all.end(), 0u);
  return bake_layered(renderer, all, options);
}

}  // namespace rilievo
