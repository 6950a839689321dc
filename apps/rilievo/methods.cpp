#include "apps/rilievo/methods.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <utility>

#include "apps/rilievo/draw_speed.h"
#include "apps/rilievo/output.h"
#include "apps/rilievo/progress.h"
#include "rilievo/frame/software/software_backend.h"
#include "rilievo/method/auto.h"
#include "rilievo/method/relief_impostors.h"
#include "rilievo/representation/software/software_factories.h"

namespace rilievo::app {
namespace {

// The pixels of a frame, about: who is faster hardly depends on it.
constexpr double kFramePixels = 1280 * 720;

// Why software does not draw a kind; none for what is no kind.
std::optional<std::string> refused(const std::string& method) {
  const Kind* kind = kind_method(method).kind;
  if (!kind) return std::nullopt;
  const Result<std::unique_ptr<DrawableFactory>> factory =
      make_factory(software_drawable_rows(), kind->name);
  return factory ? std::nullopt : std::optional<std::string>(factory.error().reason);
}

// With what the library reports while a method is made.
template <typename Make>
Result<Method> with_reports(const MethodOptions& options, const Make& make) {
  Progress progress("view");
  rilievo::MethodOptions with = options;
  with.progress = [&](int done, int total) { progress.show(done, total); };
  with.warn = [](const std::string& text) { complain("warning: " + text); };
  with.waits = waiting_for(options.source);
  with.note = [&](const std::string& text) {
    progress.clear();
    complain(text);
  };
  return make(with);
}

}  // namespace

bool is_method(const std::string& name) {
  return kind_method(name).kind || find_method(methods(), name);
}

std::string default_method(const MethodOptions& options) {
  return options.bake_mb > 0 || options.levels ? "cache" : std::string(kAutoName);
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

Result<bool> Stage::draws_by_software(const MethodOptions& options) const {
  if (options.draw != "automatic") return options.draw == "software";
  return software_is_faster(double(count_triangles(scene_)), kFramePixels, options.machine);
}

// A presented frame's samples, deformations and pictures are the backend's.
Result<Backend*> Stage::backend(bool software) {
  std::unique_ptr<Backend>& made = software ? software_ : opengl_;
  if (made) return made.get();
  if (software) {
    made = std::make_unique<SoftwareBackend>(scene_, samples_, deformations_);
    return made.get();
  }
  if (!renderer_) {
    Result<SceneRenderer> renderer = SceneRenderer::create(scene_);
    if (!renderer) return renderer.error();
    renderer_.emplace(std::move(*renderer));
  }
  made = std::make_unique<OpenGLBackend>(*renderer_, samples_, deformations_);
  return made.get();
}

Result<Method> Stage::make(const std::string& method, const MethodOptions& options) {
  const MethodRow* row = find_method(methods(), method);
  if (deformations_ && !deformations_->meshes.empty() && !(row && row->bends))
    return Error{"--method", cannot_bend(method) + "; --time poses them"};
  const std::optional<std::string> reason = needs_opengl(method, options, samples_);
  if (options.draw == "software" && reason) return Error{"--draw", *reason};
  // Kinds are baked by OpenGL where there is one.
  const Result<bool> software = row && row->software_first && !reason ? draws_by_software(options)
                                                                      : options.draw == "software";
  if (!software) return software.error();
  const Result<Backend*> backend = this->backend(*software);
  if (!backend) return backend.error();
  if (method == kReliefImpostorName)
    if (Result<> made = make_folder(std::filesystem::path(options.impostors.store).parent_path());
        !made)
      return made.error();
  return with_reports(options, [&](const rilievo::MethodOptions& with) {
    return make_method(method, with, **backend);
  });
}

Result<Backend*> Stage::backend_of_file(const std::string& method, const MethodOptions& options) {
  const std::optional<std::string> reason = needs_opengl(method, options, samples_);
  if (options.draw == "software" && reason) return Error{"--draw", *reason};
  const Result<bool> software = reason ? Result<bool>(false) : draws_by_software(options);
  if (!software) return software.error();
  return backend(*software);
}

Result<Method> Stage::make(const std::string& method, const MethodOptions& options,
                           std::unique_ptr<Representation> representation,
                           std::vector<StoredBeside> beside) {
  const Result<Backend*> backend = backend_of_file(method, options);
  if (!backend) return backend.error();
  return make_stored_method(method, options, **backend, std::move(representation),
                            std::move(beside));
}

Result<Method> Stage::make(const std::string& method, const MethodOptions& options,
                           std::span<const DepthImage> pictures, int delta_bits) {
  const Result<Backend*> backend = backend_of_file(method, options);
  if (!backend) return backend.error();
  return make_stored_method(pictures, delta_bits, options, **backend);
}

Result<std::unique_ptr<BackendTarget>> Stage::make_target(const FrameSource& frames, int width,
                                                          int height) const {
  return (frames.software_target() ? software_ : opengl_)->make_target(width, height);
}

Result<Method> Stage::make_direct() {
  const Result<Backend*> backend = this->backend(false);
  if (!backend) return backend.error();
  return make_method("direct", {}, **backend);
}

}  // namespace rilievo::app
