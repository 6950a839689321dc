#include "rilievo/keyframes/make_keyframe.h"

#include <algorithm>
#include <utility>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/keyframes/join_quarters.h"
#include "rilievo/keyframes/keyframe_light.h"
#include "rilievo/render/shading/sky_rays.h"

namespace rilievo {
namespace {

// Fewer rows do not keep all cores busy.
constexpr int kLeastRows = 16;

// Forgets the rows before `row`.
void keep_from(KeyframeBand& band, int row) {
  const std::size_t gone = std::size_t(std::min(row - band.first, band.rows)) * band.stride();
  const auto keep = [&](auto& plane) {
    plane.erase(plane.begin(), plane.begin() + std::ptrdiff_t(gone));
  };
  keep(band.colors), keep(band.inverse_z), keep(band.objects);
  band.rows -= std::min(row - band.first, band.rows), band.first = row;
}

// The rows of the picture come next.
void append(const DepthImage& picture, KeyframeBand& band) {
  const int width = picture.camera.width, height = picture.camera.height, before = band.rows;
  RILIEVO_EXPECTS(band.rows == 0 || band.width == width);
  band.width = width, band.rows += height;
  const std::size_t size = std::size_t(band.rows) * band.stride();
  band.colors.resize(size), band.inverse_z.resize(size), band.objects.resize(size);
  parallel_for(0, height, [&](int y) {
    const std::size_t at = band.at(band.first + before + y);
    std::uint32_t *colors = &band.colors[at], *objects = &band.objects[at];
    float* inverse_z = &band.inverse_z[at];
    srgb_bytes_of(picture.color.row(y).data(), width, colors);
    inverses_of(picture.depth.row(y).data(), width, inverse_z);
    if (picture.object.empty())
      std::fill_n(objects, width, kNoObject);
    else
      std::copy_n(picture.object.row(y).data(), width, objects);
    // Beyond the picture is the same.
    colors[-1] = colors[0], colors[width] = colors[width - 1];
    inverse_z[-1] = inverse_z[0], inverse_z[width] = inverse_z[width - 1];
  });
}

// Rows [top, bottom) and columns [from, to) of the keyframe; the band begins `before` of its own
// columns before them.
void take_over(const KeyframeBand& band, int top, int bottom, int from, int to, int before,
               bool smooth, Keyframe& keyframe) {
  const int last = 2 * keyframe.camera.height - 1;
  parallel_for(top, bottom, [&](int y) {
    float* inverse_z = keyframe.inverse_z.row(y).data() + from;
    std::uint32_t* objects = keyframe.object.row(y).data() + from;
    if (keyframe.quarters()) {
      QuarterRows rows = {};
      for (int i = 0; i < 4; ++i) {
        const std::size_t at = band.at(std::clamp(2 * y + i - 1, 0, last)) + std::size_t(before);
        rows.colors[i] = &band.colors[at], rows.inverse_z[i] = &band.inverse_z[at];
        if (i == 1 || i == 2) rows.objects[i - 1] = &band.objects[at];
      }
      join_quarters(rows, to - from, smooth,
                    {{keyframe.color.row(2 * y).data() + 2 * from,
                      keyframe.color.row(2 * y + 1).data() + 2 * from},
                     inverse_z,
                     objects});
      return;
    }
    const std::size_t at = band.at(y) + std::size_t(before);
    std::copy_n(&band.inverse_z[at], to - from, inverse_z);
    std::copy_n(&band.objects[at], to - from, objects);
    for (int x = from; x < to; ++x)
      keyframe.color(x, y) = band.colors[at + std::size_t(x - from)] | kWholeTexel;
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

// Of a band with quarters, so that with the columns beside it twice its width is no more than the
// rasteriser captures.
constexpr int kMostColumns = 125 * KeyframeMaker::kBand;
static_assert(2 * (kMostColumns + 2) <= Keyframe::kMostRows);

// Columns [from, to) of a camera, at `scale` times its size.
Camera band_of(const Camera& camera, int from, int to, int scale) {
  return supersampled(camera_of_part(camera, from, 0, to - from, camera.height), scale);
}

}  // namespace

void KeyframeMaker::begin(const KeyframeRequest& request, Keyframe reuse) {
  RILIEVO_EXPECTS(request.samples == 1 || request.samples == 4 || request.samples == 16);
  objects_.assign(request.objects.begin(), request.objects.end());
  request_ = request;
  request_.objects = objects_;
  keyframe_ = std::move(reuse);
  resize(keyframe_, request.camera, makes_quarters(request.samples, request.whole_texels));
  keyframe_.coarse = request.coarse, keyframe_.sharp = request.sharp;
  keyframe_.left_out.assign(request.left_out.begin(), request.left_out.end());
  next_ = 0, started_ = by_parts_ = shades_ = false;
}

bool KeyframeMaker::takes_parts(CaptureSource& source) {
  if (!keyframe_.quarters() || request_.samples != 4 || request_.sky) return false;
  if (parts_of_ != &source) parts_of_ = &source, parts_ = source.in_parts();
  return parts_ != nullptr;
}

bool KeyframeMaker::begin_parts(CaptureSource& source, const CaptureControl* control) {
  if (!takes_parts(source)) return false;
  CaptureRequest request = request_to_capture(control);
  request.camera = band_of(keyframe_.camera, 0, keyframe_.camera.width, 2);
  // Too large for it at once, or an error that a band has, too.
  if (!parts_->begin(request)) return false;
  band_.rows = 0, band_.first = 0;
  rows_ = ranges_ = 0;
  return true;
}

CaptureRequest KeyframeMaker::request_to_capture(const CaptureControl* control) const {
  CaptureRequest request;
  request.objects = request_.objects;
  request.samples = keyframe_.quarters() ? request_.samples / 4 : request_.samples;
  // Four quarters of a sample each are the four samples of a texel.
  request.staggered = keyframe_.quarters() && request_.samples == 4;
  request.with_sky = !request_.sky;
  request.control = control;
  request.time = request_.time;
  return request;
}

bool KeyframeMaker::smooth() const {
  return keyframe_.quarters() && request_.samples == 4 && !request_.sharp;
}

void KeyframeMaker::step_of_parts(int columns) {
  const int width = keyframe_.camera.width, height = keyframe_.camera.height;
  const bool last = next_ + columns >= width;
  // Of the last step more than is left.
  const int readable = parts_->advance(last ? 2 : double(columns) / width);
  shades_ = readable > 0;
  next_ = std::min(next_ + columns, width);
  const int read = band_.first + band_.rows;
  if (readable - read < kLeastRows && !last) return;
  // All of them may have been there before the last step.
  if (readable > read) {
    parts_->read(read, readable, rows_of_parts_);
    append(rows_of_parts_, band_);
  }
  // Those whose quarters have sides.
  const int complete = readable == 2 * height ? height : (readable - 1) / 2;
  take_over(band_, rows_, complete, 0, width, 0, smooth(), keyframe_);
  rows_ = complete;
  keep_from(band_, std::max(2 * rows_ - 1, 0));
  const int whole = rows_ == height ? height : rows_ / Keyframe::kRows * Keyframe::kRows;
  find_ranges_of_rows(keyframe_, ranges_, whole);
  ranges_ = whole;
  RILIEVO_EXPECTS(!last || rows_ == height);
}

Result<> KeyframeMaker::step_of_bands(CaptureSource& source, int columns,
                                      const CaptureControl* control) {
  const int width = keyframe_.camera.width;
  const int from = next_, to = std::min(from + columns, width);
  const bool quarters = keyframe_.quarters();
  // With the sides of its quarters.
  const int before = quarters && from > 0 ? 1 : 0, behind = quarters && to < width ? 1 : 0;
  CaptureRequest request = request_to_capture(control);
  request.camera = band_of(keyframe_.camera, from - before, to + behind, quarters ? 2 : 1);
  Result<CapturedPicture> captured = source.capture(request);
  if (!captured) return captured.error();
  if (request_.sky) add_sky(*request_.sky, captured->picture);
  band_.rows = 0, band_.first = 0;
  append(captured->picture, band_);
  take_over(band_, 0, keyframe_.camera.height, from, to, quarters ? 2 * before : before, smooth(),
            keyframe_);
  // Of the segments that are complete now.
  const auto complete = [&](int column) {
    return column == width ? width : column / Keyframe::kColumns * Keyframe::kColumns;
  };
  find_ranges(keyframe_, complete(from), complete(to));
  next_ = to;
  return Done{};
}

Result<> KeyframeMaker::step(CaptureSource& source, int columns, const CaptureControl* control) {
  RILIEVO_EXPECTS(busy());
  // All at once is what a source does at once.
  if (columns < keyframe_.camera.width) start(source, control);
  started_ = true;
  columns = std::max(columns, 1);
  if (by_parts_) {
    step_of_parts(columns);
  } else {
    // Bands are no wider than sources can capture.
    const int most = keyframe_.quarters() ? kMostColumns : 2 * kMostColumns;
    for (int left = (columns + kBand - 1) / kBand * kBand; left > 0 && busy(); left -= most)
      if (Result<> done = step_of_bands(source, std::min(left, most), control); !done) return done;
  }
  if (busy() || !request_.light_rays) return Done{};
  return find_light(*request_.light_rays, objects_, request_.time, keyframe_);
}

void KeyframeMaker::start(CaptureSource& source, const CaptureControl* control) {
  RILIEVO_EXPECTS(busy());
  if (!std::exchange(started_, true)) by_parts_ = begin_parts(source, control);
}

Keyframe KeyframeMaker::take() {
  RILIEVO_EXPECTS(!busy() && !keyframe_.color.empty());
  find_shown(keyframe_);
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
