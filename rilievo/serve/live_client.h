// A client of a live walk without a window: keeps the newest pictures and warps them to any eye.
//
// For tests and measures; browsers have their own (web/src/live). Reads a server's messages, keeps
// three views, one coarse view and six faces of a surround, and says what it drops. What nothing
// shows is filled from beside.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "rilievo/core/color.h"
#include "rilievo/keyframes/warp_keyframes.h"
#include "rilievo/serve/message.h"

namespace rilievo {

// A frame, and what it lacked.
struct LiveFrame {
  Rgba8Image color;
  Image<std::uint32_t> objects;  // of pictures that have any
  std::size_t holes = 0;         // pixels that no picture shows; they are filled
  std::size_t coarse = 0;        // pixels that only coarse pictures show
  double error_px = 0;           // of depths: the largest of the views'
};

// A picture that is kept.
struct LiveView {
  LivePictureHead head;
  Keyframe keyframe;
};

class LiveClient {
 public:
  // Takes a message. Fails where it is damaged.
  [[nodiscard]] Result<> receive(std::span<const std::byte> message);

  [[nodiscard]] const std::optional<LiveWelcome>& welcome() const { return welcome_; }
  [[nodiscard]] bool any() const { return !views_.empty() || !coarse_.empty(); }
  [[nodiscard]] std::span<const LiveView> views() const { return views_; }  // the oldest first
  // The last picture that came, if one did.
  [[nodiscard]] const LivePictureHead* newest() const { return newest_ ? &*newest_ : nullptr; }
  // The half of the last ping's round trip at `now_ms` of the client's clock.
  [[nodiscard]] std::optional<LivePong> take_pong() { return std::exchange(pong_, std::nullopt); }
  [[nodiscard]] const std::optional<LiveBye>& bye() const { return bye_; }
  // Identifiers that were dropped since the last call.
  [[nodiscard]] std::vector<std::uint64_t> take_dropped() { return std::exchange(dropped_, {}); }
  // For measures: the objects of a picture.
  void set_objects(std::uint64_t id, const Image<std::uint32_t>& objects);

  // Draws. Requires any().
  void draw(const Camera& frame, LiveFrame& out, bool with_objects = false) const;

 private:
  std::optional<LiveWelcome> welcome_;
  std::optional<LivePong> pong_;
  std::optional<LiveBye> bye_;
  std::optional<LivePictureHead> newest_;
  std::vector<LiveView> views_, coarse_;
  std::map<int, LiveView> faces_;
  std::vector<std::uint64_t> dropped_;
};

}  // namespace rilievo
