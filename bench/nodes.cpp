// Environment nodes seen from their own eyes and between them, and their cost (S3.1 to S3.9).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "bench/benches.h"
#include "bench/node_scenes.h"
#include "bench/report.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/environment_nodes/gl/node_drawer.h"
#include "rilievo/gl/context.h"
#include "rilievo/measure/flip.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/measure/ssim.h"
#include "rilievo/measure/stats.h"
#include "rilievo/render/opengl/frame_target.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo::bench {
namespace {

constexpr const char* kMerges[] = {"layering", "binary", "weighted", "positional"};
constexpr double kPaperFps[] = {9.59, 4.27, 3.58, 3.53};
constexpr glm::u8vec4 kMagenta{255, 0, 255, 255};

struct MadeNode {
  EnvironmentMap map;
  StoredNode stored;
};

Result<MadeNode> make_node(SceneRenderer& renderer, const glm::dvec3& eye, int size,
                           std::size_t triangles) {
  Result<EnvironmentMap> map = capture_node(renderer, eye, size);
  if (!map) return map.error();
  StoredNode stored = StoredNode::create(*map, budget_mesh(*map, triangles));
  return MadeNode{*std::move(map), std::move(stored)};
}

void clear_to_magenta(FrameTarget& target) {
  target.begin();
  const GLfloat magenta[] = {1, 0, 1, 1};
  glClearNamedFramebufferfv(target.framebuffer(), GL_COLOR, 0, magenta);
}

std::size_t count_magenta(const Rgba8Image& picture) {
  return std::size_t(std::count(picture.texels().begin(), picture.texels().end(), kMagenta));
}

// Line 1: a closed room from the node's own eye, and from others.
Result<> from_one_place(const BenchOptions& options, BenchReport& report) {
  const int size = options.quick ? 64 : 512, eyes = options.quick ? 4 : 1000;
  Result<Scene> scene = teapot_room(options.quick);
  if (!scene) return scene.error();
  Result<SceneRenderer> renderer = SceneRenderer::create(*scene);
  if (!renderer) return renderer.error();
  Result<RayScene> rays = RayScene::create(*scene);
  if (!rays) return rays.error();
  const glm::dvec3 place = kRoomNode;
  Result<MadeNode> node = make_node(*renderer, place, size, options.quick ? 1500 : 20000);
  if (!node) return node.error();
  Result<NodeDrawer> drawer = NodeDrawer::create();
  if (!drawer) return drawer.error();
  Result<FrameTarget> target = FrameTarget::create(320, 180, 1);
  if (!target) return target.error();
  const StoredNode* one[] = {&node->stored};

  Random random(7);
  std::vector<double> psnr;
  std::size_t cracks = 0, cracks_off = 0;
  NodeDrawOptions draw_options;
  const auto frame_at = [&](const glm::dvec3& eye) { return any_frame(eye, 320, 180, random); };
  for (int i = 0; i < eyes; ++i) {
    const Camera frame = frame_at(place);
    clear_to_magenta(*target);
    if (Result<> drawn = drawer->draw(frame, one, draw_options); !drawn) return drawn;
    target->resolve();
    const Rgba8Image picture = target->read();
    target->begin();
    drawer->draw_cube_map(frame, node->stored);
    target->resolve();
    cracks += count_magenta(picture);
    // The same picture is as good as 99 dB.
    psnr.push_back(std::min(99.0, psnr_db(target->read(), picture)));
  }
  draw_options.skin = true;
  BenchPicture shown;
  for (int i = 0; i < eyes; ++i) {
    const glm::dvec3 eye = eye_beside(*rays, place, {8, 2, 8}, random);
    const Camera frame = frame_at(eye);
    clear_to_magenta(*target);
    if (Result<> drawn = drawer->draw(frame, one, draw_options); !drawn) return drawn;
    target->resolve();
    const Rgba8Image picture = target->read();
    const std::size_t found = count_magenta(picture);
    if (found > 0 && shown.caption.empty())
      shown = png_picture("An eye with cracks (magenta)", picture);
    cracks_off += found;
  }
  if (!shown.caption.empty()) report.pictures.push_back(std::move(shown));
  const Summary summary = summarize(psnr);
  report.figures.emplace_back("psnr_db_at_node", summary.min);
  report.figures.emplace_back("psnr_db_at_node_mean", summary.mean);
  report.figures.emplace_back("crack_pixels", double(cracks));
  report.figures.emplace_back("crack_pixels_off_node", double(cracks_off));
  report.tables.push_back(
      {fmt::format("A closed room, {} directions and {} eyes", eyes, eyes),
       {"PSNR at the node, least dB", "mean", "cracks at the node", "off the node, with skins"},
       {{fmt::format("{:.1f}", summary.min), fmt::format("{:.1f}", summary.mean),
         std::to_string(cracks), std::to_string(cracks_off)}}});
  return Done{};
}

struct Quality {
  double ms = 0, psnr = 0, ssim = 0, flip = 0, uncovered = 0, psnr_ends = 99;
};

// Line 3: the paper's walk between two nodes of stonehenge.
Result<> between_two(const BenchOptions& options, BenchReport& report) {
  const int size = options.quick ? 48 : 256, frames = options.quick ? 3 : 250;
  const int width = options.quick ? 96 : 640, height = options.quick ? 54 : 360;
  Result<BuiltinScene> scene =
      make_builtin(options.quick ? "builtin:stonehenge?triangles=10000" : "builtin:stonehenge");
  if (!scene) return scene.error();
  Result<SceneRenderer> renderer = SceneRenderer::create(scene->scene);
  if (!renderer) return renderer.error();
  const glm::dvec3 from(0, 1.7, 8), to(-3, 1.7, 8);
  std::vector<MadeNode> nodes;
  for (const glm::dvec3& eye : {from, to}) {
    Result<MadeNode> node = make_node(*renderer, eye, size, options.quick ? 1000 : 5000);
    if (!node) return node.error();
    nodes.push_back(*std::move(node));
  }
  Result<NodeDrawer> drawer = NodeDrawer::create();
  if (!drawer) return drawer.error();
  // One sample for all four merges; the truth has four.
  Result<FrameTarget> target = FrameTarget::create(width, height, 1);
  if (!target) return target.error();
  Result<FrameTarget> true_target = FrameTarget::create(width, height, 4);
  if (!true_target) return true_target.error();
  std::vector<std::uint32_t> visible;
  const auto frame_of = [&](int i) {
    const glm::dvec3 eye = glm::mix(from, to, double(i) / (frames - 1));
    return look_at(eye, {0, 1.9, 0}, {0, 1, 0}, 0.9, width, height, 0.1, 500);
  };
  const auto nearest_first = [&](const Camera& frame) {
    std::vector<const StoredNode*> order{&nodes[0].stored, &nodes[1].stored};
    if (glm::distance(frame.position(), to) < glm::distance(frame.position(), from))
      std::swap(order[0], order[1]);
    return order;
  };
  Quality qualities[4];
  // Frames of all four in turn, so that what else the machine does meets all alike.
  std::vector<double> times[4];
  for (int i = 0; i < frames; ++i) {
    const Camera frame = frame_of(i);
    true_target->begin();
    visible.clear();
    renderer->cull(frame, visible);
    renderer->draw_opaque(frame, visible, OutputEncoding::srgb);
    renderer->draw_sky(frame, OutputEncoding::srgb);
    true_target->resolve();
    const Rgba8Image truth = true_target->read();
    for (int merge = 0; merge < 4; ++merge) {
      NodeDrawOptions draw_options;
      draw_options.merge = NodeMerge(merge);
      const std::vector<const StoredNode*> order = nearest_first(frame);
      gl::finish();
      const Stopwatch watch;
      clear_to_magenta(*target);
      if (Result<> drawn = drawer->draw(frame, order, draw_options); !drawn) return drawn;
      target->resolve();
      gl::finish();
      const double took_ms = watch.ms();
      // The very first frames compile shaders; at the ends only one node is drawn.
      if (i > 0 && i + 1 < frames) times[merge].push_back(took_ms);
      const Rgba8Image picture = target->read();
      Quality& q = qualities[merge];
      const double share = 1.0 / frames;
      q.psnr += share * psnr_db(truth, picture);
      q.uncovered += share * double(count_magenta(picture)) / (double(width) * height);
      if (i % 5 == 0) {
        const double of_these = 1.0 / ((frames + 4) / 5);
        q.ssim += of_these * ssim(truth, picture);
        q.flip += of_these * flip(truth, picture);
      }
      if (i == 0 || i + 1 == frames) {
        target->begin();
        drawer->draw_cube_map(frame, *order[0]);
        target->resolve();
        q.psnr_ends = std::min(q.psnr_ends, psnr_db(target->read(), picture));
      }
      if (i == frames / 2)
        report.pictures.push_back(
            png_picture(fmt::format("In the middle: {}", kMerges[merge]), picture));
    }
    if (i == frames / 2)
      report.pictures.push_back(png_picture("In the middle: the scene itself", truth));
    if (options.progress) options.progress(i, frames);
  }
  Table table{fmt::format("{} frames of {} x {} between two nodes of 6 x {} x {}", frames, width,
                          height, size, size),
              {"merge", "ms", "frames/s", "the paper's", "PSNR dB", "SSIM", "FLIP", "uncovered %",
               "PSNR at the ends dB"},
              {}};
  for (int merge = 0; merge < 4; ++merge) {
    Quality& q = qualities[merge];
    q.ms = median_of(times[merge]);
    table.rows.push_back(
        {kMerges[merge], fmt::format("{:.2f}", q.ms), fmt::format("{:.1f}", 1000 / q.ms),
         fmt::format("{:.2f}", kPaperFps[merge]), fmt::format("{:.2f}", q.psnr),
         fmt::format("{:.4f}", q.ssim), fmt::format("{:.4f}", q.flip),
         fmt::format("{:.3f}", 100 * q.uncovered), fmt::format("{:.1f}", q.psnr_ends)});
    const std::string name = kMerges[merge];
    report.figures.emplace_back("fps_" + name, 1000 / q.ms);
    report.figures.emplace_back("psnr_db_" + name, q.psnr);
    report.figures.emplace_back("ssim_" + name, q.ssim);
    report.figures.emplace_back("flip_" + name, q.flip);
    report.figures.emplace_back("uncovered_" + name, q.uncovered);
    report.figures.emplace_back("psnr_db_at_ends_" + name, q.psnr_ends);
  }
  report.figures.emplace_back("cost_ratio_positional", qualities[3].ms / qualities[0].ms);
  report.tables.push_back(std::move(table));
  return Done{};
}

}  // namespace

Result<BenchReport> nodes(const BenchOptions& options) {
  BenchReport report;
  if (Result<> done = from_one_place(options, report); !done) return done.error();
  if (Result<> done = between_two(options, report); !done) return done.error();
  report.notes = {
      "The room: the built-in teapots between six walls, one node of 20 000 triangles; behind it "
      "all is magenta. Eyes off the node lie where it sees, 0.3 m from surfaces or more.",
      "The walk: nodes of 5 000 triangles each, as many as the paper's; without skins. Frames are "
      "timed with clearing; medians. The truth has four samples a pixel, the nodes' frames one."};
  return report;
}

}  // namespace rilievo::bench
