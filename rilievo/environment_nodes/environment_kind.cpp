#include "rilievo/environment_nodes/environment_kind.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "rilievo/core/place_text.h"
#include "rilievo/environment_nodes/bake_nodes.h"
#include "rilievo/environment_nodes/file.h"
#include "rilievo/environment_nodes/to_scene.h"
#include "rilievo/kind/bounds_facts.h"

namespace rilievo {
namespace {

// Of what is seen from a path its nodes hold so much, if so many can.
constexpr double kEnoughForPath = 0.99999;
constexpr int kMostForPath = 16;
// Of what is seen from a region alone:
constexpr int kForRegion = 4;

const std::array kBakeOptions{
    Option{.name = "at",
           .type = OptionType::points,
           .default_value = "",
           .help = "Where nodes stand, instead of --auto",
           .unit = "X,Y,Z ..."},
    Option{.name = "auto",
           .type = OptionType::integer,
           .default_value = "0",
           .help = "Place so many nodes where they hold most of what is seen from --region; 0: as "
                   "many as hold 99.999 % of it where a path is known, at most 16, else 4",
           .unit = "N",
           .min = 0,
           .max = 256},
    Option{.name = "region",
           .type = OptionType::box,
           .default_value = "",
           .help = "Where eyes will be (default: the path's, or the middle of the scene)",
           .unit = "X0,Y0,Z0,X1,Y1,Z1"},
    Option{.name = "face",
           .type = OptionType::integer,
           .default_value = "512",
           .help = "Texels a side of a face",
           .unit = "N",
           .min = 8,
           .max = 4096},
    Option{.name = "triangles",
           .type = OptionType::integer,
           .default_value = "0",
           .help = "Triangles of a node's surfaces, at most; 0 for as many as the error asks for",
           .unit = "N",
           .min = 0,
           .max = 10'000'000},
    Option{.name = "error-px",
           .type = OptionType::number,
           .default_value = "0.5",
           .help = "No texel is off by more, in texels, for eyes within a quarter of the usual "
                   "distance; with --triangles only if it is given",
           .unit = "E",
           .min = 0.01,
           .max = 1000},
};

const std::array kDrawOptions{
    Option{.name = "merge",
           .type = OptionType::choice,
           .default_value = "positional",
           .help = "How nodes that show the same surface are merged (S3.7); first: the other nodes "
                   "only where the first has gaps (S3.8)",
           .choices = {"layering", "binary", "weighted", "positional", "first"}},
    Option{.name = "nodes",
           .type = OptionType::integer,
           .default_value = "2",
           .help = "So many nodes are merged at a time",
           .unit = "N",
           .min = 1,
           .max = 8},
    Option{.name = "more",
           .type = OptionType::integer,
           .default_value = "1",
           .help = "So many more in frames in which two or more lack something that another holds",
           .unit = "N",
           .min = 0,
           .max = 1},
    Option{.name = "skin",
           .type = OptionType::flag,
           .default_value = "off",
           .help = "Gaps between surfaces are closed by skins (as by default)"},
    Option{.name = "gaps",
           .type = OptionType::flag,
           .default_value = "off",
           .help = "Gaps between surfaces stay open"},
    Option{
        .name = "resident",
        .type = OptionType::integer,
        .default_value = "4",
        .help =
            "So many nodes are in memory at a time, at most, or `nodes` and `more` if that is more",
        .unit = "N",
        .min = 1,
        .max = 256},
};

Result<> check_options(const OptionValues& values) {
  if (values.given("at") && (values.given("auto"))) return Error{"--at", "excludes --auto"};
  return Done{};
}

// `origin` is that of the scene: options count from the world's.
NodeBakeOptions bake_options(const OptionValues& values, const glm::dvec3& origin) {
  NodeBakeOptions bake;
  const std::vector<double> at = values.numbers("at"), region = values.numbers("region");
  for (std::size_t i = 0; i + 2 < at.size(); i += 3)
    bake.at.emplace_back(glm::dvec3(at[i], at[i + 1], at[i + 2]) - origin);
  if (!region.empty())
    bake.placement.region = {glm::dvec3(region[0], region[1], region[2]) - origin,
                             glm::dvec3(region[3], region[4], region[5]) - origin};
  bake.placement.nodes = values.integer("auto");
  bake.face = values.integer("face");
  bake.mesh.triangles = std::size_t(values.integer("triangles"));
  bake.mesh.error_px =
      bake.mesh.triangles == 0 || values.given("error-px") ? values.number("error-px") : 0.0;
  return bake;
}

nlohmann::json list_of(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

Result<Baked> bake(const BakeInput& input, const OptionValues& values, const Progress& progress) {
  if (!input.source.photographs().empty())
    if (Result<> good = values.expect_none_of(
            {"auto", "region"},
            "is for scenes: the nodes of a capture stand where its cameras stood");
        !good)
      return good.error();
  const WorldSpace world = input.source.world();
  NodeBakeOptions options = bake_options(values, world.origin);
  options.objects = input.objects;
  options.progress = progress;
  if (options.placement.region.empty()) {
    options.placement.region = input.eyes;
    options.placement.path = input.eye_path;
  }
  if (values.integer("auto") == 0) {
    options.placement.nodes = input.eyes.empty() ? kForRegion : kMostForPath;
    if (!input.eyes.empty()) options.placement.enough = kEnoughForPath;
  }
  Result<NodeBake> made = bake_nodes(input.source, options);
  if (!made) return made.error();
  Baked baked;
  if (made->held)
    baked.facts.push_back(
        {"visible_share_held", nlohmann::json(*made->held).dump(), "holds",
         fmt::format("{:.2f} % of the surface that is seen from the region", 100 * *made->held)});
  baked.representation = std::make_unique<EnvironmentRepresentation>(std::move(made->nodes));
  baked.representation->world = world;
  return baked;
}

Result<std::unique_ptr<Representation>> load(PictureFile, const std::filesystem::path& path) {
  Result<EnvironmentNodes> nodes = open_environment_nodes(path);
  if (!nodes) return nodes.error();
  return {std::make_unique<EnvironmentRepresentation>(std::move(*nodes))};
}

const EnvironmentNodes& nodes_of(const Representation& representation) {
  return dynamic_cast<const EnvironmentRepresentation&>(representation).nodes;
}

Result<> save(const Representation& representation, const std::filesystem::path& path) {
  return save_environment_nodes(path, nodes_of(representation), representation.world);
}

std::vector<Fact> describe(const Representation& representation) {
  const EnvironmentNodes& nodes = nodes_of(representation);
  const Box bounds = nodes.bounds();
  const double size = double(bounds.radius());
  const glm::dvec3& origin = representation.world.origin;
  nlohmann::json eyes = nlohmann::json::array();
  double covered = 0;
  std::size_t texels = 0;
  int least = nodes.nodes.front().face_size, most = least;
  for (const NodeSketch& node : nodes.nodes) {
    eyes.push_back(list_of(origin + node.eye()));
    covered += node.covered / double(nodes.nodes.size());
    texels += 6 * std::size_t(node.face_size) * std::size_t(node.face_size);
    least = std::min(least, node.face_size), most = std::max(most, node.face_size);
  }
  const auto json = [](const auto& value) { return nlohmann::json(value).dump(); };
  std::vector<Fact> facts{
      {"nodes", json(nodes.nodes.size()), "nodes",
       fmt::format("{} of 6 x {} x {}, the first at {}", nodes.nodes.size(), most, most,
                   place_text(origin + nodes.nodes.front().eye(), size))},
      {"node_eyes", eyes.dump(), "", ""},
      {"face", json(most), "", ""},
      {"least_face", json(least), "", ""},
      {"mesh_triangles", json(nodes.mesh.triangles), "mesh",
       nodes.mesh.triangles > 0
           ? fmt::format("{} triangles a node at most", nodes.mesh.triangles) +
                 (nodes.mesh.error_px > 0 ? fmt::format(", {} texels of error", nodes.mesh.error_px)
                                          : "")
           : fmt::format("at most {} texels of error", nodes.mesh.error_px)},
      {"mesh_error_px", json(nodes.mesh.error_px), "", ""},
      {"texels", json(texels), "texels",
       fmt::format("{:.1f} M, {:.1f} % show a surface, the others the sky or nothing",
                   1e-6 * double(texels), 100 * covered)},
      {"coverage", json(covered), "", ""},
  };
  for (Fact& fact : bounds_facts(bounds, representation.world)) facts.push_back(std::move(fact));
  return facts;
}

Result<Scene> to_scene(const Representation& representation, const SceneRequest& request) {
  const EnvironmentNodes& nodes = nodes_of(representation);
  if (request.part < 0 || std::size_t(request.part) >= nodes.nodes.size())
    return Error{"--node", fmt::format("there is no node {}: there are {}, from 0", request.part,
                                       nodes.nodes.size())};
  const Result<EnvironmentMap> map = load_node(nodes, std::size_t(request.part));
  if (!map) return map.error();
  return scene_from_node(*map, triangulate(*map, nodes.mesh), {.skins = request.closed});
}

// An eye that goes around a node at a twentieth of the way to what is about as far as most, and
// looks past it.
CameraPath around(const NodeSketch& node, double reach) {
  CameraPath path;
  constexpr int kKeys = 8;
  for (int i = 0; i <= kKeys; ++i) {
    const double angle = 2 * std::numbers::pi * i / kKeys;
    const glm::dvec3 out(std::sin(angle), 0, std::cos(angle));
    const glm::dvec3 eye = node.eye() + 0.05 * reach * out;
    path.keys.push_back(look_key(0.5 * i, eye, node.eye() - 4 * reach * out, {0, 1, 0}, 0.9));
  }
  return path;
}

// The median distance of what nodes show.
double usual_distance(const EnvironmentNodes& nodes) {
  std::vector<float> all;
  for (const NodeSketch& node : nodes.nodes)
    for (const Image<float>& face : node.distance)
      for (const float d : face.texels())
        if (d > 0 && std::isfinite(d)) all.push_back(d);
  if (all.empty()) return 1;
  std::nth_element(all.begin(), all.begin() + std::ptrdiff_t(all.size() / 2), all.end());
  return double(all[all.size() / 2]);
}

}  // namespace

CameraPath walk_through(const EnvironmentNodes& nodes) {
  const double reach = usual_distance(nodes);
  CameraPath path;
  // The nearest of those not yet visited comes next.
  std::vector<std::size_t> order{0};
  std::vector<bool> visited(nodes.nodes.size());
  visited[0] = true;
  while (order.size() < nodes.nodes.size()) {
    std::size_t best = 0;
    double least = INFINITY;
    for (std::size_t i = 0; i < nodes.nodes.size(); ++i) {
      const double d = glm::distance(nodes.nodes[i].eye(), nodes.nodes[order.back()].eye());
      if (!visited[i] && d < least) least = d, best = i;
    }
    visited[best] = true;
    order.push_back(best);
  }
  double length = 0;
  for (std::size_t k = 1; k < order.size(); ++k)
    length += glm::distance(nodes.nodes[order[k]].eye(), nodes.nodes[order[k - 1]].eye());
  if (!(length > 1e-6)) {
    path = around(nodes.nodes[0], reach);
  } else {
    double time = 0;
    for (std::size_t k = 0; k < order.size(); ++k) {
      const glm::dvec3 eye = nodes.nodes[order[k]].eye();
      const glm::dvec3 ahead = k + 1 < order.size() ? nodes.nodes[order[k + 1]].eye() - eye
                                                    : eye - nodes.nodes[order[k - 1]].eye();
      if (k > 0)
        time += std::max(0.2, glm::distance(eye, nodes.nodes[order[k - 1]].eye()) / kWalkingSpeed);
      glm::dvec3 level(ahead.x, 0, ahead.z);
      if (!(glm::length(level) > 1e-6)) level = {0, 0, -1};
      path.keys.push_back(look_key(time, eye, eye + level, {0, 1, 0}, 0.9));
    }
  }
  path.z_near = std::max(1e-4, 0.005 * reach);
  path.z_far = std::max(2 * path.z_near, 4 * double(nodes.bounds().radius()) + 20 * reach);
  return path;
}

std::optional<CameraPath> EnvironmentRepresentation::walk() const { return walk_through(nodes); }

const Kind& environment_nodes_kind() {
  static const Kind kind{
      .name = kEnvironmentNodesName,
      .summary = "six-sided pictures around points, through which an eye walks",
      .bake_options = kBakeOptions,
      .draw_options = kDrawOptions,
      .stands_for = StandsFor::surroundings,
      .bake = bake,
      .check_options = check_options,
      .matches = matches_environment_nodes,
      .reads_later = true,
      .load = load,
      .save = save,
      .describe = describe,
      .to_scene = to_scene,
  };
  return kind;
}

}  // namespace rilievo
