#include "rilievo/keyframes/keyframe.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <span>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

int parts(int whole, int part) { return (whole + part - 1) / part; }

// Of some texels of a row. Numbers above 0 compare as their bits do, as integers; so written that a
// compiler makes vectors of it.
InverseRange range_of(std::span<const float> inverse_z) {
  constexpr std::int32_t kNone = std::numeric_limits<std::int32_t>::max();
  std::int32_t nearest = 0, farthest = kNone;
  for (const float w : inverse_z) {
    const std::int32_t bits = std::bit_cast<std::int32_t>(w);
    nearest = std::max(nearest, bits);
    farthest = std::min(farthest, bits > 0 ? bits : kNone);
  }
  if (nearest == 0) return {};
  return {std::bit_cast<float>(farthest), std::bit_cast<float>(nearest)};
}

// The ranges of a block, and of its segments.
void find_block(Keyframe& keyframe, int column, int row) {
  const int top = row * Keyframe::kRows,
            bottom = std::min(top + Keyframe::kRows, keyframe.camera.height);
  const int left = column * Keyframe::kColumns,
            right = std::min(left + Keyframe::kColumns, keyframe.camera.width);
  InverseRange& block = keyframe.blocks(column, row) = {};
  for (int y = top; y < bottom; ++y) {
    const std::span<const float> depths = keyframe.inverse_z.row(y);
    const InverseRange& range = keyframe.segments(column, y) =
        range_of(depths.subspan(std::size_t(left), std::size_t(right - left)));
    block.add(range);
  }
}

}  // namespace

void InverseRange::add(float inverse_z) {
  if (inverse_z <= 0) return;
  if (empty()) farthest = nearest = inverse_z;
  farthest = std::min(farthest, inverse_z), nearest = std::max(nearest, inverse_z);
}

void InverseRange::add(const InverseRange& other) {
  if (other.empty()) return;
  add(other.farthest);
  add(other.nearest);
}

void resize(Keyframe& keyframe, const Camera& camera, bool quarters) {
  RILIEVO_EXPECTS(camera.projection == Projection::perspective);
  const int width = camera.width, height = camera.height;
  keyframe.camera = camera;
  keyframe.left_out.clear(), keyframe.hidden.clear(), keyframe.shown.clear();
  keyframe.light.cells.resize(0, 0);
  keyframe.color.resize(quarters ? 2 * width : width, quarters ? 2 * height : height);
  keyframe.inverse_z.resize(width, height);
  keyframe.object.resize(width, height);
  keyframe.segments.resize(parts(width, Keyframe::kColumns), height);
  keyframe.blocks.resize(keyframe.segments.width(), parts(height, Keyframe::kRows));
}

void find_ranges(Keyframe& keyframe, int from, int to) {
  RILIEVO_EXPECTS(from % Keyframe::kColumns == 0);
  RILIEVO_EXPECTS(to % Keyframe::kColumns == 0 || to == keyframe.camera.width);
  parallel_for(0, keyframe.blocks.height(), [&](int row) {
    for (int i = from / Keyframe::kColumns; i * Keyframe::kColumns < to; ++i)
      find_block(keyframe, i, row);
  });
}

void find_ranges_of_rows(Keyframe& keyframe, int from, int to) {
  RILIEVO_EXPECTS(from % Keyframe::kRows == 0);
  RILIEVO_EXPECTS(to % Keyframe::kRows == 0 || to == keyframe.camera.height);
  parallel_for(0, keyframe.blocks.width(), [&](int i) {
    for (int row = from / Keyframe::kRows; row * Keyframe::kRows < to; ++row)
      find_block(keyframe, i, row);
  });
}

void hide_objects(Keyframe& keyframe, std::span<const std::uint32_t> objects) {
  if (std::ranges::equal(keyframe.hidden, objects)) return;
  keyframe.hidden.assign(objects.begin(), objects.end());
  parallel_for(0, keyframe.blocks.height(), [&](int block) {
    const int top = block * Keyframe::kRows,
              bottom = std::min(top + Keyframe::kRows, keyframe.camera.height);
    for (int y = top; y < bottom; ++y) {
      float* const inverse_z = keyframe.inverse_z.row(y).data();
      const std::span<const std::uint32_t> shown = keyframe.object.row(y);
      // Texels beside each other mostly show one object.
      for (std::size_t from = 0, to = 0; from < shown.size(); from = to) {
        const std::uint32_t object = shown[from];
        while (to < shown.size() && shown[to] == object) ++to;
        const bool hides = object != kNoObject && std::ranges::binary_search(objects, object - 1);
        // All of it has one sign.
        if (std::signbit(inverse_z[from]) == hides) continue;
        for (std::size_t x = from; x < to; ++x) inverse_z[x] = -inverse_z[x];
      }
    }
    for (int column = 0; column < keyframe.blocks.width(); ++column)
      find_block(keyframe, column, block);
  });
}

void find_shown(Keyframe& keyframe) {
  std::vector<std::uint32_t>& shown = keyframe.shown;
  shown.clear();
  // First a mark for each object, then the marks' places.
  std::uint32_t last = kNoObject;
  for (const std::uint32_t object : keyframe.object.texels()) {
    if (object == last) continue;
    last = object;
    if (object == kNoObject) continue;
    if (object > shown.size()) shown.resize(object);
    shown[object - 1] = 1;
  }
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < shown.size(); ++i)
    if (shown[i]) shown[count++] = i;
  shown.resize(count);
}

Rgba8Image opaque_colors(const Image<std::uint32_t>& color) {
  Rgba8Image colors(color.width(), color.height(), glm::u8vec4(0));
  for (std::size_t i = 0; i < colors.texels().size(); ++i) {
    const std::uint32_t c = color.texels()[i];
    if (c != 0) colors.texels()[i] = {c & 0xFF, c >> 8 & 0xFF, c >> 16 & 0xFF, 255};
  }
  return colors;
}

Camera keyframe_camera(const Camera& frame, KeyframeMargin margin, double texels, int most_rows) {
  RILIEVO_EXPECTS(margin.x >= 1 && margin.y >= 1 && texels > 0);
  // Three are what is rounded up.
  texels = std::min(texels, (most_rows - 3) / (margin.y * frame.height));
  Camera camera = frame;
  // As many texels on either side, so that a pixel's texels keep their places.
  const auto wider = [&](int pixels, double times) {
    const int more = int(std::ceil((times - 1) * pixels * texels / 2 - 1e-9));
    return std::max(1, int(std::ceil(pixels * texels - 1e-9)) + 2 * more);
  };
  camera.width = wider(frame.width, margin.x), camera.height = wider(frame.height, margin.y);
  const ImageWindow& w = frame.window;
  const double x = (w.left + w.right) / 2, y = (w.bottom + w.top) / 2;
  const double half_x = (w.right - w.left) / frame.width / texels * camera.width / 2,
               half_y = (w.top - w.bottom) / frame.height / texels * camera.height / 2;
  camera.window = {x - half_x, x + half_x, y - half_y, y + half_y};
  return camera;
}

}  // namespace rilievo
