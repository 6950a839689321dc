// The list of methods, and what makes each.
#include <algorithm>
#include <glm/glm.hpp>
#include <utility>

#include "rilievo/capture/shaders/software_shader.h"
#include "rilievo/core/idle_thread.h"
#include "rilievo/frame/software/software_frames.h"
#include "rilievo/keyframes/software/keyframe_frames.h"
#include "rilievo/method/auto.h"
#include "rilievo/method/cached.h"
#include "rilievo/method/direct.h"
#include "rilievo/method/kinds.h"
#include "rilievo/method/levels.h"
#include "rilievo/method/method.h"
#include "rilievo/method/pictures.h"
#include "rilievo/relief_impostor/impostor_drawable.h"
#include "rilievo/render/rays/ray_visibility.h"

namespace rilievo {
namespace {

using Frames = Result<std::unique_ptr<FrameSource>>;

Result<Method> as_method(Frames frames) {
  if (!frames) return frames.error();
  Method method;
  method.frames = std::move(*frames);
  return method;
}

bool bends(const Backend& backend) {
  return backend.deformations() && !backend.deformations()->meshes.empty();
}

Result<Method> make_raster(const MethodOptions&, Backend& backend) {
  Result<SoftwareBackend*> software = backend.software();
  if (!software) return software.error();
  return as_method(backend.present(
      std::make_unique<SoftwareFrames>(**software, std::make_unique<DirectChooser>())));
}

Result<Method> make_direct(const MethodOptions& options, Backend& backend) {
  // OpenGL's polygons do not bend.
  if (bends(backend)) return make_raster(options, backend);
  return as_method(backend.make_frames(std::make_unique<DirectChooser>()));
}

Result<Method> make_rays(const MethodOptions&, Backend& backend) {
  Result<SoftwareBackend*> software = backend.software();
  if (!software) return software.error();
  Result<std::unique_ptr<RayVisibility>> rays = RayVisibility::create((*software)->scene());
  if (!rays) return rays.error();
  return as_method(backend.present(std::make_unique<SoftwareFrames>(
      **software, std::make_unique<DirectChooser>(), std::move(*rays))));
}

Result<Method> make_levels(const MethodOptions& options, Backend& backend) {
  return as_method(
      make_level_frames(backend, make_object_levels(backend.scene()), options.error_px));
}

Result<Method> make_pictures(DepthMode mode, const MethodOptions& options, Backend& backend) {
  PictureFramesOptions pictures;
  pictures.mode = mode;
  pictures.delta_bits = options.delta_bits;
  pictures.max_angle = glm::radians(options.angle_degrees);
  pictures.outlines = options.outlines;
  pictures.max_bytes = std::size_t(options.memory_mb) << 20;
  pictures.samples = backend.samples();
  Frames frames = make_picture_frames(backend, pictures);
  if (!frames && backend.drawn_by() == DrawnBy::software)
    return Error{"--memory-mb", frames.error().reason};
  return as_method(std::move(frames));
}
Result<Method> make_flat(const MethodOptions& options, Backend& backend) {
  return make_pictures(DepthMode::flat, options, backend);
}
Result<Method> make_nailboards(const MethodOptions& options, Backend& backend) {
  return make_pictures(options.depth_mode, options, backend);
}

Result<Method> make_keyframes(const MethodOptions& options, Backend& backend) {
  Result<SoftwareBackend*> software = backend.software();
  if (!software) return software.error();
  KeyframeFramesOptions keyframes;
  keyframes.by = options.source == "rays" ? KeyframesBy::rays : KeyframesBy::raster;
  keyframes.samples = backend.samples();
  if (options.gap_px > 0) keyframes.gap_px = options.gap_px;
  keyframes.keyframes.samples = options.keyframe_samples;
  keyframes.keyframes.keyframe_ms = options.keyframe_ms;
  if (options.by_clock && options.keyframe_ms == 0 && !is_slow_source(options.source))
    take_usual_time(keyframes);
  KeyframeFrames::MakeSource make;
  if (Result<> known = check_source(options.source); !known)
    return Error{"--source", known.error().message()};
  if (is_slow_source(options.source)) {
    // It takes long. Frames wait for it where time does not count. A program has a sky of its own.
    keyframes.keyframes.beside = options.by_clock;
    if (program_named(options.source).empty()) keyframes.keyframes.sky = &(*software)->scene().sky;
    make = [&](const RayScene& rays) {
      ShaderInput input;
      input.rays = &rays;
      input.exec.world = rays.scene().world;
      if (!options.program_scene.empty()) input.exec.arguments = {options.program_scene};
      if (options.by_clock) input.exec.nice = kIdleNice;
      input.exec.warn = options.warn;
      input.exec.waits = options.waits;
      return make_slow_source(options.source, input);
    };
  }
  Result<std::unique_ptr<KeyframePainter>> painter = backend.make_keyframe_painter();
  if (!painter) return painter.error();
  Result<std::unique_ptr<KeyframeFrames>> made =
      KeyframeFrames::create((*software)->scene(), make, keyframes, std::move(*painter));
  if (!made) return made.error();
  return as_method(std::unique_ptr<FrameSource>(std::move(*made)));
}

}  // namespace

std::span<const MethodRow> methods() {
  static constexpr MethodRow kMethods[] = {
      {"direct", make_direct, false, true},
      {"direct-raster", make_raster, true, true},
      {"direct-rays", make_rays},
      {"lod", make_levels},
      {"flat", make_flat},
      {"nailboard", make_nailboards},
      {"cache", make_cached_method},
      {"keyframes", make_keyframes},
      {kAutoName, make_auto, true, true},
      {kReliefImpostorName, make_relief_impostors, true, true},
  };
  return kMethods;
}

const MethodRow* find_method(std::span<const MethodRow> rows, std::string_view name) {
  const auto found = std::find_if(rows.begin(), rows.end(),
                                  [&](const MethodRow& row) { return row.name == name; });
  return found == rows.end() ? nullptr : &*found;
}

std::vector<std::string> method_names() {
  std::vector<std::string> names;
  for (const MethodRow& row : methods()) names.emplace_back(row.name);
  for (std::string& name : kind_method_names()) names.push_back(std::move(name));
  return names;
}

std::string cannot_bend(std::string_view name) {
  std::string others;
  for (const MethodRow& row : methods())
    if (row.bends) others += (others.empty() ? "" : ", ") + std::string(row.name);
  return std::string(name) +
         " does not bend skins and morph targets by time, as this scene does: " + others + " do";
}

Result<Method> make_method(std::span<const MethodRow> rows, std::string_view name,
                           const MethodOptions& options, Backend& backend) {
  const MethodRow* row = find_method(rows, name);
  const KindMethod kind = kind_method(name);
  if (!row && !kind.kind) return Error{std::string(name), "is no method"};
  if (bends(backend) && !(row && row->bends)) return Error{std::string(name), cannot_bend(name)};
  if (row) return row->make(options, backend);
  return make_kind_method(kind, options, backend);
}

Result<Method> make_method(std::string_view name, const MethodOptions& options, Backend& backend) {
  return make_method(methods(), name, options, backend);
}

}  // namespace rilievo
