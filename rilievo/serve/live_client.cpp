#include "rilievo/serve/live_client.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "rilievo/core/expects.h"
#include "rilievo/keyframes/weigh_keyframes.h"
#include "rilievo/serve/live_picture.h"
#include "rilievo/web_walk/dilate.h"

namespace rilievo {
namespace {

constexpr std::size_t kViews = 3;
// Each one more takes time: a coarse view, and three faces of a corner.
constexpr std::size_t kMostCoarse = 4;
// With more holes coarse pictures are asked, too.
constexpr double kFewHoles = 0.0005;

// Do the frame's rays meet the picture's at all?
bool may_show(const Camera& picture, const Camera& frame) {
  // Half angles of the cones around the axes that hold the windows.
  const auto half = [](const Camera& c) {
    const double x = std::max(std::abs(c.window.left), std::abs(c.window.right));
    const double y = std::max(std::abs(c.window.bottom), std::abs(c.window.top));
    return std::atan(std::hypot(x, y));
  };
  const double between =
      std::acos(std::clamp(glm::dot(picture.forward(), frame.forward()), -1.0, 1.0));
  // 0.3 rad more: the eye moved.
  return between < half(picture) + half(frame) + 0.3;
}

// Large texels of coarse pictures reach over the borders of things: they show holes alone.
void fill_holes(const WarpedFrame& from, WarpedFrame& frame) {
  const int width = frame.color.width(), height = frame.color.height();
  for (std::uint32_t& count : frame.holes_in_strip.texels()) count = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (!frame.hole(x, y)) continue;
      frame.color(x, y) = from.color(x, y), frame.inverse_z(x, y) = from.inverse_z(x, y);
      frame.holes_in_strip(y / WarpedFrame::kStrip, 0) += from.hole(x, y);
    }
}

}  // namespace

Result<> LiveClient::receive(std::span<const std::byte> message) {
  Result<ServerMessage> read = parse_server_message(message);
  if (!read) return read.error();
  if (auto* welcome = std::get_if<LiveWelcome>(&*read)) {
    welcome_ = std::move(*welcome);
  } else if (const auto* pong = std::get_if<LivePong>(&*read)) {
    pong_ = *pong;
  } else if (const auto* bye = std::get_if<LiveBye>(&*read)) {
    bye_ = *bye;
  } else {
    if (!welcome_) return Error{"picture", "comes before the welcome"};
    const LivePicture& picture = std::get<LivePicture>(*read);
    Result<Keyframe> keyframe = decode_live_picture(picture, welcome_->z_far);
    if (!keyframe) return keyframe.error();
    newest_ = picture.head;
    LiveView view{picture.head, std::move(*keyframe)};
    if (picture.head.surround_face >= 0) {
      const auto found = faces_.find(picture.head.surround_face);
      if (found != faces_.end()) dropped_.push_back(found->second.head.id);
      faces_.insert_or_assign(picture.head.surround_face, std::move(view));
      return Done{};
    }
    std::vector<LiveView>& list = picture.head.fine ? views_ : coarse_;
    list.push_back(std::move(view));
    if (list.size() > (picture.head.fine ? kViews : 1)) {
      dropped_.push_back(list.front().head.id);
      list.erase(list.begin());
    }
  }
  return Done{};
}

void LiveClient::set_objects(std::uint64_t id, const Image<std::uint32_t>& objects) {
  const auto set = [&](LiveView& view) {
    if (view.head.id == id && objects.width() == view.head.width &&
        objects.height() == view.head.height)
      view.keyframe.object = objects;
  };
  for (LiveView& view : views_) set(view);
  for (LiveView& view : coarse_) set(view);
  for (auto& [face, view] : faces_) set(view);
}

void LiveClient::draw(const Camera& frame, LiveFrame& out, bool with_objects) const {
  RILIEVO_EXPECTS(any());
  std::vector<WarpedKeyframe> list;
  double sum = 0;
  for (const LiveView& view : views_) sum += eye_distance(view.keyframe, frame);
  out.error_px = 0;
  for (const LiveView& view : views_)
    if (may_show(view.keyframe.camera, frame)) {
      list.push_back({&view.keyframe, keyframe_weight(view.keyframe, frame, sum)});
      out.error_px = std::max(out.error_px, view.head.error_px);
    }
  spare_weak(list);
  WarpedFrame warped;
  const double pixels = double(frame.width) * frame.height;
  std::size_t alone = std::size_t(pixels);
  if (!list.empty()) {
    warp_keyframes(list, frame, warped);
    alone = warped.holes();
  }
  if (double(alone) > kFewHoles * pixels) {
    // The views, and then those that look where the frame does.
    std::vector<const LiveView*> coarse;
    for (const LiveView& view : coarse_) coarse.push_back(&view);
    for (const auto& [face, view] : faces_) coarse.push_back(&view);
    const auto facing = [&](const LiveView* view) {
      return glm::dot(view->keyframe.camera.forward(), frame.forward());
    };
    std::ranges::stable_sort(coarse,
                             [&](const auto* x, const auto* y) { return facing(x) > facing(y); });
    std::vector<WarpedKeyframe> behind;
    for (const LiveView* view : coarse) {
      if (behind.size() == kMostCoarse || !may_show(view->keyframe.camera, frame)) continue;
      behind.push_back({&view->keyframe, keyframe_weight(view->keyframe, frame, sum)});
    }
    if (!behind.empty()) {
      WarpedFrame filled;
      warp_keyframes(behind, frame, filled);
      if (list.empty())
        warped = std::move(filled);
      else
        fill_holes(filled, warped);
      list.insert(list.end(), behind.begin(), behind.end());
    }
  }
  if (list.empty()) {
    out.color = Rgba8Image(frame.width, frame.height, glm::u8vec4(0));
    out.holes = std::size_t(pixels), out.coarse = 0;
    out.objects = Image<std::uint32_t>(frame.width, frame.height, kNoObject);
    return;
  }
  out.holes = warped.holes();
  out.coarse = alone - std::min(alone, out.holes);
  out.color = opaque_colors(warped.color);
  if (out.holes > 0) dilate_colors(out.color);
  if (with_objects) warp_objects(list, frame, warped, out.objects);
}

}  // namespace rilievo
