#include "rilievo/measure/visibility.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace rilievo {
namespace {

// Calls visit(x, y) for each pixel whose 3 x 3 neighbourhood shows one identifier only, row by row.
template <class Visit>
void for_each_counted(const IdImage& ids, Visit visit) {
  const int w = ids.width(), h = ids.height();
  // A column of three is whole if its identifiers are the same: then three whole columns that agree
  // are a whole neighbourhood.
  std::vector<std::uint8_t> whole(std::size_t(w), 0);
  for (int y = 0; y < h; ++y) {
    const auto row = ids.row(y);
    const auto above = ids.row(std::max(y - 1, 0)), below = ids.row(std::min(y + 1, h - 1));
    for (int x = 0; x < w; ++x) whole[x] = row[x] == above[x] && row[x] == below[x];
    for (int x = 0; x < w; ++x) {
      const int left = std::max(x - 1, 0), right = std::min(x + 1, w - 1);
      if (whole[x] && whole[left] && whole[right] && row[x] == row[left] && row[x] == row[right])
        visit(x, y);
    }
  }
}

template <class A, class B>
bool same_size(const A& a, const B& b) {
  return a.width() == b.width() && a.height() == b.height();
}

}  // namespace

Visibility compare_visibility(const IdImage& true_ids, const IdImage& ids) {
  RILIEVO_EXPECTS(same_size(true_ids, ids));
  Visibility v;
  for_each_counted(true_ids, [&](int x, int y) {
    const std::uint32_t wanted = true_ids(x, y), shown = ids(x, y);
    ++v.counted;
    v.wrong += wanted != shown;
    v.counted_objects += wanted != 0;
    v.uncovered += wanted != 0 && shown == 0;
  });
  return v;
}

void add_depth_errors(const IdImage& true_ids, const IdImage& ids, const Image<float>& true_eye_z,
                      const Image<float>& eye_z, Histogram& errors) {
  RILIEVO_EXPECTS(same_size(true_ids, ids));
  RILIEVO_EXPECTS(same_size(true_ids, true_eye_z) && same_size(true_ids, eye_z));
  const auto usable = [](float z) { return z > 0 && std::isfinite(z); };
  for_each_counted(true_ids, [&](int x, int y) {
    const float wanted = true_eye_z(x, y), shown = eye_z(x, y);
    if (true_ids(x, y) == 0 || true_ids(x, y) != ids(x, y) || !usable(wanted) || !usable(shown))
      return;
    errors.add(std::abs(shown - wanted) / wanted);
  });
}

int count_missing_objects(const IdImage& true_ids, const IdImage& ids, int margin,
                          int min_counted) {
  RILIEVO_EXPECTS(true_ids.width() == ids.width() && true_ids.height() == ids.height());
  const std::unordered_set<std::uint32_t> drawn(ids.texels().begin(), ids.texels().end());
  std::unordered_map<std::uint32_t, int> counted;  // of objects that are not drawn
  const auto all_around = [&](int x, int y, std::uint32_t object) {
    for (int dy = -margin; dy <= margin; ++dy)
      for (int dx = -margin; dx <= margin; ++dx)
        if (true_ids(x + dx, y + dy) != object) return false;
    return true;
  };
  for (int y = margin; y < ids.height() - margin; ++y)
    for (int x = margin; x < ids.width() - margin; ++x) {
      const std::uint32_t object = true_ids(x, y);
      if (object != 0 && !drawn.contains(object) && all_around(x, y, object)) ++counted[object];
    }
  int missing = 0;
  for (const auto& [object, pixels] : counted) missing += pixels >= min_counted;
  return missing;
}

}  // namespace rilievo
