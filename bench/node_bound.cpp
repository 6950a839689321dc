// A node's bound against what is drawn: whether it holds, and how tight it is.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "bench/benches.h"
#include "bench/node_scenes.h"
#include "rilievo/environment_nodes/cube_grid.h"
#include "rilievo/environment_nodes/error.h"
#include "rilievo/environment_nodes/gl/node_drawer.h"
#include "rilievo/gl/object.h"
#include "rilievo/measure/stats.h"

namespace rilievo::bench {
namespace {

constexpr int kWidth = 160, kHeight = 90;
// What the rasteriser rounds, pixels.
constexpr double kRounding = 0.01;
// A pixel shows a texel if it is no farther from the texel's centre, texels.
constexpr double kNodeNear = 0.1;

// A framebuffer of floats: which direction each pixel shows.
class Directions {
 public:
  Directions() {
    color_ = gl::make_texture_2d(GL_RGBA32F, kWidth, kHeight);
    depth_ = gl::make_texture_2d(GL_DEPTH_COMPONENT32F, kWidth, kHeight);
    framebuffer_ = gl::make_framebuffer();
    glNamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, color_, 0);
    glNamedFramebufferTexture(framebuffer_, GL_DEPTH_ATTACHMENT, depth_, 0);
  }
  // The bottom row first; w is 0 where nothing was drawn.
  const Image<glm::vec4>& draw(NodeDrawer& drawer, const Camera& frame, const StoredNode& node) {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glViewport(0, 0, kWidth, kHeight);
    const GLfloat nothing[] = {0, 0, 0, 0}, far = 1;
    glClearNamedFramebufferfv(framebuffer_, GL_COLOR, 0, nothing);
    glClearNamedFramebufferfv(framebuffer_, GL_DEPTH, 0, &far);
    drawer.draw_directions(frame, node, false);
    glReadPixels(0, 0, kWidth, kHeight, GL_RGBA, GL_FLOAT, shown_.texels().data());
    return shown_;
  }

 private:
  gl::Texture color_, depth_;
  gl::Framebuffer framebuffer_;
  Image<glm::vec4> shown_{kWidth, kHeight};
};

struct Node {
  CubeGrid grid;
  NodeErrorModel model;
  StoredNode stored;
  std::array<Image<float>, 6> seen;
};

Node make(const EnvironmentMap& map, std::size_t triangles) {
  const NodeMesh mesh = budget_mesh(map, triangles);
  Node node{CubeGrid(map, {}), make_error_model(map, mesh), StoredNode::create(map, mesh), {}};
  for (int f = 0; f < 6; ++f) node.seen[std::size_t(f)] = seen_disparity(mesh, f);
  return node;
}

struct MeasuredBound {
  std::size_t pixels = 0, violations = 0;
  double worst = 0;  // pixels
};

// Each pixel that shows a sample's own centre: how far is it from where the sample belongs?
MeasuredBound measure(const Node& node, const Camera& frame, double limit,
                      const Image<glm::vec4>& shown) {
  MeasuredBound m;
  const int n = node.grid.size();
  const glm::dmat4 world = node.model.world_from_node;
  const auto raster_of = [&](const glm::dvec3& c, double disparity) {
    return raster_from_world(frame, glm::dvec3(world * glm::dvec4(c / disparity, 1)));
  };
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const glm::dvec4 direction(shown(x, kHeight - 1 - y));
      if (direction.w == 0) continue;
      const glm::dvec3 d(direction);
      const glm::dvec3 c = d / std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
      std::size_t f = 0;
      while (f < 5 && glm::dot(c, glm::dvec3(face_axes()[f].forward)) < 1 - 1e-6) ++f;
      const FaceAxes& axes = face_axes()[f];
      const glm::dvec2 raster =
          0.5 * n *
          glm::dvec2(1 + glm::dot(c, glm::dvec3(axes.right)), 1 - glm::dot(c, glm::dvec3(axes.up)));
      const glm::ivec2 texel = glm::clamp(glm::ivec2(raster), 0, n - 1);
      const glm::dvec2 off = raster - glm::dvec2(texel) - 0.5;
      if (std::max(std::abs(off.x), std::abs(off.y)) > kNodeNear) continue;
      const glm::dvec3 center = glm::dvec3(node.grid.key(int(f), 2 * texel + 1)) / double(n);
      const double sample = node.grid.at(int(f), texel), drawn = node.seen[f](texel.x, texel.y);
      if (sample <= 0 || drawn <= 0) continue;
      const glm::dvec3 truth = raster_of(center, sample), there = raster_of(center, drawn);
      if (truth.z <= 0.01 || there.z <= 0.01) continue;
      const glm::dvec2 pixel(x + 0.5, y + 0.5);
      // The pixel lies beside the centre by as much as it may.
      const double beside = glm::distance(glm::dvec2(there), pixel);
      const double moved = glm::distance(glm::dvec2(truth), pixel);
      m.violations += moved > limit + beside + kRounding;
      m.worst = std::max(m.worst, moved - beside);
      ++m.pixels;
    }
  return m;
}

}  // namespace

Result<BenchReport> node_bound(const BenchOptions& options) {
  const int size = options.quick ? 24 : 128, eyes = options.quick ? 20 : 10000;
  Result<Scene> scene = teapot_room(options.quick);
  if (!scene) return scene.error();
  Result<SceneRenderer> renderer = SceneRenderer::create(*scene);
  if (!renderer) return renderer.error();
  Result<RayScene> rays = RayScene::create(*scene);
  if (!rays) return rays.error();
  Result<NodeDrawer> drawer = NodeDrawer::create();
  if (!drawer) return drawer.error();
  Directions directions;
  Random random(15);
  std::vector<std::size_t> budgets{500, 2000, 8000};
  std::vector<double> tightness, limits;
  std::size_t violations = 0, pixels = 0, unbounded = 0;
  constexpr int kNodes = 10;
  for (int k = 0; k < kNodes; ++k) {
    const glm::dvec3 place = k == 0 ? kRoomNode : eye_beside(*rays, kRoomNode, {6, 1.5, 5}, random);
    Result<EnvironmentMap> map = capture_node(*renderer, place, size);
    if (!map) return map.error();
    const Node node = make(*map, budgets[std::size_t(k) % budgets.size()]);
    for (int i = 0; i < eyes / kNodes; ++i) {
      const double reach = i % 2 ? 0.25 : 2;
      const glm::dvec3 eye = eye_beside(*rays, place, glm::dvec3(reach), random);
      const Camera frame = any_frame(eye, kWidth, kHeight, random);
      const double limit = bound_px(node.model, frame).error;
      const MeasuredBound m =
          measure(node, frame, limit, directions.draw(*drawer, frame, node.stored));
      violations += m.violations;
      pixels += m.pixels;
      // Half a right angle tells nobody anything.
      if (!(limit < kWidth)) {
        ++unbounded;
        continue;
      }
      limits.push_back(limit);
      if (m.worst > 0) tightness.push_back(limit / m.worst);
    }
    if (options.progress) options.progress(k + 1, kNodes);
  }
  BenchReport report;
  const double median = tightness.empty() ? 0 : median_of(tightness);
  const double limit = limits.empty() ? 0 : median_of(limits);
  report.figures = {{"eyes", double(eyes)},
                    {"pixels", double(pixels)},
                    {"violations", double(violations)},
                    {"median_tightness", median},
                    {"median_bound_px", limit},
                    {"eyes_without_bound", double(unbounded)}};
  report.tables.push_back(
      {fmt::format("{} eyes, nodes of 6 x {} x {}", eyes, size, size),
       {"pixels measured", "violations", "bound by what was measured, median", "bound px, median",
        "eyes without a bound"},
       {{std::to_string(pixels), std::to_string(violations), fmt::format("{:.1f}", median),
         fmt::format("{:.2f}", limit), std::to_string(unbounded)}}});
  report.notes = {
      "The built-in teapots in a closed room, ten nodes of 500, 2 000 and 8 000 triangles. Half of "
      "the eyes lie within 0.25 m of their node along each axis, half within 2 m; they look "
      "anywhere.",
      "MeasuredBound: pixels that show a sample's centre to a tenth of a texel, against where the "
      "sample "
      "belongs. The bound holds for all directions, a frame shows some of them."};
  return report;
}

}  // namespace rilievo::bench
