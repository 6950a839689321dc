// Which methods draw a scene, or the contents of a file, and who draws them: OpenGL, or software?
//
// MethodOptions::draw decides. `automatic` is software where OpenGL runs on processors or is
// missing; but `direct` is OpenGL's where there is one, as is a kind of representation that is
// baked of a scene.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/rilievo/method_options.h"
#include "rilievo/frame/frame_source.h"
#include "rilievo/gl/context.h"
#include "rilievo/render/opengl/scene_renderer.h"
#include "rilievo/representation/kinds.h"

namespace rilievo::app {

// direct, direct-raster, direct-rays, lod, flat, nailboard, cache, relief-impostor, and those of
// all kinds.
[[nodiscard]] const std::vector<std::string>& method_names();
// Does --method take it? Former names too.
[[nodiscard]] bool is_method(const std::string& name);
// Does the method show skins and morph targets by time, if it is given Deformations? direct-raster
// by software only.
[[nodiscard]] bool bends_by_time(const std::string& method);
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

// Draws a scene without OpenGL (FrameSource::software_target). `scene` must outlive the source.
// Fails where OpenGL is needed.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_software_source(
    const std::string& method, const MethodOptions& options, int samples, const Scene& scene);

// Draws `renderer`'s scene, by OpenGL or by software. Needs a current OpenGL context; `renderer`
// must outlive the source. `samples` is the frame's antialiasing, which pictures share.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_source(const std::string& method,
                                                               const MethodOptions& options,
                                                               int samples,
                                                               SceneRenderer& renderer);

// Makes `renderer` if it is empty. Needs a current OpenGL context; `scene` must outlive it.
[[nodiscard]] Result<> make_renderer(const Scene& scene, std::optional<SceneRenderer>& renderer);

// The same after open_opengl(). Makes `renderer` if it is empty and the source needs it; `scene`
// and `renderer` must outlive the source.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_scene_source(
    const std::string& method, const MethodOptions& options, int samples, const Scene& scene,
    std::optional<SceneRenderer>& renderer);

// After open_opengl(): is what a file holds drawn without OpenGL? The error says why it cannot be.
[[nodiscard]] Result<bool> draws_by_software(const std::string& method,
                                             const MethodOptions& options, int samples);

// Draws what a file holds, under the sky of a scene, after open_opengl(). Makes `renderer`, of that
// scene, if it is empty and the source needs it; both must outlive the source. A drawable takes the
// representation for itself: one load for each source.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_file_source(
    const std::string& method, const MethodOptions& options, int samples,
    std::unique_ptr<Representation> representation, const Scene& sky,
    std::optional<SceneRenderer>& renderer);

}  // namespace rilievo::app
