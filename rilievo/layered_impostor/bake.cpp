#include "rilievo/layered_impostor/bake.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "rilievo/layered_impostor/warp.h"

namespace rilievo {

Result<LayeredImpostor> bake_layered(CaptureSource& source, std::span<const std::uint32_t> objects,
                                     const BakeOptions& options) {
  const std::string name(source.name());
  const Box bounds = source.bounds(objects);
  if (bounds.empty()) return Error{name, "there is nothing opaque to capture"};
  const ViewSet set = make_view_set(options.views);
  const int total = int(set.directions.size());
  std::vector<DepthImage> pictures;
  for (int view = 0; view < total; ++view) {
    if (options.progress) options.progress(view, total);
    const Result<Camera> camera =
        view_camera(bounds, set.directions[std::size_t(view)], options.camera);
    if (!camera) return Error{name, camera.error().message()};
    Result<CapturedPicture> captured =
        source.capture({.camera = *camera, .objects = objects, .samples = options.samples});
    if (!captured) return captured.error();
    captured->picture.name = fmt::format("view {:02}", view);
    pictures.push_back(std::move(captured->picture));
  }
  if (options.progress) options.progress(total, total);
  Result<LayeredImpostor> impostor = make_layered_impostor(std::move(pictures), options.slicing);
  if (!impostor) return impostor;
  impostor->name = name;
  impostor->strokes = source.stroke_size(objects);
  if (options.fills) find_fill_slices(*impostor);
  return impostor;
}

}  // namespace rilievo
