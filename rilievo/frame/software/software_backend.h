// The backend without OpenGL: the rasteriser, rays, and pictures in memory.
#pragma once

#include <cmath>
#include <memory>

#include "rilievo/frame/backend.h"

namespace rilievo {

// Draws a scene's frames into memory.
class SoftwareBackend final : public Backend {
 public:
  // `scene` must be valid and outlive the backend. `deformations`, if there are any, bend a copy of
  // the scene to each frame's time, and must outlive the backend. Fails for other samples of a
  // pixel than 1 and 4.
  [[nodiscard]] static Result<std::unique_ptr<SoftwareBackend>> create(
      const Scene& scene, int samples, const Deformations* deformations = nullptr);
  // The same for who knows the number of samples: requires 1 or 4.
  SoftwareBackend(const Scene& scene, int samples, const Deformations* deformations = nullptr);

  [[nodiscard]] DrawnBy drawn_by() const override { return DrawnBy::software; }
  [[nodiscard]] const PlacedScene& placed() const override { return placed_; }
  [[nodiscard]] const Scene& given_scene() const override { return given_; }
  void set_time(double time) override;
  [[nodiscard]] const Deformations* deformations() const override { return deformations_; }
  [[nodiscard]] int samples() const override { return samples_; }

  // By rays. Fails where memory does not suffice, as do those that follow.
  [[nodiscard]] Result<std::unique_ptr<CaptureSource>> make_capture_source() override;
  [[nodiscard]] std::span<const DrawableRow> drawables() const override;
  [[nodiscard]] Result<std::unique_ptr<NailboardStore>> make_store(
      const NailboardStoreOptions& options) override;
  [[nodiscard]] Result<std::unique_ptr<PrewarpedBoards>> make_boards() override;
  [[nodiscard]] Result<PictureSet> make_pictures(std::span<const DepthImage> pictures,
                                                 DepthMode mode, int delta_bits) override;
  [[nodiscard]] Result<std::unique_ptr<Backend>> make_backend(const Scene& scene) const override;
  [[nodiscard]] Result<std::unique_ptr<FrameSource>> make_frames(
      std::unique_ptr<FrameChooser> chooser) override;
  [[nodiscard]] Result<std::unique_ptr<KeyframePainter>> make_keyframe_painter() override;
  [[nodiscard]] Result<std::unique_ptr<BackendTarget>> make_target(int width,
                                                                   int height) const override;
  [[nodiscard]] Result<SoftwareBackend*> software() override { return this; }
  [[nodiscard]] Result<std::unique_ptr<FrameSource>> present(
      std::unique_ptr<FrameSource> software_frames) override {
    return software_frames;
  }

 private:
  const Scene& given_;
  const Deformations* deformations_;
  std::unique_ptr<Scene> bent_;  // null: nothing bends
  double bent_to_ = NAN;
  PlacedScene placed_;
  int samples_;
};

}  // namespace rilievo
