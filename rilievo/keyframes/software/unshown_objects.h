// Which objects does a frame's eye see that its keyframes do not show?
//
// An object may stand in a gap: something hides it from each keyframe's eye and not from the
// frame's. Keyframes then show what is behind it, and nothing tells that it is missing. And what
// came several times as near since it was captured would be single texels before its background.
// Both are to be drawn as polygons.
//
// Objects that keyframes show are known by their texels. Of the others in view rays tell whether
// they are seen, some each frame, at pixels of the object's rectangle that show something farther.
// What was found stays until a keyframe shows it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/core/random.h"
#include "rilievo/keyframes/near_objects.h"
#include "rilievo/keyframes/warp_keyframes.h"
#include "rilievo/render/placed_scene.h"
#include "rilievo/render/rays/cast_pixels.h"

namespace rilievo {

// Finds them, frame after frame. A steady frame allocates nothing. The result depends on the frames
// before, and not on the number of threads.
class UnshownObjects {
 public:
  // Rays a frame; and at most so many more for objects that were shown until now.
  static constexpr int kRays = 128, kNewRays = 512;
  // An object whose texels have grown by more in all keyframes is not shown by them.
  static constexpr double kMostGrown = 2.5;

  // `placed` and `rays`, of one scene, must outlive the object. Objects have at most so many
  // triangles together; the nearest come first.
  UnshownObjects(const PlacedScene& placed, const RayScene& rays, double triangles);

  // Begins a frame: those of `objects` in view that are known. Both ascending; valid until the next
  // call.
  [[nodiscard]] std::span<const std::uint32_t> begin(const Camera& frame,
                                                     std::span<const WarpedKeyframe> keyframes,
                                                     std::span<const std::uint32_t> objects);
  // Those among the known that keyframes show, which are to be hidden there.
  [[nodiscard]] std::span<const std::uint32_t> grown() const { return drawn_grown_; }
  // Looks for more in the frame, as warped. Returns those to draw, or none if there are no new
  // ones.
  [[nodiscard]] std::span<const std::uint32_t> look(const WarpedFrame& warped);

 private:
  void look_for(std::span<const std::uint32_t> objects, std::size_t first, int rays,
                const WarpedFrame& warped);
  void aim(std::uint32_t object, int rays, const WarpedFrame& warped);
  void choose();

  const PlacedScene& placed_;
  const RayScene& rays_;
  ObjectSet still_;  // what moves is elsewhere for rays
  double triangles_;
  Random random_{1};
  Camera frame_;
  std::size_t next_ = 0;  // of the hidden ones, the first to look for
  // Those that keyframes show; of those in view the others, now and a frame ago, the ones among
  // them that were seen, and the ones that have grown too much. And those to draw, and the grown
  // ones among them.
  std::vector<std::uint32_t> shown_, hidden_, hidden_before_, seen_, grown_, found_, drawn_grown_,
      scratch_;
  std::vector<FramePixel> pixels_;
  std::vector<std::uint32_t> hits_;  // index into Scene::objects + 1
  std::vector<ObjectAtDistance> chosen_;
};

}  // namespace rilievo
