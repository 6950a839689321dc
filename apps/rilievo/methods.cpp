#include "apps/rilievo/methods.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "apps/rilievo/builtin_methods.h"
#include "apps/rilievo/kind_sources.h"
#include "apps/rilievo/stored_sources.h"
#include "rilievo/cache/impostor_chooser.h"
#include "rilievo/representation/software/software_factories.h"

namespace rilievo::app {
namespace {

// Why software does not draw a kind; none for what is no kind.
std::optional<std::string> refused(const std::string& method) {
  const Kind* kind = kind_method(method).kind;
  if (!kind) return std::nullopt;
  const Result<std::unique_ptr<DrawableFactory>> factory =
      make_factory(software_drawable_rows(), kind->name);
  return factory ? std::nullopt : std::optional<std::string>(factory.error().reason);
}

// Does `automatic` draw a scene without OpenGL though there is one? `direct` is OpenGL's baseline,
// kinds are baked by OpenGL where there is one, and polygons that are presented by it do not bend.
bool chooses_software(const std::string& method, const MethodOptions& options, int samples) {
  if (options.draw != "automatic" || method == "direct" || kind_method(method).kind) return false;
  const Deformations* deformations = options.impostors.deformations;
  const bool bends = deformations && !deformations->meshes.empty() && method == "direct-raster";
  return (gl::is_software() || bends) && !needs_opengl(method, options, samples);
}

}  // namespace

const std::vector<std::string>& method_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const BuiltinMethod& method : builtin_methods()) all.emplace_back(method.name);
    for (std::string& name : kind_method_names()) all.push_back(std::move(name));
    return all;
  }();
  return names;
}

bool is_method(const std::string& name) {
  return kind_method(name).kind ||
         std::find(method_names().begin(), method_names().end(), name) != method_names().end();
}

bool bends_by_time(const std::string& method) {
  return method == kReliefImpostorName || method == "direct-raster";
}

CLI::Validator known_method() {
  return CLI::Validator(
      [](std::string& name) {
        return is_method(name)
                   ? std::string()
                   : fmt::format("'{}' is no method: {}", name, fmt::join(method_names(), ", "));
      },
      fmt::format("{{{}}}", fmt::join(method_names(), ",")));
}

Result<> expect_method_of(const Kind& kind, const std::string& method, const std::string& option) {
  if (kind_method(method).kind == &kind) return Done{};
  return Error{option, fmt::format("the file holds {}, which cannot be drawn as {}, only as {}",
                                   kind.name, method, fmt::join(kind_method_names(kind), " or "))};
}

std::optional<std::string> needs_opengl(const std::string& method, const MethodOptions& options,
                                        int samples) {
  if (auto reason = refused(method)) return reason;
  if (samples != 1 && samples != 4)
    return "frames drawn without OpenGL have 1 or 4 samples a pixel";
  if (options.bake_mb > 0 && method == "cache")
    for (const std::string& name : options.bake_as)
      if (auto reason = refused(name)) return reason;
  return std::nullopt;
}

Result<std::unique_ptr<gl::Context>> open_opengl(std::span<const std::string> methods, int samples,
                                                 MethodOptions& options) {
  std::unique_ptr<gl::Context> none;
  if (options.draw == "software") return none;
  Result<std::unique_ptr<gl::Context>> made = gl::Context::create();
  if (made || options.draw == "opengl") return made;
  for (const std::string& method : methods)
    if (needs_opengl(method, options, samples)) return made.error();
  options.draw = "software";
  return none;
}

Result<std::unique_ptr<FrameSource>> make_software_source(const std::string& method,
                                                          const MethodOptions& options, int samples,
                                                          const Scene& scene) {
  if (const auto reason = needs_opengl(method, options, samples)) return Error{"--draw", *reason};
  for (const BuiltinMethod& builtin : builtin_methods())
    if (method == builtin.name) return builtin.make_software(options, samples, scene);
  return make_software_kind(kind_method(method), options, samples, scene);
}

Result<std::unique_ptr<FrameSource>> make_source(const std::string& method,
                                                 const MethodOptions& options, int samples,
                                                 SceneRenderer& renderer) {
  if (options.draw == "software" || chooses_software(method, options, samples))
    return make_software_source(method, options, samples, renderer.scene());
  for (const BuiltinMethod& builtin : builtin_methods())
    if (method == builtin.name) return builtin.make(options, samples, renderer);
  return make_kind(kind_method(method), options, renderer);
}

Result<> make_renderer(const Scene& scene, std::optional<SceneRenderer>& renderer) {
  if (renderer) return Done{};
  Result<SceneRenderer> made = SceneRenderer::create(scene);
  if (!made) return made.error();
  renderer.emplace(std::move(*made));
  return Done{};
}

Result<std::unique_ptr<FrameSource>> make_scene_source(const std::string& method,
                                                       const MethodOptions& options, int samples,
                                                       const Scene& scene,
                                                       std::optional<SceneRenderer>& renderer) {
  if (options.draw == "software" || chooses_software(method, options, samples))
    return make_software_source(method, options, samples, scene);
  if (Result<> made = make_renderer(scene, renderer); !made) return made.error();
  return make_source(method, options, samples, *renderer);
}

Result<bool> draws_by_software(const std::string& method, const MethodOptions& options,
                               int samples) {
  const std::optional<std::string> reason = needs_opengl(method, options, samples);
  if (options.draw == "software" && reason) return Error{"--draw", *reason};
  return options.draw == "software" ||
         (options.draw == "automatic" && !reason && gl::is_software());
}

Result<std::unique_ptr<FrameSource>> make_file_source(
    const std::string& method, const MethodOptions& options, int samples,
    std::unique_ptr<Representation> representation, const Scene& sky,
    std::optional<SceneRenderer>& renderer) {
  const Result<bool> software = draws_by_software(method, options, samples);
  if (!software) return software.error();
  if (*software)
    return make_software_stored_source(method, options, samples, std::move(representation), sky);
  if (Result<> made = make_renderer(sky, renderer); !made) return made.error();
  return make_stored_source(method, options, std::move(representation), *renderer);
}

}  // namespace rilievo::app
