// A source of pictures with depth, behind one capture call.
//
// Sources: OpenGL (capture/gl/opengl_source.h), the library's own rasteriser
// (capture/raster_source.h), rays (capture/ray_source.h), posed photographs
// (capture/photograph_source.h), and any callable (capture/callable_source.h), such as S5's
// software shaders. Not safe for several threads at once.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <string_view>

#include "rilievo/core/bounds.h"
#include "rilievo/core/depth_image.h"
#include "rilievo/core/result.h"
#include "rilievo/core/stroke_size.h"
#include "rilievo/core/world_space.h"

namespace rilievo {

struct CapturedPicture;
struct Scene;

// The reason of the error of a capture that was stopped.
inline constexpr std::string_view kCaptureStopped = "the capture was stopped";

// For captures that take long, such as those of software shaders. Quick sources ignore it.
struct CaptureControl {
  // Stops the capture: it fails within 5 ms, because of kCaptureStopped.
  std::stop_token stop = {};
  // Called with complete pictures before the last one, coarse first, by the thread that captures.
  std::function<void(const CapturedPicture&)> refined = {};
  // Called every millisecond or more often by each thread that captures. It may wait, so that a
  // frame can be drawn.
  std::function<void()> give_way = {};
};

// A picture to capture, and its data.
struct CaptureRequest {
  Camera camera;
  // Indices into the scene's objects; empty: everything that the camera sees.
  std::span<const std::uint32_t> objects = {};
  int samples = 4;  // per texel; colours are averaged, alpha is coverage
  // The sample lies in a rotated grid (staggered_position()), beside the texel's centre, with its
  // depth there. Requires one sample and no `farthest`. Sources without such samples ignore it.
  bool staggered = false;
  bool identifiers = true;                  // capture the object shown by each texel
  bool farthest = false;                    // capture CapturedPicture::farthest
  bool with_sky = false;                    // otherwise texels without an object stay empty
  const CaptureControl* control = nullptr;  // null: not stopped, and no coarse pictures
  double time = 0;                          // seconds, for sources whose content deforms
};

// A capture. Depth is the eye_z of the nearest surface at the texel's centre, or of the farthest
// for a back-perspective camera.
struct CapturedPicture {
  DepthImage picture;
  // eye_z of the farthest of all surfaces along the texel's ray, including hidden ones; kNoDepth if
  // there is none. Empty unless requested. It bounds what the picture can be missing.
  Image<float> farthest;
};

// Which surfaces to capture along each line of sight.
struct LayersRequest {
  Camera camera;                                // parallel or perspective
  std::span<const std::uint32_t> objects = {};  // as CaptureRequest's
  double merge = 0;      // surfaces within this distance along a line of sight become one; metres
  int max_layers = 256;  // per line of sight
  int samples = 1;       // of each surface, for sources whose light is noisy
};

// A picture that a source captures in parts, between which frames are drawn. It keeps its memory
// for the next picture.
class PictureInParts {
 public:
  virtual ~PictureInParts() = default;
  // Begins a picture of the scene as it is now; the last one is lost. Requires one sample a texel.
  // Fails where capture() does. The request's `objects` need not live on. Ignores `farthest` and
  // `control`.
  virtual Result<> begin(const CaptureRequest& request) = 0;
  // Goes on by about this share of all its work, and returns how many rows, from the top, can be
  // read; they are shaded when they are read, which is part of the work.
  virtual int advance(double share) = 0;
  // Rows [from, to) as a picture of their own, in the memory of `picture`. Requires rows that can
  // be read.
  virtual void read(int from, int to, DepthImage& picture) = 0;
};

// A source of pictures.
class CaptureSource {
 public:
  virtual ~CaptureSource() = default;

  // The name of what is captured, for errors and files.
  [[nodiscard]] virtual std::string_view name() const = 0;
  // World bounds of what these objects (empty: all) can show in a picture; empty if nothing.
  [[nodiscard]] virtual Box bounds(std::span<const std::uint32_t> objects) const = 0;
  // Captures a picture. Fails where the source cannot provide what is requested.
  [[nodiscard]] virtual Result<CapturedPicture> capture(const CaptureRequest& request) = 0;

  // Captures pictures in parts: those of one sample a texel. Null: the source captures at once. The
  // source must outlive it.
  [[nodiscard]] virtual std::unique_ptr<PictureInParts> in_parts() { return nullptr; }

  // Captures every surface along each line of sight, including hidden ones and back faces (S4.1).
  // Depths are eye_z. Fails for sources that do not know hidden surfaces.
  [[nodiscard]] virtual Result<LayeredDepthImage> capture_layers(const LayersRequest& request);

  // The deep images that the source consists of, if it does.
  [[nodiscard]] virtual std::span<const LayeredDepthImage> deep_images() const { return {}; }
  // The scene that is captured, for ray casting; null if the source is not a scene.
  [[nodiscard]] virtual const Scene* scene() const { return nullptr; }
  // Where the space of its cameras lies in the world.
  [[nodiscard]] virtual WorldSpace world() const;
  // The largest points and lines of these objects (empty: all).
  [[nodiscard]] virtual StrokeSize stroke_size(std::span<const std::uint32_t> objects) const;
  // The photographs that the source consists of, if it does.
  [[nodiscard]] virtual std::span<const DepthImage> photographs() const { return {}; }
};

}  // namespace rilievo
