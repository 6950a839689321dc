#include "rilievo/capture/capture_source.h"

#include <string>

namespace rilievo {

Result<LayeredDepthImage> CaptureSource::capture_layers(const LayersRequest&) {
  return Error{std::string(name()), "shows nearest surfaces only, not those behind them"};
}

}  // namespace rilievo
