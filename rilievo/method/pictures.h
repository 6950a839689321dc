// Flat impostors and nailboards used in the plain way (S1.5): one picture for each heavy object,
// captured again when the eye has moved by an angle.
//
// The cache (cache/scene_cache.h) does better: its threshold is an error bound in pixels, and a
// picture can show many objects.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "rilievo/frame/backend.h"

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

// The options of a store for these options.
[[nodiscard]] NailboardStoreOptions store_options(const PictureFramesOptions& options);

// Chooses frames with one picture for each heavy object.
class PictureChooser final : public FrameChooser {
 public:
  // `placed` must outlive the object, and be what choose() gets. `store` is empty and made with
  // store_options().
  PictureChooser(const PlacedScene& placed, std::unique_ptr<NailboardStore> store,
                 const PictureFramesOptions& options);

  void add_sets(FrameContent& content) override;
  Result<> choose(const Camera& camera, const PlacedScene& placed, FrameContent& content,
                  FrameStats& stats) override;
  // Named after their objects. If an object has moved since its capture, the picture's camera has
  // moved along.
  [[nodiscard]] std::vector<DepthImage> read_pictures(const FrameContent& content) const override;

 private:
  struct Picture {
    PictureGeometry geometry;
    glm::mat4 pose{1.0f};    // of the object, at capture
    glm::dvec3 center{0.0};  // of its bounds, at capture
    std::uint64_t last_drawn = 0;
  };

  [[nodiscard]] bool is_valid(const Picture& picture, const Camera& frame,
                              const glm::dmat4& motion) const;
  [[nodiscard]] bool capture(std::uint32_t object, const Camera& frame);
  [[nodiscard]] bool make_room(std::uint32_t object, const Camera& camera);
  void narrow_captured();

  const PlacedScene& placed_;
  std::unique_ptr<NailboardStore> store_;
  PictureFramesOptions options_;
  std::vector<std::optional<Picture>> pictures_;  // by object, whose index is the store's slot
  std::vector<std::uint32_t> visible_, captured_;
  std::uint64_t frame_ = 0;
};

// Frames that a PictureChooser chooses. `backend` must outlive them. Fails where the store cannot
// be made.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_picture_frames(
    Backend& backend, const PictureFramesOptions& options);

}  // namespace rilievo
