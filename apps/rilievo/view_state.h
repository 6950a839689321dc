// What does the window show, and what can its panel change?
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "apps/rilievo/methods.h"
#include "apps/rilievo/view_camera.h"
#include "rilievo/core/camera_path.h"
#include "rilievo/method/relief_impostors.h"

namespace rilievo::app {

// The last values of something measured every frame, oldest first.
class History {
 public:
  void add(float value) {
    std::move(values_.begin() + 1, values_.end(), values_.begin());
    values_.back() = value;
  }
  [[nodiscard]] const float* data() const { return values_.data(); }
  [[nodiscard]] int size() const { return int(values_.size()); }
  [[nodiscard]] float last() const { return values_.back(); }
  [[nodiscard]] float largest() const { return *std::max_element(values_.begin(), values_.end()); }

 private:
  std::array<float, 240> values_{};
};

enum class ViewMode { fly, orbit, play };

struct ViewState {
  // Where the eye is.
  ViewMode mode = ViewMode::play;
  ViewPose pose;
  double vertical_fov = 0.9;
  float speed = 1.0f;  // metres a second
  CameraPath path;
  int path_frame = 0, path_frames = 1;
  CameraPath recorded;  // keys set by hand

  // How the scene is drawn.
  std::string method = "cache";
  std::vector<std::string> method_names;
  bool can_split = true;  // is there direct drawing to compare with?
  MethodOptions methods;
  bool split = false;
  float split_at = 0.5f;  // of the width: the method on the left, direct drawing on the right
  bool animate = true;
  bool moves = false;  // does anything but the eye?
  double time = 0;     // of the scene, seconds

  // What was measured.
  History frame_ms, direct_ms, captures, megabytes;
  FrameStats stats;
  std::vector<ImpostorStatus> impostors;  // of relief-impostor
  std::string message;

  // What the panel asks the loop to do.
  bool new_source = true, save_path = false, save_screenshot = false;
};

// The panel of this frame, between ImGui's NewFrame and Render.
void show_panel(ViewState& state);

}  // namespace rilievo::app
