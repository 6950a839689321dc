// How are flat impostors and nailboards used in the plain way (S1.5)? One picture for each heavy
// object, captured again when the eye has moved by an angle.
//
// image_cache.h does better: its threshold is an error bound in pixels, and a picture can show many
// objects.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rilievo/frame/gl/scene_frames.h"
#include "rilievo/nailboard/gl/nailboard_capture.h"

namespace rilievo {

// When to capture, and how.
struct PictureFramesOptions {
  DepthMode mode = DepthMode::exact;
  int delta_bits = 8;
  // The eye's motion since the capture, relative to the object, divided by the distance; radians.
  double max_angle = 0.012;
  std::uint64_t min_triangles = 300;  // lighter objects are drawn as polygons
  double texels_per_pixel = 1.0;
  bool outlines = false;
  std::size_t max_bytes = std::size_t(256) << 20;
  CaptureBy capture_by = CaptureBy::automatic;
  int samples = 4;
};

// A frame source with one picture for each heavy object.
class PictureFrames final : public SceneFrames {
 public:
  // `renderer` must outlive the source. Fails where the atlas cannot be allocated.
  [[nodiscard]] static Result<PictureFrames> create(SceneRenderer& renderer,
                                                    const PictureFramesOptions& options);

  // The pictures that the last frame drew, named after their objects. If an object has moved since
  // its capture, the picture's camera has moved along.
  [[nodiscard]] std::vector<DepthImage> read_pictures() const override;

 private:
  struct Picture {
    AtlasSlot slot;
    PictureGeometry geometry;
    glm::mat4 pose{1.0f};    // of the object, at capture
    glm::dvec3 center{0.0};  // of its bounds, at capture
    std::uint64_t last_drawn = 0;
  };

  PictureFrames(SceneRenderer& renderer, NailboardCapture nailboards,
                const PictureFramesOptions& options);
  Result<> choose(const Camera& camera, FrameContent& content, FrameStats& stats) override;
  [[nodiscard]] bool is_valid(const Picture& picture, const Camera& frame,
                              const glm::dmat4& motion) const;
  bool capture(std::uint32_t object, const Camera& frame);
  [[nodiscard]] std::optional<AtlasSlot> make_room(int width, int height);

  PictureFramesOptions options_;
  NailboardCapture nailboards_;
  std::vector<std::optional<Picture>> pictures_;  // by object
  std::vector<std::uint32_t> visible_;
  std::uint64_t frame_ = 0;
};

}  // namespace rilievo
