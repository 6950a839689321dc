#include "rilievo/environment_nodes/environment_drawable.h"

#include <algorithm>
#include <limits>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "rilievo/environment_nodes/environment_kind.h"
#include "rilievo/environment_nodes/node_outline.h"
#include "rilievo/environment_nodes/nodes_for_frame.h"
#include "rilievo/environment_nodes/working_set.h"

namespace rilievo {
namespace {

// In triangles, on a software rasteriser: a node's mesh, and a pixel of a merge of two.
constexpr double kTriangles = 20000;
constexpr double kPixel = 0.05;
// Triangles of a node that has as many as the error asks for, a texel of its faces: of an indoor
// scene, roughly; each takes so many bytes with its vertices.
constexpr double kTrianglesATexel = 0.05;
constexpr std::size_t kTriangleBytes = 40;

// The same frame, seen from the world of the capture. Nothing if that is no rigid motion or uniform
// scale.
std::optional<Camera> captured_frame(const Camera& frame, const glm::dmat4& world_from_capture) {
  const double scale = glm::length(glm::dvec3(world_from_capture[0]));
  if (!(scale > 0)) return std::nullopt;
  const glm::dmat4 inverse = glm::inverse(world_from_capture);
  Camera camera = frame;
  camera.world_from_eye = inverse * frame.world_from_eye;
  for (int k = 0; k < 3; ++k) camera.world_from_eye[k] *= scale;
  camera.z_near /= scale;
  camera.z_far /= scale;
  return camera;
}

}  // namespace

Result<EnvironmentDrawOptions> environment_draw_options(const OptionValues& values) {
  EnvironmentDrawOptions options;
  const std::string& merge = values.text("merge");
  options.draw.merge = merge == "layering"   ? NodeMerge::layering
                       : merge == "binary"   ? NodeMerge::binary
                       : merge == "weighted" ? NodeMerge::weighted
                       : merge == "first"    ? NodeMerge::first
                                             : NodeMerge::positional;
  if (values.flag("gaps") && values.flag("skin")) return Error{"--gaps", "excludes --skin"};
  options.draw.skin = !values.flag("gaps");
  options.resident = std::size_t(values.integer("resident"));
  options.nodes = std::size_t(values.integer("nodes"));
  options.fills = values.integer("more") > 0 && options.nodes > 1 && options.nodes < kMaxDrawnNodes;
  // What is merged must be in memory.
  options.resident = std::max(options.resident, options.nodes + (options.fills ? 1 : 0));
  return options;
}

struct EnvironmentDrawable::State {
  State(EnvironmentNodes made, std::unique_ptr<NodeStore> with, const EnvironmentDrawOptions& how)
      : nodes(std::move(made)),
        store(std::move(with)),
        options(how),
        working(nodes, how.resident) {}

  EnvironmentNodes nodes;
  std::unique_ptr<NodeStore> store;
  EnvironmentDrawOptions options;
  // Of nodes that have been in memory, or asked for.
  mutable std::map<std::size_t, NodeErrorModel> errors;
  mutable std::mutex errors_mutex;
  // The last frame for which nodes were chosen.
  mutable std::optional<std::pair<Camera, FrameNodes>> last;
  mutable std::mutex last_mutex;
  NodeWorkingSet working;
  std::vector<std::size_t> drawn;
  FrameParts filled;                                        // what the last of them is there for
  std::map<std::size_t, std::vector<glm::dvec3>> outlines;  // of the nodes in memory
  std::vector<glm::dvec3> lines;  // kept, so that drawing does not allocate
  std::optional<Sky> sky = nodes.sky();

  void take_all() {
    while (std::optional<LoadedNode> loaded = working.take()) {
      store->keep(loaded->node, loaded->map, loaded->mesh);
      outlines[loaded->node] = node_outline(loaded->mesh);
      const std::lock_guard lock(errors_mutex);
      errors.insert_or_assign(loaded->node, std::move(loaded->error));
    }
  }

  // A frame is drawn more than once, and bounds are asked for it. Any thread.
  [[nodiscard]] FrameNodes chosen(const Camera& frame) const {
    const std::lock_guard lock(last_mutex);
    if (!last || last->first != frame)
      last.emplace(frame, nodes_for_frame(nodes, frame, options.nodes, options.fills));
    return last->second;
  }

  // Into `drawn`, the best first, and `filled`.
  void choose(const Camera& frame) {
    const auto [order, count, parts] = chosen(frame);
    working.want(order, [&](std::size_t node) {
      store->drop(node);
      outlines.erase(node);
    });
    drawn.clear();
    for (std::size_t k = 0; k < count; ++k) {
      take_all();
      if (!store->holds(order[k]) && working.wait_for(order[k])) take_all();
    }
    for (std::size_t k = 0; k < count; ++k)
      if (store->holds(order[k])) drawn.push_back(order[k]);
    filled = parts;
    options.draw.last_in = count > options.nodes && drawn.size() == count ? &filled : nullptr;
  }

  [[nodiscard]] double bound(const Camera& frame) const {
    const auto [order, count, parts] = chosen(frame);
    const std::lock_guard lock(errors_mutex);
    double widest = 0;
    for (std::size_t k = 0; k < count; ++k) {
      auto found = errors.find(order[k]);
      if (found == errors.end()) {
        Result<LoadedNode> loaded = load_and_triangulate(nodes, order[k]);
        if (!loaded) return std::numeric_limits<double>::infinity();
        found = errors.emplace(order[k], std::move(loaded->error)).first;
      }
      const NodeBound px = bound_px(found->second, frame);
      widest = std::max(widest, px.error + px.disc +
                                    (nodes.strokes.texels > 0
                                         ? strip_difference_px(nodes.strokes.texels, px.half_texel)
                                         : 0));
      // A gap shows what no node has seen, unless another node fills it: not counted on.
      if (k == 0) widest = std::max(widest, px.gap);
      // At a node's own place only that one is drawn.
      if (k == 0 && px.error == 0 && px.gap == 0) break;
    }
    return widest;
  }
};

EnvironmentDrawable::EnvironmentDrawable(EnvironmentNodes nodes, std::unique_ptr<NodeStore> store,
                                         const EnvironmentDrawOptions& options)
    : state_(std::make_unique<State>(std::move(nodes), std::move(store), options)) {}

EnvironmentDrawable::~EnvironmentDrawable() = default;

std::string_view EnvironmentDrawable::kind() const { return kEnvironmentNodesName; }

void EnvironmentDrawable::draw(const Camera& frame, std::span<const Instance> instances,
                               Output output) {
  State& s = *state_;
  s.store->begin();
  for (const Instance& instance : instances) {
    const std::optional<Camera> captured = captured_frame(frame, instance.world_from_capture);
    if (!captured) continue;
    s.choose(*captured);
    if (s.drawn.empty()) continue;
    s.store->draw(*captured, glm::length(glm::dvec3(instance.world_from_capture[0])), s.drawn,
                  output, instance.object, s.options.draw);
  }
}

// Of two nodes that show a surface, one is off by up to the tolerance. So lines are drawn nearer to
// the eye by as much, where they are seen at the same place.
void EnvironmentDrawable::draw_outlines(const Camera& frame, std::span<const Instance> instances) {
  State& s = *state_;
  const glm::dvec3 eye = frame.position();
  s.lines.clear();
  for (const Instance& instance : instances) {
    const std::optional<Camera> captured = captured_frame(frame, instance.world_from_capture);
    if (!captured) continue;
    s.choose(*captured);
    for (const std::size_t node : s.drawn)
      for (const glm::dvec3& end : s.outlines[node]) {
        const glm::dvec3 at(instance.world_from_capture * glm::dvec4(end, 1));
        s.lines.push_back(glm::mix(at, eye, double(s.options.draw.tolerance)));
      }
  }
  s.store->draw_lines(frame, s.lines);
}

void EnvironmentDrawable::set_samples(int samples) { state_->store->set_samples(samples); }

const TileDrawer* EnvironmentDrawable::tiles() const { return state_->store->tiles(); }

const TileDrawer* EnvironmentDrawable::outline_tiles() const {
  return state_->store->outline_tiles();
}

ErrorModel EnvironmentDrawable::error_model(std::uint32_t) const {
  ErrorModel model;
  model.bounds = state_->nodes.bounds();
  // The state outlives the model: who asks for it holds the drawable.
  model.store<const State*>(state_.get());
  model.bound = [](const ErrorModel& of, const glm::dmat4& world_from_capture,
                   const Camera& frame) {
    const std::optional<Camera> captured = captured_frame(frame, world_from_capture);
    return captured ? of.load<const State*>()->bound(*captured)
                    : std::numeric_limits<double>::infinity();
  };
  return model;
}

CostTerms EnvironmentDrawable::cost_terms(std::uint32_t) const {
  const double triangles =
      state_->nodes.mesh.triangles > 0 ? double(state_->nodes.mesh.triangles) : kTriangles;
  return {0, kPixel, triangles * double(state_->options.nodes)};
}

std::size_t EnvironmentDrawable::bytes() const {
  return state_->nodes.bytes() + state_->store->bytes();
}

const Sky* EnvironmentDrawable::sky() const { return state_->sky ? &*state_->sky : nullptr; }

std::size_t EnvironmentDrawable::most_in_memory() const { return state_->working.most_in_memory(); }

std::optional<Error> EnvironmentDrawable::error() const { return state_->working.error(); }

namespace {

class EnvironmentFactory final : public DrawableFactory {
 public:
  explicit EnvironmentFactory(MakeNodeStore make_store) : make_store_(std::move(make_store)) {}

  [[nodiscard]] std::size_t expected_bytes(const OptionValues& bake,
                                           const OptionValues& draw) const override {
    const auto face = std::size_t(bake.integer("face"));
    const auto asked = std::size_t(bake.integer("triangles"));
    const std::size_t texels = 6 * face * face;
    const std::size_t triangles =
        asked > 0 ? asked : std::size_t(kTrianglesATexel * double(texels));
    const Result<EnvironmentDrawOptions> options = environment_draw_options(draw);
    return (options ? options->resident : 1) * (8 * texels + kTriangleBytes * triangles);
  }
  [[nodiscard]] Result<std::unique_ptr<Drawable>> make_drawable(
      std::unique_ptr<Representation> representation, const OptionValues& draw) override {
    const Result<EnvironmentDrawOptions> options = environment_draw_options(draw);
    if (!options) return options.error();
    auto& environment = dynamic_cast<EnvironmentRepresentation&>(*representation);
    return {std::make_unique<EnvironmentDrawable>(std::move(environment.nodes), make_store_(),
                                                  *options)};
  }

 private:
  MakeNodeStore make_store_;
};

}  // namespace

std::unique_ptr<DrawableFactory> make_environment_factory(MakeNodeStore make_store) {
  return std::make_unique<EnvironmentFactory>(std::move(make_store));
}

}  // namespace rilievo
