// What takes the pictures of a bake? Of a scene the source that is asked for, or OpenGL, or rays
// where there is none; a capture is its own source.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "apps/rilievo/scene_file.h"
#include "rilievo/capture/capture_source.h"
#include "rilievo/capture/store/kept_source.h"
#include "rilievo/core/bounds.h"
#include "rilievo/core/depth.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo::app {

// What --source says, and what that source needs.
struct SourceOptions {
  std::string source;                      // raster, rays, raytrace, exec:PROGRAM; empty: left open
  int samples = 0;                         // of a texel; 0: as many as the kind takes
  double noise = 0;                        // of a program's texels that is low enough; 0: none
  int around_samples = 0;                  // of what a picture does not see itself; 0: as many
  std::vector<std::string> only, without;  // names of objects; both empty: all
  std::string program_scene;               // what a program opens instead of the scene
  std::optional<DepthKind> depth_kind;     // of a program's pictures; none: found out
  bool waited_for = false;  // somebody sits there: a program has minutes to answer, not hours
  // Where pictures of slow sources are kept; must outlive the source. Null: nowhere.
  PictureKeeper* keeper = nullptr;
  // Gets what is wrong with that; otherwise it is a warning.
  std::function<void(const std::string&)> warn = {};
};

// A source, and what it needs to live.
class BakeSource {
 public:
  // `scene` names a file or a built-in scene, or a capture of photographs; with a program as the
  // source, any file that the program opens.
  [[nodiscard]] static Result<BakeSource> open(const std::string& scene, const FileLimits& limits,
                                               const SourceOptions& options = {});
  BakeSource(BakeSource&&) noexcept;
  BakeSource& operator=(BakeSource&&) noexcept;
  ~BakeSource();

  [[nodiscard]] CaptureSource& source();
  // The objects to take pictures of, as indices; empty: all.
  [[nodiscard]] const std::vector<std::uint32_t>& objects() const;
  // Where eyes will be, if a built-in scene is walked through; else empty.
  [[nodiscard]] Box eyes() const;
  // The walk of a built-in scene.
  [[nodiscard]] const CameraPath* walk() const;
  // Null without OpenGL, and for captures and slow sources.
  [[nodiscard]] SceneRenderer* renderer();

  // Of slow sources: the pictures that were rendered, and those that were kept from before.
  [[nodiscard]] std::uint64_t rendered() const;
  [[nodiscard]] std::uint64_t found() const;
  // The light of a slow source, with what keeps its pictures; null for others.
  [[nodiscard]] CaptureSource* light();
  // What its pictures are kept by.
  [[nodiscard]] const KeptOptions& kept() const;
  // Takes another light instead, which must outlive this.
  void replace_light(CaptureSource& light);
  // A quick source of the same surfaces; null where only the program knows them.
  [[nodiscard]] CaptureSource* geometry();

 private:
  struct State;
  explicit BakeSource(std::unique_ptr<State> state);
  static Result<> open_slow(State& state, const std::string& scene, const FileLimits& limits,
                            const SourceOptions& options);
  std::unique_ptr<State> state_;
};

}  // namespace rilievo::app
