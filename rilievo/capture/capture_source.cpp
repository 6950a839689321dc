#include "rilievo/capture/capture_source.h"

#include <string>

#include "rilievo/render/placed_scene.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

Result<LayeredDepthImage> CaptureSource::capture_layers(const LayersRequest&) {
  return Error{std::string(name()), "shows nearest surfaces only, not those behind them"};
}

WorldSpace CaptureSource::world() const {
  const Scene* from = scene();
  return from ? from->world : WorldSpace{};
}

StrokeSize CaptureSource::stroke_size(std::span<const std::uint32_t> objects) const {
  const Scene* from = scene();
  return from ? PlacedScene(*from).stroke_size(objects) : StrokeSize{};
}

}  // namespace rilievo
