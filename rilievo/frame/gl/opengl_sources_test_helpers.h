// The usual sources with OpenGL.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "rilievo/frame/gl/opengl_backend.h"
#include "rilievo/frame/gl/opengl_frames.h"
#include "rilievo/method/test_source_test_helpers.h"

namespace rilievo {

inline OpenGLFrames opengl_direct(SceneRenderer& renderer) {
  return OpenGLFrames(renderer, std::make_unique<DirectChooser>());
}
inline OpenGLFrames opengl_stored(SceneRenderer& renderer, std::unique_ptr<Drawable> drawable,
                                  std::vector<Instance> instances, bool outlines, bool sky = true) {
  return OpenGLFrames(renderer, std::make_unique<StoredChooser>(
                                    PictureSet{std::move(drawable), std::move(instances)},
                                    StoredOptions{outlines, sky}));
}
inline Result<TestSource> opengl_cache(SceneRenderer& renderer, const ImageCacheOptions& options) {
  return TestSource::cached(std::make_unique<OpenGLBackend>(renderer, options.samples), options);
}
inline Result<TestSource> opengl_pictures(SceneRenderer& renderer,
                                          const PictureFramesOptions& options) {
  return TestSource::pictures(std::make_unique<OpenGLBackend>(renderer, options.samples), options);
}
inline Result<TestSource> opengl_impostors(SceneRenderer& renderer, ImpostorContent content,
                                           const ImpostorFramesOptions& options) {
  return TestSource::impostors(std::make_unique<OpenGLBackend>(renderer, 4), std::move(content),
                               options);
}
template <typename Make>
Result<TestSource> opengl_chosen(SceneRenderer& renderer, const Make& make) {
  return TestSource::chosen(std::make_unique<OpenGLBackend>(renderer, 4), make);
}

}  // namespace rilievo
