#include "rilievo/environment_nodes/bake_nodes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "rilievo/core/parallel_for.h"
#include "rilievo/environment_nodes/cube_grid.h"

namespace rilievo {
namespace {

// Views belong to one node if they are no farther apart, in metres.
constexpr double kOnePoint = 1e-3;
// A face's planes, in radii of what there is to see.
constexpr double kNear = 1e-4, kFar = 4;

Result<> capture_faces(CaptureSource& source, const glm::dvec3& eye, const NodeBakeOptions& options,
                       double radius, std::size_t node, std::vector<DepthImage>& pictures) {
  const double reach = std::max(radius, 1e-3);
  const std::array<Camera, 6> cameras =
      environment_cameras(eye, options.face, std::max(1e-3, kNear * reach), kFar * reach + 1);
  for (std::size_t f = 0; f < 6; ++f) {
    Result<CapturedPicture> face = source.capture({.camera = cameras[f],
                                                   .objects = options.objects,
                                                   .samples = options.samples,
                                                   .with_sky = true});
    if (!face) return face.error();
    face->picture.name = fmt::format("node {:02} face {}", node, f);
    pictures.push_back(std::move(face->picture));
  }
  return Done{};
}

// The farthest that anything may be from an eye.
double reach_of(const Box& bounds, const std::vector<glm::dvec3>& eyes) {
  double reach = 0;
  for (const glm::dvec3& eye : eyes)
    for (const glm::vec3& corner : bounds.corners())
      reach = std::max(reach, glm::distance(eye, glm::dvec3(corner)));
  return 0.3 * reach;
}

Result<NodeBake> bake_photographs(CaptureSource& source, const NodeBakeOptions& options) {
  const std::span<const DepthImage> views = source.photographs();
  const std::string name(source.name());
  if (!options.at.empty())
    return Error{name, "is no scene: its nodes stand where its cameras stood, not elsewhere"};
  std::vector<std::vector<DepthImage>> groups;
  for (const DepthImage& view : views) {
    const auto near = [&](const std::vector<DepthImage>& group) {
      return glm::distance(group.front().camera.position(), view.camera.position()) <= kOnePoint;
    };
    const auto found = std::find_if(groups.begin(), groups.end(), near);
    if (found == groups.end())
      groups.push_back({view});
    else
      found->push_back(view);
  }
  std::vector<DepthImage> pictures;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (options.progress) options.progress(int(6 * g), int(6 * groups.size()));
    Result<EnvironmentMap> map = environment_around(groups[g], options.face);
    if (!map) return map.error();
    for (std::size_t f = 0; f < 6; ++f) {
      map->faces[f].name = fmt::format("node {:02} face {}", g, f);
      pictures.push_back(std::move(map->faces[f]));
    }
  }
  Result<EnvironmentNodes> nodes = make_environment_nodes(std::move(pictures), options.mesh);
  if (!nodes) return Error{name, nodes.error().message()};
  nodes->name = name;
  if (options.progress) options.progress(int(6 * groups.size()), int(6 * groups.size()));
  return NodeBake{std::move(*nodes), std::nullopt};
}

}  // namespace

Box usual_region(const Box& bounds) {
  const glm::vec3 center = bounds.center(), extent = bounds.extent();
  Box region;
  region.min = center - 0.3f * extent, region.max = center + 0.3f * extent;
  // Eyes of people who stand on the ground, where there is room above them.
  const float low = bounds.min.y + 1.4f, high = bounds.min.y + 1.9f;
  if (high < bounds.max.y && extent.y > 2) region.min.y = low, region.max.y = high;
  return region;
}

Result<EnvironmentMap> environment_around(std::span<const DepthImage> views, int size) {
  if (views.empty()) return Error{"node", "there are no views"};
  const glm::dvec3 eye = views.front().camera.position();
  for (const DepthImage& view : views)
    if (view.camera.projection != Projection::perspective)
      return Error{view.name, "is no perspective picture"};
  EnvironmentMap map;
  double z_near = views.front().camera.z_near, z_far = views.front().camera.z_far;
  for (const DepthImage& view : views) {
    z_near = std::min(z_near, view.camera.z_near);
    z_far = std::max(z_far, view.camera.z_far);
  }
  const std::array<Camera, 6> cameras = environment_cameras(eye, size, 0.5 * z_near, 2 * z_far);
  parallel_for(std::size_t(0), std::size_t(6), [&](std::size_t f) {
    DepthImage& face = map.faces[f];
    face.camera = cameras[f];
    face.color = ColorImage(size, size, glm::vec4(0));
    face.depth = Image<float>(size, size, kNoDepth);
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const glm::dvec2 center(x + 0.5, y + 0.5);
        const glm::dvec3 at = world_from_raster(face.camera, center, 1.0);
        for (const DepthImage& view : views) {
          const Camera& c = view.camera;
          // From the view's own eye: views differ in direction alone.
          const glm::dvec3 raster = raster_from_world(c, at - eye + c.position());
          if (!(raster.z > 0 && raster.x >= 0 && raster.y >= 0 && raster.x < c.width &&
                raster.y < c.height))
            continue;
          const int u = int(raster.x), v = int(raster.y);
          face.color(x, y) = view.color(u, v);
          if (!view.covered(u, v)) break;
          const double eye_z = eye_z_from(view.depth_kind, view.depth(u, v), c, {u + 0.5, v + 0.5});
          const double ray = depth_from_eye_z(DepthKind::ray, eye_z, c, {u + 0.5, v + 0.5});
          face.depth(x, y) = float(eye_z_from(DepthKind::ray, ray, face.camera, center));
          break;
        }
      }
  });
  for (std::size_t f = 0; f < 6; ++f) map.faces[f].name = fmt::format("face {}", f);
  if (Result<> valid = validate_environment(map); !valid) return valid.error();
  return map;
}

Result<NodeBake> bake_nodes(CaptureSource& source, const NodeBakeOptions& options) {
  if (!source.photographs().empty()) return bake_photographs(source, options);
  const std::string name(source.name());
  const Box bounds = source.bounds(options.objects);
  if (bounds.empty()) return Error{name, "there is nothing opaque to take pictures of"};
  PlacementOptions placement = options.placement;
  if (placement.region.empty()) placement.region = usual_region(bounds);
  std::vector<glm::dvec3> eyes = options.at;
  std::optional<double> held;
  if (const Scene* scene = source.scene()) {
    const Result<RayScene> rays = RayScene::create(*scene, 0, RayParts::strokes);
    if (!rays) return rays.error();
    if (eyes.empty()) {
      Result<Placement> placed = place_nodes(*rays, placement);
      if (!placed) return Error{name, placed.error().reason};
      eyes = std::move(placed->eyes);
      held = placed->share.back();
    } else {
      const Result<double> share = share_held(*rays, placement, eyes);
      // Nodes may well stand where nothing is to be seen from the region.
      if (share) held = *share;
    }
  }
  if (eyes.empty()) return Error{name, "is no scene: say where its nodes stand (--at)"};

  std::vector<DepthImage> pictures;
  const double radius = std::max(double(bounds.radius()), reach_of(bounds, eyes));
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    if (options.progress) options.progress(int(6 * i), int(6 * eyes.size()));
    if (Result<> done = capture_faces(source, eyes[i], options, radius, i, pictures); !done)
      return done.error();
  }
  if (options.progress) options.progress(int(6 * eyes.size()), int(6 * eyes.size()));
  Result<EnvironmentNodes> nodes = make_environment_nodes(std::move(pictures), options.mesh);
  if (!nodes) return Error{name, nodes.error().message()};
  nodes->name = name;
  nodes->strokes = source.stroke_size(options.objects);
  return NodeBake{std::move(*nodes), held};
}

}  // namespace rilievo
