// How much of an object its pictures hold (S2.1, S2.2; figures 2 and 5).
//
// The share of the surface that is visible from outside and sampled: by one back-perspective
// picture against one ordinary picture (the mean over 32 directions), and by 12, 20 and 32
// back-perspective ones. Six objects; figures covered_OBJECT_back_1, _ordinary_1, _12, _20, _32,
// and _seen_32 with every point counted as often as it is seen.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "bench/analyze_coverage.h"
#include "bench/benches.h"
#include "bench/coverage_pictures.h"
#include "bench/objects.h"
#include "rilievo/capture/view_set.h"
#include "rilievo/measure/stats.h"

namespace rilievo::bench {
namespace {

Result<std::vector<Camera>> cameras_of(const Box& box, ViewSpread spread, Projection projection) {
  ViewSetOptions views;
  views.spread = spread;
  ViewCameraOptions options;
  options.projection = projection;
  std::vector<Camera> cameras;
  for (const glm::dvec3& direction : make_view_set(views).directions) {
    Result<Camera> camera = view_camera(box, direction, options);
    if (!camera) return camera.error();
    cameras.push_back(*camera);
  }
  return cameras;
}

// Of each camera alone: the share of the points that it samples.
std::vector<double> shares_alone(const RayScene& rays, const std::vector<Camera>& cameras,
                                 const std::vector<SurfacePoint>& points) {
  std::vector<double> shares;
  for (const Camera& camera : cameras) {
    std::size_t sampled = 0;
    for (const SurfacePoint& point : points)
      sampled += std::isfinite(sample_spacing(rays, camera, point));
    shares.push_back(double(sampled) / double(points.size()));
  }
  return shares;
}

std::string percent(double share) { return fmt::format("{:.2f}", 100 * share); }

constexpr std::pair<int, ViewSpread> kSets[] = {
    {12, ViewSpread::faces_12}, {20, ViewSpread::vertices_20}, {32, ViewSpread::both_32}};

struct Tables {
  Table one{
      "One picture: percent of the surface visible from outside that it samples, over 32 "
      "directions",
      {"object", "ordinary, mean", "least", "most", "back-perspective, mean", "least", "most",
       "times more"},
      {}};
  Table many{"12, 20 and 32 back-perspective pictures: percent of it that at least one samples",
             {"object", "visible, % of all", "12", "20", "32", "by two of 32", "seen, 12",
              "seen, 32", "32 ordinary"},
             {}};
  Table density{
      "Texels of 256 no farther apart than 1 % of the object's radius: percent of the "
      "surface visible from outside",
      {"object", "12", "20", "32"},
      {}};
};

Result<> add_object(const BenchObject& object, const CoverageOptions& options, BenchReport& report,
                    Tables& tables) {
  const Result<RayScene> rays = RayScene::create(object.scene);
  if (!rays) return rays.error();
  const Box box = world_bounds(object.scene);
  // Without a camera every visible point is missed.
  const std::vector<SurfacePoint> visible = analyze_coverage(*rays, {}, options).missed;
  if (visible.empty()) return Error{object.name, "none of its surface is visible"};
  const auto figure = [&](const std::string& name, double value) {
    report.figures.emplace_back(fmt::format("covered_{}_{}", object.name, name), value);
  };

  std::vector<std::string> one{object.name};
  double means[2] = {};
  int kind = 0;
  for (const auto& [projection, name] : {std::pair(Projection::perspective, "ordinary_1"),
                                         std::pair(Projection::back_perspective, "back_1")}) {
    const Result<std::vector<Camera>> cameras = cameras_of(box, ViewSpread::both_32, projection);
    if (!cameras) return cameras.error();
    const Summary shares = summarize(shares_alone(*rays, *cameras, visible));
    means[kind++] = shares.mean;
    figure(name, shares.mean);
    for (const double share : {shares.mean, shares.min, shares.max}) one.push_back(percent(share));
  }
  one.push_back(fmt::format("{:.2f}", means[1] / means[0]));
  tables.one.rows.push_back(std::move(one));

  std::vector<std::string> many{object.name}, density{object.name};
  double seen_12 = 0;
  Coverage last;
  for (const auto& [count, spread] : kSets) {
    const Result<std::vector<Camera>> cameras =
        cameras_of(box, spread, Projection::back_perspective);
    if (!cameras) return cameras.error();
    last = analyze_coverage(*rays, *cameras, options);
    figure(std::to_string(count), last.covered_share);
    if (count == 12) {
      many.push_back(percent(last.visible_share));
      seen_12 = last.covered_seen_share;
    }
    many.push_back(percent(last.covered_share));
    density.push_back(percent(share_within(last, 0.01 * last.radius)));
  }
  const Result<std::vector<Camera>> ordinary =
      cameras_of(box, ViewSpread::both_32, Projection::perspective);
  if (!ordinary) return ordinary.error();
  const Coverage by_ordinary = analyze_coverage(*rays, *ordinary, options);
  figure("ordinary_32", by_ordinary.covered_share);
  figure("seen_32", last.covered_seen_share);
  for (const double share :
       {last.covered_twice_share, seen_12, last.covered_seen_share, by_ordinary.covered_share})
    many.push_back(percent(share));
  tables.many.rows.push_back(std::move(many));
  tables.density.rows.push_back(std::move(density));
  return Done{};
}

}  // namespace

Result<BenchReport> coverage(const BenchOptions& options) {
  const std::vector<BenchObject> objects = bench_objects(options.quick ? 3000 : 30000);
  CoverageOptions coverage_options;
  if (options.quick) coverage_options.points = 500, coverage_options.viewpoints = 32;
  BenchReport report;
  Tables tables;
  const int total = int(objects.size()) + 2;
  int done = 0;
  for (const BenchObject& object : objects) {
    if (options.progress) options.progress(done++, total);
    if (Result<> added = add_object(object, coverage_options, report, tables); !added)
      return added.error();
  }
  report.tables = {std::move(tables.one), std::move(tables.many), std::move(tables.density)};
  for (const std::size_t shown : {0, 3}) {
    Result<std::vector<BenchPicture>> pictures = figure_2(objects[shown], options.quick ? 48 : 320);
    if (!pictures) return pictures.error();
    for (BenchPicture& picture : *pictures) report.pictures.push_back(std::move(picture));
  }
  if (options.progress) options.progress(done++, total);
  Result<std::vector<BenchPicture>> pictures = figure_5(objects[0], options.quick ? 24 : 128);
  if (!pictures) return pictures.error();
  for (BenchPicture& picture : *pictures) report.pictures.push_back(std::move(picture));
  if (options.progress) options.progress(total, total);

  std::string what = "The objects: ";
  for (const BenchObject& object : objects)
    what += fmt::format("{}{} ({})", &object == &objects[0] ? "" : "; ", object.name, object.what);
  report.notes = {
      fmt::format(
          "{} points spread evenly over each surface, on both sides of what is "
          "double-sided. Visible from outside: in a straight line from one of {} viewpoints "
          "at {} radii. Apexes and eyes at 2 radii.",
          coverage_options.points, coverage_options.viewpoints, coverage_options.viewpoint_radii),
      "\"Seen\": every point counts as often as viewpoints see it, so that what shows through a "
      "crack counts little, as does the teapot's inside, which shows through the gap around its "
      "lid and through its spout.",
      what + "."};
  return report;
}

}  // namespace rilievo::bench
