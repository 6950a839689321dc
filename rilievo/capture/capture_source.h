// Any source of pictures with depth, behind one capture call.
//
// Backends: OpenGL (capture/gl/opengl_source.h), posed photographs (capture/photograph_source.h),
// and any callable (capture/callable_source.h), as of rays (cast_picture) or what S5 calls a
// software shader. Not for several threads at once.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "rilievo/core/bounds.h"
#include "rilievo/core/depth_image.h"
#include "rilievo/core/result.h"

namespace rilievo {

struct Scene;

struct CaptureRequest {
  Camera camera;
  // Indices into the scene's objects; empty: everything that the camera sees.
  std::span<const std::uint32_t> objects = {};
  int samples = 4;          // a texel; colours are averaged, alpha is coverage
  bool identifiers = true;  // which object each texel shows
  bool farthest = false;    // CapturedPicture::farthest
  bool with_sky = false;    // else texels without an object stay empty
};

// What a source makes. Depth is eye_z at the texel's centre: the nearest surface's, or for a
// back-perspective camera the farthest's.
struct CapturedPicture {
  DepthImage picture;
  // eye_z of the farthest of all surfaces along the texel's ray, hidden ones included; kNoDepth
  // where there is none. Empty if it was not asked for. It bounds what the picture may lack.
  Image<float> farthest;
};

struct LayersRequest {
  Camera camera;                                // parallel, or perspective
  std::span<const std::uint32_t> objects = {};  // as CaptureRequest's
  double merge = 0;      // surfaces closer together along a line of sight become one; metres
  int max_layers = 256;  // of one line of sight
};

class CaptureSource {
 public:
  virtual ~CaptureSource() = default;

  // What is captured, for errors and files.
  [[nodiscard]] virtual std::string_view name() const = 0;
  // World bounds of what these objects (empty: all) can show in a picture; empty if nothing.
  [[nodiscard]] virtual Box bounds(std::span<const std::uint32_t> objects) const = 0;
  [[nodiscard]] virtual Result<CapturedPicture> capture(const CaptureRequest& request) = 0;

  // Every surface along each line of sight, hidden ones and back faces included (S4.1); eye_z. The
  // error says that this source cannot look behind what it shows.
  [[nodiscard]] virtual Result<LayeredDepthImage> capture_layers(const LayersRequest& request);

  // The layered pictures that the source consists of, where it does.
  [[nodiscard]] virtual std::span<const LayeredDepthImage> layered_pictures() const { return {}; }
  // The scene of which pictures are captured, where it is one: for rays.
  [[nodiscard]] virtual const Scene* scene() const { return nullptr; }
  // The photographs that the source consists of, where it does.
  [[nodiscard]] virtual std::span<const DepthImage> photographs() const { return {}; }
};

}  // namespace rilievo
