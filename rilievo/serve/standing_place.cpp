#include "rilievo/serve/standing_place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "rilievo/core/image.h"

namespace rilievo {
namespace {

constexpr double kEyeHeight = 1.7, kHeadroom = 2.2;
// The middle of a scene that is looked at, and its columns each way.
constexpr double kMiddle = 60;
constexpr int kColumns = 120;
// Ground is level where it rises by less within so many columns; and it lies no higher over the
// rest of the ground.
constexpr double kLevel = 0.4, kAboveOthers = 1;
constexpr int kAround = 1;
// Places that are looked around from, how far apart, and rays of a side of a quarter.
constexpr std::size_t kPlaces = 24;
constexpr double kApart = 3;
constexpr int kRays = 24;
// Things are of interest from here to there; nearer ones are in the way. Sky counts little.
constexpr double kTooNear = 0.8, kFarEnough = 25, kSky = 3;
constexpr double kVerticalFov = 0.9;

struct Place {
  glm::dvec3 feet{0.0};
  double from_middle = 0;
};

// The lowest ground of each column with room above it: its y, or NaN.
Image<float> ground_of(const LayeredDepthImage& columns, double top) {
  const int size = columns.camera.width;
  Image<float> ground(size, size, NAN);
  for (int i = 0; i < size * size; ++i) {
    double above = HUGE_VAL;  // the y of what is over the surface
    for (auto s = columns.first[std::size_t(i)]; s < columns.first[std::size_t(i) + 1]; ++s) {
      const double y = top - double(columns.samples[s].depth);
      if (above - y > kHeadroom) ground.texels()[std::size_t(i)] = float(y);
      above = y;
    }
  }
  return ground;
}

bool is_level(const Image<float>& ground, int x, int y) {
  if (x < kAround || y < kAround || x + kAround >= ground.width() || y + kAround >= ground.height())
    return false;
  for (int j = -kAround; j <= kAround; ++j)
    for (int i = -kAround; i <= kAround; ++i)
      if (!(std::abs(ground(x + i, y + j) - ground(x, y)) < kLevel)) return false;
  return true;
}

std::vector<Place> places_on(const Image<float>& ground, const Camera& from_above) {
  std::vector<float> heights;
  for (const float y : ground.texels())
    if (!std::isnan(y)) heights.push_back(y);
  if (heights.empty()) return {};
  std::ranges::nth_element(heights, heights.begin() + std::ptrdiff_t(heights.size() / 2));
  const double usual = double(heights[heights.size() / 2]);
  std::vector<Place> all;
  for (int y = 0; y < ground.height(); ++y)
    for (int x = 0; x < ground.width(); ++x) {
      const double height = double(ground(x, y));
      if (!(height < usual + kAboveOthers) || !is_level(ground, x, y)) continue;
      Place place;
      place.feet = world_from_raster(from_above, {x + 0.5, y + 0.5}, 1);
      place.feet.y = height;
      const glm::dvec3 off = place.feet - from_above.position();
      place.from_middle = std::hypot(off.x, off.z);
      all.push_back(place);
    }
  std::ranges::stable_sort(all, {}, &Place::from_middle);
  std::vector<Place> some;
  for (const Place& place : all) {
    if (some.size() == kPlaces) break;
    if (std::ranges::all_of(some, [&](const Place& other) {
          return glm::length(other.feet - place.feet) > kApart;
        }))
      some.push_back(place);
  }
  return some;
}

// How much one sees through a camera; negative: something is in the way.
double view_of(CaptureSource& source, const Camera& camera) {
  LayersRequest request;
  request.camera = camera, request.max_layers = 1;
  const Result<LayeredDepthImage> seen = source.capture_layers(request);
  if (!seen) return -1;
  double sum = 0;
  const std::size_t rays = seen->first.size() - 1;
  for (std::size_t i = 0; i < rays; ++i) {
    if (seen->first[i] == seen->first[i + 1]) {
      sum += kSky;
      continue;
    }
    const double z = double(seen->samples[seen->first[i]].depth);
    if (z < kTooNear) return -1;
    sum += std::min(z, kFarEnough);
  }
  return sum / double(rays);
}

}  // namespace

std::optional<Camera> standing_place(CaptureSource& source) {
  const Box bounds = source.bounds({});
  if (bounds.empty()) return std::nullopt;
  const glm::dvec3 extent(bounds.extent()), center(bounds.center());
  if (!(std::min(extent.x, extent.z) >= kLeastWalk)) return std::nullopt;
  const double half = 0.5 * std::min({extent.x, extent.z, kMiddle});
  const double top = double(bounds.max.y) + 1;
  LayersRequest request;
  Camera& above = request.camera;
  above = look_at({center.x, top, center.z}, {center.x, top - 1, center.z}, {0, 0, -1}, 1, kColumns,
                  kColumns, 0.5, extent.y + 2);
  above.projection = Projection::parallel;
  above.window = {-half, half, -half, half};
  const Result<LayeredDepthImage> columns = source.capture_layers(request);
  if (!columns) return std::nullopt;
  std::optional<Camera> best;
  double most = 0;
  for (const Place& place : places_on(ground_of(*columns, top), above)) {
    const glm::dvec3 eye = place.feet + glm::dvec3(0, kEyeHeight, 0);
    std::array<double, 4> views{};
    double sum = 0, best_view = 0;
    glm::dvec3 look{0.0};
    for (std::size_t k = 0; k < 4; ++k) {
      const glm::dvec3 ahead(k == 0 ? 1 : k == 1 ? -1 : 0, 0, k == 2 ? 1 : k == 3 ? -1 : 0);
      const Camera quarter = look_at(eye, eye + ahead, {0, 1, 0}, 1.5708, kRays, kRays, 0.05,
                                     4 * double(bounds.radius()) + 1);
      views[k] = view_of(source, quarter);
      sum += views[k];
      if (views[k] > best_view) best_view = views[k], look = ahead;
    }
    if (std::ranges::any_of(views, [](double view) { return view < 0; }) || sum <= most) continue;
    most = sum;
    best = look_at(eye, eye + look, {0, 1, 0}, kVerticalFov, 1, 1, 0.1,
                   4 * double(bounds.radius()) + 1);
  }
  return best;
}

}  // namespace rilievo
