// Methods on the command line, and who draws them: OpenGL, or software.
//
// MethodOptions::draw decides. `automatic` is software where OpenGL is missing, or slower at
// polygons as measured; but `direct` is OpenGL's where there is one, as is a kind of
// representation that is baked of a scene.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/rilievo/method_options.h"
#include "rilievo/frame/gl/opengl_backend.h"
#include "rilievo/gl/context.h"

namespace rilievo::app {

// Does --method take it? Former names too.
[[nodiscard]] bool is_method(const std::string& name);
// The method of `render` and `view` if none is asked for: `auto`, or the cache where it is to bake.
[[nodiscard]] std::string default_method(const MethodOptions& options);
// For CLI options that take one or several methods.
[[nodiscard]] CLI::Validator known_method();

// Can what a file of this kind holds be drawn by the method? The error is `option`'s.
[[nodiscard]] Result<> expect_method_of(const Kind& kind, const std::string& method,
                                        const std::string& option);

// Why a method's frames cannot be drawn without OpenGL; none: they can. For a scene or a file.
[[nodiscard]] std::optional<std::string> needs_opengl(const std::string& method,
                                                      const MethodOptions& options, int samples);

// The OpenGL context for these methods, current. Null: all are drawn by software, as the options
// ask; or because they leave it open and there is no OpenGL, and then options.draw becomes
// software. Fails where there is none and the options or a method need it.
[[nodiscard]] Result<std::unique_ptr<gl::Context>> open_opengl(std::span<const std::string> methods,
                                                               int samples, MethodOptions& options);

// A scene and the backends that draw it, each made when the first method needs it. After
// open_opengl(). Methods must not outlive it.
class Stage {
 public:
  // `scene` (empty: for files) and `deformations` must outlive the stage. `samples` is the frame's
  // antialiasing, which pictures share.
  Stage(const Scene& scene, int samples, const Deformations* deformations = nullptr)
      : scene_(scene), samples_(samples), deformations_(deformations) {}

  // Draws the scene. The errors name options. Methods that cannot bend refuse scenes that bend.
  [[nodiscard]] Result<Method> make(const std::string& method, const MethodOptions& options);
  // Draws what a file holds, under the scene's sky.
  [[nodiscard]] Result<Method> make(const std::string& method, const MethodOptions& options,
                                    std::unique_ptr<Representation> representation,
                                    std::vector<StoredBeside> beside = {});
  [[nodiscard]] Result<Method> make(const std::string& method, const MethodOptions& options,
                                    std::span<const DepthImage> pictures, int delta_bits);
  // Where frames of one of these are drawn and read.
  [[nodiscard]] Result<std::unique_ptr<BackendTarget>> make_target(const FrameSource& frames,
                                                                   int width, int height) const;
  // Direct drawing, shown by OpenGL.
  [[nodiscard]] Result<Method> make_direct();

 private:
  [[nodiscard]] Result<Backend*> backend(bool software);
  [[nodiscard]] Result<bool> draws_by_software(const MethodOptions& options) const;
  [[nodiscard]] Result<Backend*> backend_of_file(const std::string& method,
                                                 const MethodOptions& options);

  const Scene& scene_;
  int samples_;
  const Deformations* deformations_;
  std::optional<SceneRenderer> renderer_;
  std::unique_ptr<Backend> software_, opengl_;
};

}  // namespace rilievo::app
