// A backend and frames that it draws as one source; and makers of the usual ones without OpenGL.
#pragma once

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "rilievo/cache/scene_cache.h"
#include "rilievo/frame/software/software_frames.h"
#include "rilievo/method/direct.h"
#include "rilievo/method/pictures.h"
#include "rilievo/method/relief_impostors.h"
#include "rilievo/method/stored.h"

namespace rilievo {

// Owns its backend; knows the cache, or the impostors, if it has them.
class TestSource final : public FrameSource {
 public:
  TestSource(std::unique_ptr<Backend> backend, std::unique_ptr<FrameSource> frames)
      : backend_(std::move(backend)), frames_(std::move(frames)) {}

  static Result<TestSource> cached(std::unique_ptr<Backend> backend,
                                   const ImageCacheOptions& options) {
    Result<CachedFrames> made = make_cached_frames(*backend, options);
    if (!made) return made.error();
    TestSource source(std::move(backend), std::move(made->frames));
    source.cache_ = made->cache;
    return source;
  }
  static Result<TestSource> pictures(std::unique_ptr<Backend> backend,
                                     const PictureFramesOptions& options) {
    Result<std::unique_ptr<FrameSource>> made = make_picture_frames(*backend, options);
    if (!made) return made.error();
    return TestSource(std::move(backend), std::move(*made));
  }
  static Result<TestSource> impostors(std::unique_ptr<Backend> backend, ImpostorContent content,
                                      const ImpostorFramesOptions& options) {
    Result<ImpostorFrames> made = make_impostor_frames(*backend, std::move(content), options);
    if (!made) return made.error();
    TestSource source(std::move(backend), std::move(made->frames));
    source.chooser_ = made->chooser;
    return source;
  }
  // Of a chooser that `make` makes of the placed scene.
  template <typename Make>
  static Result<TestSource> chosen(std::unique_ptr<Backend> backend, const Make& make) {
    auto chooser = make(backend->placed());
    if (!chooser) return chooser.error();
    Result<std::unique_ptr<FrameSource>> frames = backend->make_frames(std::move(*chooser));
    if (!frames) return frames.error();
    return TestSource(std::move(backend), std::move(*frames));
  }

  Result<> draw(const Camera& camera, double time) override { return frames_->draw(camera, time); }
  Result<> draw_objects() override { return frames_->draw_objects(); }
  [[nodiscard]] const SoftwareTarget* software_target() const override {
    return frames_->software_target();
  }
  [[nodiscard]] const FrameStats& stats() const override { return frames_->stats(); }
  [[nodiscard]] std::vector<DepthImage> read_pictures() const override {
    return frames_->read_pictures();
  }

  [[nodiscard]] SceneCache& cache() { return *cache_; }
  [[nodiscard]] ImpostorChooser& chooser() { return *chooser_; }
  [[nodiscard]] Backend& backend() { return *backend_; }

 private:
  std::unique_ptr<Backend> backend_;
  std::unique_ptr<FrameSource> frames_;
  SceneCache* cache_ = nullptr;
  ImpostorChooser* chooser_ = nullptr;
};

// On the heap, for tests that keep it there.
inline Result<std::unique_ptr<TestSource>> on_heap(Result<TestSource> made) {
  if (!made) return made.error();
  return {std::make_unique<TestSource>(std::move(*made))};
}

inline Result<std::unique_ptr<TestSource>> software_cache(const Scene& scene,
                                                          const ImageCacheOptions& options) {
  return on_heap(
      TestSource::cached(std::make_unique<SoftwareBackend>(scene, options.samples), options));
}
inline Result<std::unique_ptr<TestSource>> software_pictures(const Scene& scene,
                                                             const PictureFramesOptions& options) {
  return on_heap(
      TestSource::pictures(std::make_unique<SoftwareBackend>(scene, options.samples), options));
}
template <typename Make>
Result<std::unique_ptr<TestSource>> software_chosen(const Scene& scene, int samples,
                                                    const Make& make,
                                                    const Deformations* deformations = nullptr) {
  return on_heap(
      TestSource::chosen(std::make_unique<SoftwareBackend>(scene, samples, deformations), make));
}

// Direct drawing, and a stored drawable, without OpenGL.
inline TestSource software_frames(const Scene& scene, int samples,
                                  std::unique_ptr<FrameChooser> chooser,
                                  std::unique_ptr<FrameVisibility> by = nullptr,
                                  const Deformations* deformations = nullptr) {
  auto backend = std::make_unique<SoftwareBackend>(scene, samples, deformations);
  auto frames = std::make_unique<SoftwareFrames>(*backend, std::move(chooser), std::move(by));
  return TestSource(std::move(backend), std::move(frames));
}
inline TestSource software_direct(const Scene& scene, int samples,
                                  std::unique_ptr<FrameVisibility> by = nullptr,
                                  const Deformations* deformations = nullptr) {
  return software_frames(scene, samples, std::make_unique<DirectChooser>(), std::move(by),
                         deformations);
}
inline TestSource software_stored(const Scene& sky, int samples, std::unique_ptr<Drawable> drawable,
                                  std::vector<Instance> instances, bool outlines,
                                  std::unique_ptr<DrawableFactory> factory = nullptr) {
  return software_frames(
      sky, samples,
      std::make_unique<StoredChooser>(PictureSet{std::move(drawable), std::move(instances)},
                                      StoredOptions{outlines}, std::move(factory)));
}

}  // namespace rilievo
