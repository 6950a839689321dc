#include "apps/rilievo/methods.h"

#include <glm/glm.hpp>

#include "rilievo/cache/image_cache.h"
#include "rilievo/cache/picture_frames.h"
#include "rilievo/draw/direct_frames.h"

namespace rilievo::app {

void add_method_options(CLI::App& command, MethodOptions& options) {
  command
      .add_option("--delta-bits", options.delta_bits,
                  "Bits of Delta, the pictures' depth (default 8)")
      ->check(CLI::IsMember({2, 4, 6, 8, 16}));
  command.add_option("--depth", options.depth, "How nailboards write depth (default exact)")
      ->check(CLI::IsMember({"exact", "linear"}));
  command.add_flag("--outlines", options.outlines, "Outline what is drawn from a picture");
  command
      .add_option(
          "--angle", options.angle_degrees,
          "A picture is captured again when its object has moved by this angle (default 0.7)")
      ->check(CLI::Range(0.0, 90.0))
      ->type_name("DEGREES");
  command.add_option("--memory-mb", options.memory_mb, "Memory for pictures (default 256)")
      ->check(CLI::Range(1, 65536))
      ->type_name("MB");
  command
      .add_option("--error-px", options.error_px,
                  "cache: no sample is drawn farther from its place, pixels (default 1)")
      ->check(CLI::Range(0.01, 100.0))
      ->type_name("E");
  command
      .add_option("--capture-ms", options.capture_ms,
                  "cache: time for captures in a frame (default: a budget of triangles instead, "
                  "which makes runs repeatable)")
      ->check(CLI::Range(0.1, 1000.0))
      ->type_name("T");
  command.add_flag("!--no-fade", options.fade, "cache: new pictures replace old ones at once");
}

const std::vector<std::string>& method_names() {
  static const std::vector<std::string> names{"direct", "flat", "nailboard", "cache"};
  return names;
}

DepthMode depth_mode(const MethodOptions& options) {
  return options.depth == "linear" ? DepthMode::linear : DepthMode::exact;
}

Result<std::unique_ptr<FrameSource>> make_source(const std::string& method,
                                                 const MethodOptions& options, int samples,
                                                 SceneRenderer& renderer) {
  if (method == "direct") return {std::make_unique<DirectFrames>(renderer)};
  if (method == "cache") {
    ImageCacheOptions cache;
    cache.error_px = options.error_px;
    cache.max_bytes = std::size_t(options.memory_mb) << 20;
    cache.capture_ms = options.capture_ms;
    if (!options.fade) cache.fade_frames = 1;
    cache.delta_bits = options.delta_bits;
    cache.depth_mode = depth_mode(options);
    cache.samples = samples;
    cache.outlines = options.outlines;
    Result<ImageCache> made = ImageCache::create(renderer, cache);
    if (!made) return made.error();
    return {std::make_unique<ImageCache>(std::move(*made))};
  }
  PictureFramesOptions pictures;
  pictures.mode = method == "flat" ? DepthMode::flat : depth_mode(options);
  pictures.delta_bits = options.delta_bits;
  pictures.max_angle = glm::radians(options.angle_degrees);
  pictures.outlines = options.outlines;
  pictures.max_bytes = std::size_t(options.memory_mb) << 20;
  pictures.samples = samples;
  Result<PictureFrames> made = PictureFrames::create(renderer, pictures);
  if (!made) return made.error();
  return {std::make_unique<PictureFrames>(std::move(*made))};
}

}  // namespace rilievo::app
