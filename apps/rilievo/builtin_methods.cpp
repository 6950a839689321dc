#include "apps/rilievo/builtin_methods.h"

#include <glm/glm.hpp>
#include <utility>

#include "apps/rilievo/cache_source.h"
#include "rilievo/cache/gl/picture_frames.h"
#include "rilievo/cache/impostor_chooser.h"
#include "rilievo/cache/software/software_picture_frames.h"
#include "rilievo/frame/gl/level_frames.h"
#include "rilievo/frame/gl/processor_frames.h"
#include "rilievo/frame/software/software_frames.h"
#include "rilievo/frame/software/software_level_frames.h"
#include "rilievo/render/raster/raster_renderer.h"
#include "rilievo/render/rays/ray_renderer.h"
#include "rilievo/render/rays/ray_visibility.h"

namespace rilievo::app {
namespace {

using Source = Result<std::unique_ptr<FrameSource>>;

Source make_direct(const MethodOptions&, int, SceneRenderer& renderer) {
  return {std::make_unique<DirectFrames>(renderer)};
}

// What processors draw, presented by OpenGL.
Source make_presented(std::unique_ptr<FrameRenderer> processor, int samples,
                      SceneRenderer& renderer) {
  Result<std::unique_ptr<ProcessorFrames>> made =
      ProcessorFrames::create(renderer, std::move(processor), samples);
  if (!made) return made.error();
  return {std::move(*made)};
}

Source make_raster(const MethodOptions&, int samples, SceneRenderer& renderer) {
  return make_presented(std::make_unique<RasterRenderer>(renderer.scene()), samples, renderer);
}
Source make_software_raster(const MethodOptions& options, int samples, const Scene& scene) {
  return {std::make_unique<SoftwareDirectFrames>(scene, samples, options.impostors.deformations)};
}

Source make_rays(const MethodOptions&, int samples, SceneRenderer& renderer) {
  Result<std::unique_ptr<RayRenderer>> rays = RayRenderer::create(renderer.scene());
  if (!rays) return rays.error();
  return make_presented(std::move(*rays), samples, renderer);
}
Source make_software_rays(const MethodOptions&, int samples, const Scene& scene) {
  Result<std::unique_ptr<RayVisibility>> rays = RayVisibility::create(scene);
  if (!rays) return rays.error();
  return {std::make_unique<SoftwareDirectFrames>(scene, samples, std::move(*rays))};
}

Source make_levels(const MethodOptions& options, int, SceneRenderer& renderer) {
  Result<std::unique_ptr<LevelFrames>> made =
      LevelFrames::create(make_object_levels(renderer.scene()), options.error_px);
  if (!made) return made.error();
  return {std::move(*made)};
}
Source make_software_levels(const MethodOptions& options, int samples, const Scene& scene) {
  return {SoftwareLevelFrames::create(make_object_levels(scene), samples, options.error_px)};
}

PictureFramesOptions pictures_options(DepthMode mode, const MethodOptions& options, int samples) {
  PictureFramesOptions pictures;
  pictures.mode = mode;
  pictures.delta_bits = options.delta_bits;
  pictures.max_angle = glm::radians(options.angle_degrees);
  pictures.outlines = options.outlines;
  pictures.max_bytes = std::size_t(options.memory_mb) * kMegabyte;
  pictures.samples = samples;
  return pictures;
}

Source make_pictures(const PictureFramesOptions& options, SceneRenderer& renderer) {
  Result<PictureFrames> made = PictureFrames::create(renderer, options);
  if (!made) return made.error();
  return {std::make_unique<PictureFrames>(std::move(*made))};
}
Source make_software_pictures(const PictureFramesOptions& options, const Scene& scene) {
  Result<std::unique_ptr<SoftwareChosenFrames>> made = make_software_picture_frames(scene, options);
  if (!made) return Error{"--memory-mb", made.error().reason};
  return {std::move(*made)};
}

Source make_flat(const MethodOptions& options, int samples, SceneRenderer& renderer) {
  return make_pictures(pictures_options(DepthMode::flat, options, samples), renderer);
}
Source make_software_flat(const MethodOptions& options, int samples, const Scene& scene) {
  return make_software_pictures(pictures_options(DepthMode::flat, options, samples), scene);
}

Source make_nailboards(const MethodOptions& options, int samples, SceneRenderer& renderer) {
  return make_pictures(pictures_options(depth_mode(options), options, samples), renderer);
}
Source make_software_nailboards(const MethodOptions& options, int samples, const Scene& scene) {
  return make_software_pictures(pictures_options(depth_mode(options), options, samples), scene);
}

Source make_impostors(const MethodOptions& options, int, SceneRenderer& renderer) {
  return make_impostor_frames(options.impostors, options.outlines, renderer);
}
Source make_software_impostors(const MethodOptions& options, int samples, const Scene& scene) {
  return make_software_impostor_frames(options.impostors, options.outlines, samples, scene);
}

}  // namespace

std::span<const BuiltinMethod> builtin_methods() {
  static constexpr BuiltinMethod kMethods[] = {
      {"direct", make_direct, make_software_raster},
      {"direct-raster", make_raster, make_software_raster},
      {"direct-rays", make_rays, make_software_rays},
      {"lod", make_levels, make_software_levels},
      {"flat", make_flat, make_software_flat},
      {"nailboard", make_nailboards, make_software_nailboards},
      {"cache", make_cache, make_software_cache},
      {kReliefImpostorName.data(), make_impostors, make_software_impostors},
  };
  return kMethods;
}

}  // namespace rilievo::app
