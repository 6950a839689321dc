// The cost of layered impostors (S2.5, S2.8; tables 2 and 3, figure 8).
//
// Memory against the paper's tables; slices left after empty ones are dropped and what their
// rectangles save; what filling holes adds; time per draw over on-screen size for 64, 128 and 256
// layers against triangles drawn directly. Figures memory_mb_VIEWS_SIZE, draw_ms_LAYERS_220,
// break_even_triangles_LAYERS_220 and so on.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/benches.h"
#include "bench/layered_frames.h"
#include "bench/objects.h"
#include "bench/timing.h"
#include "rilievo/capture/gl/opengl_source.h"
#include "rilievo/layered_impostor/bake.h"
#include "rilievo/measure/stats.h"
#include "rilievo/render/opengl/frame_target.h"
#include "rilievo/scene/builtin/parts.h"

namespace rilievo::bench {
namespace {

constexpr std::pair<int, ViewSpread> kSets[] = {
    {12, ViewSpread::faces_12}, {20, ViewSpread::vertices_20}, {32, ViewSpread::both_32}};
constexpr int kSizes[] = {64, 128, 256};
// Table 2 of the paper, MB, and table 3, vertices; rows are views, columns sizes.
constexpr double kPaperMb[3][3] = {
    {0.197, 0.786, 3.146}, {0.328, 1.311, 5.243}, {0.524, 2.097, 8.389}};
constexpr int kPaperVertices[3][3] = {
    {5461, 21845, 87381}, {9102, 36409, 145636}, {14564, 58254, 233017}};
constexpr double kVertexBytes = 36;  // position, normal, colour, texture coordinates
// Figure 8: on an SGI O2, 64 layers on 220 x 220 pixels cost as much as 2000 triangles, of which it
// drew 200 000 a second.
constexpr int kPaperPixels = 220, kPaperTriangles = 2000;
constexpr double kPaperTrianglesPerMs = 200;
constexpr int kLayers[] = {64, 128, 256};
constexpr int kTriangles[] = {2000, 20000, 100000, 400000};

Result<LayeredImpostor> bake(SceneRenderer& renderer, ViewSpread spread, int size, int layers,
                             bool fills) {
  BakeOptions options;
  options.views.spread = spread;
  options.camera.size = size;
  options.slicing.layers = layers;
  options.fills = fills;
  OpenGLSource source(renderer);
  return bake_layered(source, {}, options);
}

Result<> add_memory(SceneRenderer& teapot, bool quick, BenchReport& report) {
  Table memory{"Table 2: memory of the pictures, MB (10^6 bytes)",
               {"views", "size", "the paper's", "4 bytes a texel", "on the GPU, slices",
                "on the GPU, surfaces"},
               {}};
  Table vertices{"Table 3: vertices of a polygonal model of equal size, 36 bytes each",
                 {"views", "size", "the paper's", "4 bytes a texel", "on the GPU, slices"},
                 {}};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) {
      const auto& [views, spread] = kSets[row];
      const int size = kSizes[column];
      if (quick && (row != 2 || column != 2)) continue;
      Result<LayeredImpostor> impostor = bake(teapot, spread, size, 64, false);
      if (!impostor) return impostor.error();
      const double bytes = double(analyze_layered_impostor(*impostor).paper_bytes);
      Result<LayeredPictures> sliced = LayeredPictures::create(*impostor);
      if (!sliced) return sliced.error();
      (void)sliced->interval_texture();
      Result<LayeredPictures> walked = LayeredPictures::create(std::move(*impostor));
      if (!walked) return walked.error();
      (void)walked->surface_textures();
      const auto mb = [](double b) { return fmt::format("{:.3f}", b / 1e6); };
      memory.rows.push_back({std::to_string(views), std::to_string(size),
                             fmt::format("{:.3f}", kPaperMb[row][column]), mb(bytes),
                             mb(double(sliced->bytes())), mb(double(walked->bytes()))});
      vertices.rows.push_back({std::to_string(views), std::to_string(size),
                               std::to_string(kPaperVertices[row][column]),
                               fmt::format("{:.0f}", std::floor(bytes / kVertexBytes)),
                               fmt::format("{:.0f}", double(sliced->bytes()) / kVertexBytes)});
      report.figures.emplace_back(fmt::format("memory_mb_{}_{}", views, size), bytes / 1e6);
      report.figures.emplace_back(fmt::format("gpu_mb_slices_{}_{}", views, size),
                                  double(sliced->bytes()) / 1e6);
    }
  report.tables.push_back(std::move(memory));
  report.tables.push_back(std::move(vertices));
  return Done{};
}

Result<> add_slices(const std::vector<BenchObject>& objects, bool quick, BenchReport& report) {
  Table table{"Slices left, their rectangles, and what filling holes adds; 32 views",
              {"object", "size", "layers", "slices a view", "dropped", "fill left %",
               "a neighbour's slices", "their fill %"},
              {}};
  for (const BenchObject& object : objects) {
    Result<SceneRenderer> renderer = SceneRenderer::create(object.scene);
    if (!renderer) return renderer.error();
    const bool first = &object == &objects[0];
    for (const auto& [size, layers] : {std::pair(256, 16), {256, 64}, {256, 256}, {64, 64}}) {
      if (!first && (size != 256 || layers != 64)) continue;
      if (quick && layers != 64) continue;
      const Result<LayeredImpostor> impostor =
          bake(*renderer, ViewSpread::both_32, quick ? size / 8 : size, layers, true);
      if (!impostor) return impostor.error();
      const LayeredStats f = analyze_layered_impostor(*impostor);
      const double views = double(impostor->pictures.size());
      table.rows.push_back({object.name, std::to_string(size), std::to_string(layers),
                            fmt::format("{:.1f}", double(f.slices) / views),
                            fmt::format("{:.1f}", double(f.empty_slices) / views),
                            fmt::format("{:.1f}", 100 * f.fill_share),
                            fmt::format("{:.1f}", f.hole_slices),
                            fmt::format("{:.1f}", 100 * f.hole_fill_share)});
      const std::string suffix = fmt::format("{}_32_{}_{}", object.name, size, layers);
      report.figures.emplace_back("fill_saved_" + suffix, f.fill_saved);
      report.figures.emplace_back("hole_fill_share_" + suffix, f.hole_fill_share);
    }
  }
  report.tables.push_back(std::move(table));
  return Done{};
}

// Median over draws into a frame that the object's box fills, one sample a pixel.
Result<double> draw_ms(int size, int draws, const std::function<void()>& draw) {
  Result<FrameTarget> target = FrameTarget::create(size, size, 1);
  if (!target) return target.error();
  // The first compiles.
  return finished_ms(draws, 1, [&] { target->begin(), draw(); });
}

Result<Camera> filling_camera(const Box& box, int size) {
  Result<Camera> camera =
      tight_camera(Projection::perspective,
                   glm::dvec3(box.center()) +
                       4.0 * double(box.radius()) * glm::normalize(glm::dvec3(0.3, 0.35, 1)),
                   {0, 1, 0}, box);
  if (camera) camera->width = camera->height = size;
  return camera;
}

// How many triangles cost `ms`, between those that were timed; the ends where it is outside.
double triangles_for(double ms, std::span<const double> times) {
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (ms > times[i] && i + 1 < times.size()) continue;
    const double t = std::log(ms / times[i - 1]) / std::log(times[i] / times[i - 1]);
    const double n =
        std::log(kTriangles[i - 1]) + t * (std::log(kTriangles[i]) - std::log(kTriangles[i - 1]));
    return std::exp(n);
  }
  return 0;
}

Result<> add_times(SceneRenderer& teapot, const BenchOptions& options, BenchReport& report) {
  const std::vector<int> sizes =
      options.quick ? std::vector<int>{40, kPaperPixels}
                    : std::vector<int>{10, 20, 40, 80, 120, 160, kPaperPixels, 260, 300};
  const int draws = options.quick ? 1 : 15, picture = options.quick ? 32 : 256;
  Result<LayeredDrawer> drawer = LayeredDrawer::create();
  if (!drawer) return drawer.error();
  const Box box = world_bounds(teapot.scene());
  const LayeredInstance here;
  int done = 0;
  const int total = int(std::size(kLayers) + 1 + std::size(kTriangles));
  std::vector<Curve> curves;
  const auto time = [&](std::string name,
                        const std::function<void(const Camera&)>& draw) -> Result<> {
    Curve curve{std::move(name), {}, {}};
    for (const int size : sizes) {
      const Result<Camera> camera = filling_camera(box, size);
      if (!camera) return camera.error();
      const Result<double> ms = draw_ms(size, draws, [&] { draw(*camera); });
      if (!ms) return ms.error();
      curve.x.push_back(size);
      curve.y.push_back(*ms);
    }
    curves.push_back(std::move(curve));
    if (options.progress) options.progress(++done, total);
    return Done{};
  };
  for (const int layers : kLayers) {
    Result<LayeredImpostor> impostor =
        bake(teapot, ViewSpread::both_32, picture, layers, layers == kLayers[0]);
    if (!impostor) return impostor.error();
    Result<LayeredPictures> pictures = LayeredPictures::create(std::move(*impostor));
    if (!pictures) return pictures.error();
    LayeredOptions slices;
    slices.method = LayeredMethod::slices;
    slices.max_views = 1;
    slices.handover = 0;
    if (Result<> timed = time(fmt::format("{} layers", layers),
                              [&](const Camera& camera) {
                                drawer->draw(*pictures, camera, {&here, 1}, slices);
                              });
        !timed)
      return timed;
    if (layers != kLayers[0]) continue;
    slices.max_views = 3;
    if (Result<> timed = time("64 layers, holes filled",
                              [&](const Camera& camera) {
                                drawer->draw(*pictures, camera, {&here, 1}, slices);
                              });
        !timed)
      return timed;
    if (Result<> timed = time("surfaces",
                              [&](const Camera& camera) {
                                drawer->draw(*pictures, camera, {&here, 1}, {});
                              });
        !timed)
      return timed;
  }
  const std::size_t layered_curves = curves.size();
  for (const int triangles : kTriangles) {
    const BuiltinScene built = make_single_teapot(std::uint64_t(triangles));
    Result<SceneRenderer> renderer = SceneRenderer::create(built.scene);
    if (!renderer) return renderer.error();
    const std::uint32_t object = 0;
    if (Result<> timed = time(fmt::format("{} triangles", triangles),
                              [&](const Camera& camera) {
                                renderer->draw_opaque(camera, {&object, 1}, OutputEncoding::srgb);
                              });
        !timed)
      return timed;
  }

  Table table{"Figure 8: ms a draw, and how many triangles drawn directly cost the same", {}, {}};
  table.columns = {"drawn as"};
  for (const int size : sizes) table.columns.push_back(fmt::format("{} px", size));
  table.columns.push_back(fmt::format("triangles at {} px", kPaperPixels));
  const std::size_t at =
      std::size_t(std::find(sizes.begin(), sizes.end(), kPaperPixels) - sizes.begin());
  std::vector<double> direct;
  for (std::size_t c = layered_curves; c < curves.size(); ++c) direct.push_back(curves[c].y[at]);
  const char* const names[] = {"64", "64_filled", "surfaces", "128", "256"};
  for (std::size_t c = 0; c < curves.size(); ++c) {
    std::vector<std::string> row{curves[c].name};
    for (const double ms : curves[c].y) row.push_back(fmt::format("{:.2f}", ms));
    if (c < layered_curves) {
      const double triangles = triangles_for(curves[c].y[at], direct);
      row.push_back(fmt::format("{:.0f}", triangles));
      report.figures.emplace_back(fmt::format("draw_ms_{}_{}", names[c], kPaperPixels),
                                  curves[c].y[at]);
      report.figures.emplace_back(fmt::format("break_even_triangles_{}_{}", names[c], kPaperPixels),
                                  triangles);
    } else {
      row.push_back(std::to_string(kTriangles[c - layered_curves]));
    }
    table.rows.push_back(std::move(row));
  }
  std::vector<std::string> paper{"the paper, 64 layers, SGI O2"};
  paper.resize(sizes.size() + 1);
  paper[at + 1] = fmt::format("{:.2f}", kPaperTriangles / kPaperTrianglesPerMs);
  paper.push_back(std::to_string(kPaperTriangles));
  table.rows.push_back(std::move(paper));
  report.tables.push_back(std::move(table));
  curves.push_back({"the paper's break-even: 64 layers, 2000 triangles, SGI O2",
                    {double(kPaperPixels)},
                    {kPaperTriangles / kPaperTrianglesPerMs}});
  report.plots.push_back({"Figure 8: time per draw over on-screen size",
                          "frame that the object fills, pixels", "ms", std::move(curves), false,
                          true, true});
  return Done{};
}

}  // namespace

Result<BenchReport> layered_cost(const BenchOptions& options) {
  const std::vector<BenchObject> objects = bench_objects(options.quick ? 3000 : 20000);
  Result<SceneRenderer> teapot = SceneRenderer::create(objects[0].scene);
  if (!teapot) return teapot.error();
  BenchReport report;
  if (Result<> added = add_times(*teapot, options, report); !added) return added.error();
  if (Result<> added = add_memory(*teapot, options.quick, report); !added) return added.error();
  if (Result<> added = add_slices(objects, options.quick, report); !added) return added.error();
  report.notes = {
      "Figure 8: the teapot's box fills the frame; one sample a pixel; median of 15 draws, clear "
      "included, nothing else. Slices are those of the nearest of 32 views of 256; \"holes "
      "filled\" adds those of two neighbours; surfaces are the walk with its defaults. The paper's "
      "O2 drew 200 000 independent triangles a second, hence 10 ms.",
      "On the GPU: 8-bit colour and, for slices, two 16-bit depths a texel; for the walk "
      "disparities, slopes and links. The paper packs RGB and depth into 4 bytes.",
      "Fill left: texels in the slices' rectangles over those of whole slices, before empty ones "
      "are dropped. A neighbour's fill: of its own slices' rectangles."};
  return report;
}

}  // namespace rilievo::bench
