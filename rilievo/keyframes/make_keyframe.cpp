#include "rilievo/keyframes/make_keyframe.h"

#include <algorithm>
#include <utility>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/keyframes/join_quarters.h"
#include "rilievo/render/shading/sky_rays.h"

namespace rilievo {
namespace {

// Columns [from, to) of the keyframe; the picture begins `before` columns before them.
void take_over(const DepthImage& picture, int from, int to, int before, bool smooth,
               KeyframeBand& band, Keyframe& keyframe) {
  const int width = picture.camera.width, height = picture.camera.height;
  // With a quarter on either side.
  if (band.colors.width() != width + 2 || band.colors.height() != height) {
    band.colors = Image<std::uint32_t>(width + 2, height);
    band.inverse_z = Image<float>(width + 2, height);
  }
  parallel_for(0, height, [&](int y) {
    std::uint32_t* colors = band.colors.row(y).data();
    float* inverse_z = band.inverse_z.row(y).data();
    srgb_bytes_of(picture.color.row(y).data(), width, colors + 1);
    inverses_of(picture.depth.row(y).data(), width, inverse_z + 1);
    // Beyond the picture is the same.
    colors[0] = colors[1], colors[width + 1] = colors[width];
    inverse_z[0] = inverse_z[1], inverse_z[width + 1] = inverse_z[width];
  });
  const bool objects = !picture.object.empty();
  parallel_for(0, keyframe.camera.height, [&](int y) {
    if (keyframe.quarters()) {
      QuarterRows rows = {};
      for (int i = 0; i < 4; ++i) {
        const int row = std::clamp(2 * y + i - 1, 0, height - 1);
        rows.colors[i] = band.colors.row(row).data() + 1 + 2 * before;
        rows.inverse_z[i] = band.inverse_z.row(row).data() + 1 + 2 * before;
      }
      for (int i = 0; i < 2 && objects; ++i)
        rows.objects[i] = picture.object.row(2 * y + i).data() + 2 * before;
      join_quarters(rows, to - from, smooth,
                    {{keyframe.color.row(2 * y).data() + 2 * from,
                      keyframe.color.row(2 * y + 1).data() + 2 * from},
                     keyframe.inverse_z.row(y).data() + from,
                     keyframe.object.row(y).data() + from});
      return;
    }
    for (int x = from; x < to; ++x) {
      const int column = x - from + before;
      keyframe.color(x, y) = band.colors(1 + column, y) | kWholeTexel;
      keyframe.object(x, y) = objects ? picture.object(column, y) : kNoObject;
      keyframe.inverse_z(x, y) = band.inverse_z(1 + column, y);
    }
  });
}

// The sky behind texels that are covered in part, or not at all.
void add_sky(const Sky& sky, DepthImage& picture) {
  const SkyRays rays(picture.camera);
  parallel_for(0, picture.camera.height, [&](int y) {
    for (int x = 0; x < picture.camera.width; ++x) {
      glm::vec4& color = picture.color(x, y);
      if (picture.covered(x, y)) {
        // A texel shows one surface: all of it, whatever else its samples saw.
        if (color.a > 0) color = glm::vec4(glm::vec3(color) / color.a, 1);
      } else {
        color = glm::vec4(rays.radiance(sky, x, picture.camera.height - 1 - y), 1);
      }
    }
  });
}

// Columns [from, to) of a camera, at `scale` times its size.
Camera band_of(const Camera& camera, int from, int to, int scale) {
  Camera band = camera;
  const ImageWindow& w = camera.window;
  const double per_column = (w.right - w.left) / camera.width;
  band.window.left = w.left + from * per_column;
  band.window.right = w.left + to * per_column;
  band.width = (to - from) * scale, band.height = camera.height * scale;
  return band;
}

}  // namespace

void KeyframeMaker::begin(const KeyframeRequest& request, Keyframe reuse) {
  RILIEVO_EXPECTS(request.samples == 1 || request.samples == 4 || request.samples == 16);
  objects_.assign(request.objects.begin(), request.objects.end());
  request_ = request;
  request_.objects = objects_;
  keyframe_ = std::move(reuse);
  resize(keyframe_, request.camera,
         request.samples == 16 || (request.samples == 4 && !request.whole_texels));
  keyframe_.coarse = request.coarse;
  keyframe_.left_out.assign(request.left_out.begin(), request.left_out.end());
  next_ = 0;
}

Result<> KeyframeMaker::step(CaptureSource& source, int columns, const CaptureControl* control) {
  RILIEVO_EXPECTS(busy());
  const int width = keyframe_.camera.width;
  const int whole = (std::max(columns, 1) + kBand - 1) / kBand * kBand;
  const int from = next_, to = std::min(from + whole, width);
  const bool quarters = keyframe_.quarters();
  const bool smooth = quarters && request_.samples == 4;
  // With the sides of its quarters.
  const int before = quarters && from > 0 ? 1 : 0, behind = quarters && to < width ? 1 : 0;
  CaptureRequest request;
  request.camera = band_of(keyframe_.camera, from - before, to + behind, quarters ? 2 : 1);
  request.objects = request_.objects;
  request.samples = quarters ? request_.samples / 4 : request_.samples;
  request.with_sky = !request_.sky;
  request.control = control;
  request.time = request_.time;
  Result<CapturedPicture> captured = source.capture(request);
  if (!captured) return captured.error();
  if (request_.sky) add_sky(*request_.sky, captured->picture);
  take_over(captured->picture, from, to, before, smooth, band_, keyframe_);
  // Of the segments that are complete now.
  const auto complete = [&](int column) {
    return column == width ? width : column / Keyframe::kColumns * Keyframe::kColumns;
  };
  find_ranges(keyframe_, complete(from), complete(to));
  next_ = to;
  return Done{};
}

Keyframe KeyframeMaker::take() {
  RILIEVO_EXPECTS(!busy() && !keyframe_.color.empty());
  return std::exchange(keyframe_, {});
}

Keyframe KeyframeMaker::give_up() {
  next_ = 1 << 30;
  return std::exchange(keyframe_, {});
}

Result<Keyframe> make_keyframe(CaptureSource& source, const KeyframeRequest& request,
                               const CaptureControl* control) {
  KeyframeMaker maker;
  maker.begin(request);
  if (Result<> done = maker.step(source, request.camera.width, control); !done) return done.error();
  return {maker.take()};
}

}  // namespace rilievo
