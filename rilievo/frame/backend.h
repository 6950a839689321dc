// A backend makes the frames of a scene, with OpenGL or without.
//
//   a method's chooser ---- asks for pictures, boards, drawables ----> Backend
//   make_frames(chooser) -> FrameSource: owns the order of a frame, and draws what is chosen
//
// frame/gl/opengl_backend.h draws with OpenGL, frame/software/software_backend.h without. A
// backend must outlive all that it makes.
#pragma once

#include <memory>
#include <span>

#include "rilievo/capture/capture_source.h"
#include "rilievo/frame/backend_target.h"
#include "rilievo/frame/frame_chooser.h"
#include "rilievo/frame/frame_source.h"
#include "rilievo/nailboard/nailboard_store.h"
#include "rilievo/nailboard/picture_set.h"
#include "rilievo/nailboard/prewarped_boards.h"
#include "rilievo/render/placed_scene.h"
#include "rilievo/representation/drawable_rows.h"
#include "rilievo/scene/bend.h"

namespace rilievo {

class KeyframePainter;
class SoftwareBackend;

// Draws one scene's frames.
class Backend {
 public:
  virtual ~Backend() = default;

  [[nodiscard]] virtual DrawnBy drawn_by() const = 0;
  // The scene, at the time of the last frame or of set_time().
  [[nodiscard]] virtual const PlacedScene& placed() const = 0;
  [[nodiscard]] const Scene& scene() const { return placed().scene(); }
  // The scene that the backend was made of; scene() is a copy where something bends.
  [[nodiscard]] virtual const Scene& given_scene() const { return scene(); }
  // Places the scene's objects; seconds.
  virtual void set_time(double time) = 0;
  // The deformations of the scene's meshes by time, for choosers that show them; null: none.
  [[nodiscard]] virtual const Deformations* deformations() const = 0;
  // The samples of a pixel, which pictures share.
  [[nodiscard]] virtual int samples() const = 0;

  // Captures the scene for a bake, as it is placed now.
  [[nodiscard]] virtual Result<std::unique_ptr<CaptureSource>> make_capture_source() = 0;
  // The drawers of each kind of representation.
  [[nodiscard]] virtual std::span<const DrawableRow> drawables() const = 0;
  // A store of pictures of the scene. Fails where memory, or the driver, does.
  [[nodiscard]] virtual Result<std::unique_ptr<NailboardStore>> make_store(
      const NailboardStoreOptions& options) = 0;
  // Room for pictures that were warped. Fails where the driver does.
  [[nodiscard]] virtual Result<std::unique_ptr<PrewarpedBoards>> make_boards() = 0;
  // Pictures that are there already. Fails for those that are too large or not perspective.
  [[nodiscard]] virtual Result<PictureSet> make_pictures(std::span<const DepthImage> pictures,
                                                         DepthMode mode, int delta_bits) = 0;

  // A backend like this one for another scene, which must outlive it.
  [[nodiscard]] virtual Result<std::unique_ptr<Backend>> make_backend(const Scene& scene) const = 0;
  // Draws what `chooser`, of this backend's scene, chooses.
  [[nodiscard]] virtual Result<std::unique_ptr<FrameSource>> make_frames(
      std::unique_ptr<FrameChooser> chooser) = 0;

  // Who warps keyframes of the backend's scene and draws the frames; null: without OpenGL
  // KeyframeFrames makes its own. Fails where the driver does.
  [[nodiscard]] virtual Result<std::unique_ptr<KeyframePainter>> make_keyframe_painter() = 0;

  // A target of this size, with the backend's samples, for frames that are read. Fails where the
  // driver does, and for sizes that are too large.
  [[nodiscard]] virtual Result<std::unique_ptr<BackendTarget>> make_target(int width,
                                                                           int height) const = 0;

  // Waits until what was drawn is done, so that its time can be taken.
  virtual void finish() {}

  // For methods that draw without OpenGL whatever the backend: the same scene without OpenGL, and
  // frames of it in the place of this backend's. OpenGL gets an upload of colours and depths. Fails
  // for other numbers of samples than 1 and 4.
  [[nodiscard]] virtual Result<SoftwareBackend*> software() = 0;
  [[nodiscard]] virtual Result<std::unique_ptr<FrameSource>> present(
      std::unique_ptr<FrameSource> software_frames) = 0;
};

}  // namespace rilievo
