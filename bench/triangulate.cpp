// A node's depths as few triangles, against a regular grid and against a full grid that a mesh
// simplifier has made smaller; and the time that it takes (S3.2).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <vector>

#include "bench/benches.h"
#include "bench/node_rivals.h"
#include "bench/timing.h"
#include "rilievo/environment_nodes/cube_grid.h"
#include "rilievo/environment_nodes/error.h"
#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo::bench {
namespace {

// In front of the torus, and to the left of that.
const glm::dvec3 kEyes[] = {{0, 1.7, 8}, {-3, 1.7, 8}};

EnvironmentMap cast_node(const RayScene& rays, const glm::dvec3& eye, int size) {
  EnvironmentMap map;
  const std::array<Camera, 6> cameras = environment_cameras(eye, size, 0.05, 1000);
  for (std::size_t f = 0; f < 6; ++f) map.faces[f] = cast_picture(rays, cameras[f], {.sky = true});
  return map;
}

// Of all texels that show something; what a mesh leaves open does not count against it.
struct Wrong {
  double squares = 0, largest = 0;
  std::size_t texels = 0;
  [[nodiscard]] double rms() const { return std::sqrt(squares / double(texels)); }
  [[nodiscard]] double psnr_db() const { return 20 * std::log10(largest / rms()); }
};

void add(const CubeGrid& grid, const NodeMesh& mesh, Wrong& wrong) {
  for (int f = 0; f < 6; ++f) {
    const Image<float> seen = seen_disparity(mesh, f);
    for (std::size_t i = 0; i < seen.texels().size(); ++i) {
      const float sample = grid.disparity(f).texels()[i], drawn = seen.texels()[i];
      if (sample < 0 || drawn < 0) continue;
      wrong.squares += double(drawn - sample) * double(drawn - sample);
      wrong.largest = std::max(wrong.largest, double(sample));
      ++wrong.texels;
    }
  }
}

}  // namespace

Result<BenchReport> triangulate_nodes(const BenchOptions& options) {
  const int size = options.quick ? 48 : 256, large = options.quick ? 64 : 512;
  Result<BuiltinScene> scene =
      make_builtin(options.quick ? "builtin:stonehenge?triangles=10000" : "builtin:stonehenge");
  if (!scene) return scene.error();
  Result<RayScene> rays = RayScene::create(scene->scene);
  if (!rays) return rays.error();
  std::vector<EnvironmentMap> nodes;
  for (const glm::dvec3& eye : kEyes) nodes.push_back(cast_node(*rays, eye, size));

  BenchReport report;
  Table table{fmt::format("Two nodes of stonehenge, 6 x {0} x {0}", size),
              {"triangles", "of skins", "RMS ours 1/m", "grid", "meshoptimizer", "PSNR ours dB",
               "grid", "meshoptimizer"},
              {}};
  std::vector<std::size_t> counts{1000, 2500, 5000, 10000, 25000};
  if (options.quick) counts = {1000, 2500};
  Curve ours_curve{"ours", {}, {}}, grid_curve{"grid", {}, {}},
      other_curve{"meshoptimizer", {}, {}};
  int done = 0;
  for (const std::size_t count : counts) {
    Wrong ours, grid, other[3];
    std::size_t skins = 0;
    for (const EnvironmentMap& node : nodes) {
      const CubeGrid samples(node, {});
      TriangulateOptions triangulation;
      triangulation.triangles = count;
      triangulation.error_px = 0;
      const NodeMesh mesh = triangulate(node, triangulation);
      skins += (mesh.triangles() - mesh.surface_triangles()) / nodes.size();
      add(samples, mesh, ours);
      add(samples, grid_mesh(node, count), grid);
      const float weights[] = {0.3f, 1, 3};
      for (int k = 0; k < 3; ++k) add(samples, simplified_mesh(node, count, weights[k]), other[k]);
    }
    // The rival at its best.
    const Wrong& best = *std::min_element(
        other, other + 3, [](const Wrong& a, const Wrong& b) { return a.rms() < b.rms(); });
    table.rows.push_back({std::to_string(count), std::to_string(skins),
                          fmt::format("{:.5f}", ours.rms()), fmt::format("{:.5f}", grid.rms()),
                          fmt::format("{:.5f}", best.rms()), fmt::format("{:.1f}", ours.psnr_db()),
                          fmt::format("{:.1f}", grid.psnr_db()),
                          fmt::format("{:.1f}", best.psnr_db())});
    const std::string name = count % 1000 ? fmt::format("{}k{}", count / 1000, count % 1000 / 100)
                                          : fmt::format("{}k", count / 1000);
    const std::pair<const char*, const Wrong*> all[] = {
        {"ours", &ours}, {"grid", &grid}, {"meshopt", &best}};
    for (const auto& [who, wrong] : all) {
      report.figures.emplace_back(fmt::format("rms_disparity_{}_{}", who, name), wrong->rms());
      report.figures.emplace_back(fmt::format("psnr_db_{}_{}", who, name), wrong->psnr_db());
    }
    const std::pair<Curve*, double> points[] = {
        {&ours_curve, ours.rms()}, {&grid_curve, grid.rms()}, {&other_curve, best.rms()}};
    for (const auto& [curve, rms] : points) {
      curve->x.push_back(double(count));
      curve->y.push_back(rms);
    }
    if (options.progress) options.progress(++done, int(counts.size()) + 1);
  }

  const EnvironmentMap node = cast_node(*rays, kEyes[0], large);
  TriangulateOptions triangulation;
  triangulation.triangles = 25000;
  triangulation.error_px = 0;
  const int runs = options.quick ? 1 : 9;
  const double ms =
      median_ms(runs, 0, [&] { static_cast<void>(triangulate(node, triangulation)); });
  std::vector<float> copy(std::size_t(large) * std::size_t(large));
  const double copy_ms = median_ms(runs, 0, [&] {
    for (const DepthImage& face : node.faces)
      std::memcpy(copy.data(), face.depth.texels().data(), copy.size() * sizeof(float));
  });
  report.figures.emplace_back("ms_triangulate_512_25k", ms);
  report.figures.emplace_back("ratio_to_memcpy", ms / copy_ms);
  report.tables = {std::move(table),
                   {fmt::format("6 x {0} x {0} to 25 000 triangles", large),
                    {"ms", "memcpy of the depths ms", "times"},
                    {{fmt::format("{:.1f}", ms), fmt::format("{:.3f}", copy_ms),
                      fmt::format("{:.0f}", ms / copy_ms)}}}};
  report.plots = {{"Error of few triangles",
                   "triangles",
                   "RMS of disparity, 1/m",
                   {ours_curve, grid_curve, other_curve},
                   true,
                   true,
                   true}};
  report.notes = {
      "RMS over all texels of both nodes, at their centres; PSNR: of the largest disparity by "
      "that.",
      "`triangles`: of surfaces, the same for all three. A grid's triangles that span silhouettes "
      "count among them; our skins, `of skins`, are drawn besides where gaps are to be filled.",
      "meshoptimizer: meshopt_simplify of a vertex a texel, the best of three weights of disparity "
      "against place, faces each by itself; what it leaves open does not count."};
  return report;
}

}  // namespace rilievo::bench
