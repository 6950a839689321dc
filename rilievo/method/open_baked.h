// Opens a baked file and draws it in one's own program.
//
//   const Scene nothing;
//   auto backend = OpenGLBackend::create(nothing, 4);  // or SoftwareBackend::create(nothing, 4)
//   auto baked = open_baked("house.exr", **backend);
//   auto path = orbit_path(baked->bounds, 120, baked->vantage);  // core/camera_path.h, or your own
//
// OpenGL draws into the bound framebuffer, and shares its z-buffer with everything else in the
// frame:
//
//   baked->frames->draw(camera, 0);
//   baked->frames->stats().bound_px;   // the bound of the frame's error, if the file has one here
//
// HostFrames (frame/gl/host_frames.h) draw them by a host's matrices, with reversed depths, and
// into linear framebuffers.
//
// Frames in memory, with OpenGL or without, are drawn into a target of the backend's:
//
//   auto target = (*backend)->make_target(1280, 720);
//   (*target)->draw(*baked->frames, camera_at(path, time, 1280, 720), time);
//   save_png("frame.png", (*target)->color());
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rilievo/core/bounds.h"
#include "rilievo/core/camera_path.h"
#include "rilievo/frame/backend.h"
#include "rilievo/representation/kind_methods.h"

namespace rilievo {

// How a file's content is drawn.
struct BakedOptions {
  std::string method;     // a name of kind_method_names(); empty: the file's kind
  KindOptions kind;       // options of drawing
  bool outlines = false;  // of pictures (S1.8)
  bool sky = false;       // draw a sky behind: the file's own, or that of the backend's scene
  // Other files, drawn by their own kinds into the same z-buffer: objects beside nodes.
  std::vector<std::filesystem::path> beside;
};

// A file's content, ready to be drawn.
struct BakedFrames {
  std::unique_ptr<FrameSource> frames;
  const Kind* kind = nullptr;
  Box bounds;                      // of what it shows, world space
  Vantage vantage;                 // the direction that is up, and the best viewpoint, if known
  std::optional<CameraPath> walk;  // the file's own camera path, if it has one
};

// Opens what was baked into a file. `backend` can be of an empty scene, and must outlive the
// frames. Fails for a file that holds nothing baked, a method of another kind, and where memory or
// the driver does.
[[nodiscard]] Result<BakedFrames> open_baked(const std::filesystem::path& file, Backend& backend,
                                             const BakedOptions& options = {});

}  // namespace rilievo
