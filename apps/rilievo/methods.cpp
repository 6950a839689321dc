#include "apps/rilievo/methods.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <glm/glm.hpp>

#include "apps/rilievo/checks.h"
#include "apps/rilievo/progress.h"
#include "rilievo/cache/gl/image_cache.h"
#include "rilievo/cache/gl/picture_frames.h"
#include "rilievo/frame/gl/before_sky.h"
#include "rilievo/frame/gl/direct_frames.h"
#include "rilievo/frame/gl/layered_frames.h"
#include "rilievo/frame/gl/stored_layered.h"

namespace rilievo::app {
namespace {

LayeredOptions layered_options(const std::string& method, const MethodOptions& options) {
  LayeredOptions layered;
  if (method == "layered-slices" || options.warp == "slices")
    layered.method = LayeredMethod::slices;
  layered.outlines = options.outlines;
  return layered;
}

// What is baked before the first frame.
Result<ObjectImpostorOptions> impostor_options(const MethodOptions& options, Progress& progress) {
  Result<BakeOptions> bake = bake_options(options.bake);
  if (!bake) return bake.error();
  ObjectImpostorOptions impostors;
  impostors.bake = std::move(*bake);
  impostors.bake.progress = [&](int done, int total) { progress.show(done, total); };
  return impostors;
}

Result<> add_baked(ImageCache& cache, const MethodOptions& options, SceneRenderer& renderer) {
  Progress progress("view");
  Result<ObjectImpostorOptions> impostors = impostor_options(options, progress);
  if (!impostors) return impostors.error();
  const LayeredOptions layered = layered_options("cache", options);
  impostors->method = layered.method;
  impostors->max_bytes = std::size_t(options.bake_mb) << 20;
  Result<std::vector<ObjectImpostor>> baked = bake_object_impostors(renderer, *impostors);
  if (!baked) return baked.error();
  return cache.add_baked(std::move(*baked), layered);
}

}  // namespace

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
      ->check(in_range(0.0, 90.0))
      ->type_name("DEGREES");
  command.add_option("--memory-mb", options.memory_mb, "Memory for pictures (default 256)")
      ->check(in_range(1, 65536))
      ->type_name("MB");
  command
      .add_option("--error-px", options.error_px,
                  "cache: no sample is drawn farther from its place, pixels (default 1)")
      ->check(in_range(0.01, 100.0))
      ->type_name("E");
  command
      .add_option("--capture-ms", options.capture_ms,
                  "cache: time for captures in a frame (default: a budget of triangles instead, "
                  "which makes runs repeatable)")
      ->check(in_range(0.1, 1000.0))
      ->type_name("T");
  command
      .add_option("--bake-mb", options.bake_mb,
                  "cache: of its memory, so much is for layered impostors of heavy objects, baked "
                  "before the first frame; the light on what spins turns with it (default 0)")
      ->check(in_range(0, 65536))
      ->type_name("MB");
  command.add_flag("!--no-fade", options.fade, "cache: new pictures replace old ones at once");
  command
      .add_option(
          "--warp", options.warp,
          "cache, layered: walk through the pictures' surfaces, or draw their slices, which "
          "is layered-slices (default surfaces)")
      ->check(CLI::IsMember({"surfaces", "slices"}));
  command
      .add_option("--texel-px", options.texel_px,
                  "layered: objects whose texels would be larger are drawn as polygons (default 4)")
      ->check(in_range(0.01, 10000.0))
      ->type_name("PIXELS");
  add_layered_options(command, options.bake, "--view-size");
}

const std::vector<std::string>& method_names() {
  static const std::vector<std::string> names{"direct", "flat",    "nailboard",
                                              "cache",  "layered", "layered-slices"};
  return names;
}

const std::vector<std::string>& layered_method_names() {
  static const std::vector<std::string> names{"layered", "layered-slices"};
  return names;
}

Result<> expect_layered(const std::string& method, const std::string& option) {
  const std::vector<std::string>& names = layered_method_names();
  if (std::find(names.begin(), names.end(), method) != names.end()) return Done{};
  return Error{option, fmt::format("a layered impostor is not drawn as {}, but as {}", method,
                                   fmt::join(names, " or "))};
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
    if (options.bake_mb >= options.memory_mb)
      return Error{"--bake-mb", "must leave some of --memory-mb for pictures"};
    cache.max_bytes = std::size_t(options.memory_mb - options.bake_mb) << 20;
    cache.capture_ms = options.capture_ms;
    if (!options.fade) cache.fade_frames = 1;
    cache.delta_bits = options.delta_bits;
    cache.depth_mode = depth_mode(options);
    cache.samples = samples;
    cache.outlines = options.outlines;
    Result<ImageCache> made = ImageCache::create(renderer, cache);
    if (!made) return made.error();
    if (options.bake_mb > 0)
      if (Result<> added = add_baked(*made, options, renderer); !added) return added.error();
    return {std::make_unique<ImageCache>(std::move(*made))};
  }
  if (method == "layered" || method == "layered-slices") {
    Progress progress("view");
    Result<ObjectImpostorOptions> impostors = impostor_options(options, progress);
    if (!impostors) return impostors.error();
    LayeredFramesOptions layered;
    layered.impostors = std::move(*impostors);
    layered.impostors.max_bytes = std::size_t(options.memory_mb) << 20;
    layered.layered = layered_options(method, options);
    layered.max_texel_px = options.texel_px;
    Result<LayeredFrames> made = LayeredFrames::create(renderer, layered);
    if (!made) return made.error();
    return {std::make_unique<LayeredFrames>(std::move(*made))};
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

Result<std::unique_ptr<FrameSource>> make_layered_source(const std::string& method,
                                                         const MethodOptions& options,
                                                         LayeredImpostor impostor,
                                                         SceneRenderer& sky) {
  Result<StoredLayered> stored =
      StoredLayered::create(std::move(impostor), layered_options(method, options));
  if (!stored) return stored.error();
  return {std::make_unique<BeforeSky>(std::make_unique<StoredLayered>(std::move(*stored)), sky)};
}

}  // namespace rilievo::app
