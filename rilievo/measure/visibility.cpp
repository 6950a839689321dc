#include "rilievo/measure/visibility.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace rilievo {
namespace {

// Calls visit(x, y) for each pixel whose neighbourhood shows one identifier only, row by row.
template <class Visit>
void for_each_counted(const IdImage& ids, int margin, Visit visit) {
  const int w = ids.width(), h = ids.height();
  // A column of the neighbourhood is whole if its identifiers are the same: whole columns that
  // agree are a whole neighbourhood.
  std::vector<std::uint8_t> whole(std::size_t(w), 0);
  for (int y = 0; y < h; ++y) {
    const auto row = ids.row(y);
    std::fill(whole.begin(), whole.end(), std::uint8_t(1));
    for (int j = std::max(y - margin, 0); j <= std::min(y + margin, h - 1); ++j) {
      const auto other = ids.row(j);
      for (int x = 0; x < w; ++x) whole[x] &= row[x] == other[x];
    }
    int left = 0;  // of the run of whole columns that agree, to the right of x
    for (int x = 0, right = 0; x < w; ++x) {
      for (; right <= std::min(x + margin, w - 1); ++right)
        if (!whole[right])
          left = right + 1;
        else if (right > 0 && row[right] != row[right - 1])
          left = std::max(left, right);
      if (left <= std::max(x - margin, 0)) visit(x, y);
    }
  }
}

template <class A, class B>
bool same_size(const A& a, const B& b) {
  return a.width() == b.width() && a.height() == b.height();
}

}  // namespace

Visibility compare_visibility(const IdImage& true_ids, const IdImage& ids, int margin) {
  RILIEVO_EXPECTS(margin >= 0);
  RILIEVO_EXPECTS(same_size(true_ids, ids));
  Visibility v;
  for_each_counted(true_ids, margin, [&](int x, int y) {
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
  for_each_counted(true_ids, 1, [&](int x, int y) {
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
  for_each_counted(true_ids, margin, [&](int x, int y) {
    const std::uint32_t object = true_ids(x, y);
    const bool amid = std::min({x, y, ids.width() - 1 - x, ids.height() - 1 - y}) >= margin;
    if (amid && object != 0 && !drawn.contains(object)) ++counted[object];
  });
  int missing = 0;
  for (const auto& [object, pixels] : counted) missing += pixels >= min_counted;
  return missing;
}

}  // namespace rilievo
