#include "rilievo/render/rays/embree_model.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "rilievo/core/linear_maps.h"
#include "rilievo/render/shading/shading_model.h"

namespace rilievo {
namespace {

namespace model = shading_model;

// The picture's rays in the space of one of its models.
PictureRays in_model(const RayPictureView& picture, const glm::mat4& model_from_world) {
  const glm::mat3 turned(model_from_world);
  PictureRays rays = picture.rays;
  rays.first = turned * rays.first;
  rays.per_x = turned * rays.per_x, rays.per_y = turned * rays.per_y;
  rays.axis = turned * rays.axis;
  return rays;
}

// The alpha of a masked triangle there; without a picture, of the texture as it is.
float alpha_at(const PartFilter& part, std::uint32_t triangle, const glm::vec2& barycentric,
               const RayPictureView* picture, const glm::mat4& model_from_world) {
  const Mesh& mesh = *part.mesh;
  const SurfaceMaterial& material = *part.material;
  const std::uint32_t* corner = &mesh.indices[3 * std::size_t(triangle)];
  model::Weights<float> w{
      {1 - barycentric.x - barycentric.y, barycentric.x, barycentric.y}, {0, 0, 0}, {0, 0, 0}};
  float alpha = material.base_color.a;
  if (!mesh.colors.empty())
    alpha *= w.at[0] * mesh.colors[corner[0]].a + w.at[1] * mesh.colors[corner[1]].a +
             w.at[2] * mesh.colors[corner[2]].a;
  if (!material.base) return alpha;
  if (picture) {
    const PictureRays rays = in_model(*picture, model_from_world);
    const glm::vec3 eye(glm::dmat4(model_from_world) * glm::dvec4(picture->position, 1));
    glm::vec3 at[3], met(0.0f);
    for (int k = 0; k < 3; ++k) {
      at[k] = part.vertices[corner[k]] - eye;
      met += w.at[k] * at[k];
    }
    // The steps from texel to texel are of rays as long as `first`.
    if (!rays.parallel) {
      const glm::vec3 across = glm::cross(rays.per_x, rays.per_y);
      met *= glm::dot(rays.first, across) / glm::dot(met, across);
    }
    w = model::weights_of<float>(rays, met, at[0], at[1], at[2],
                                 glm::cross(at[1] - at[0], at[2] - at[0]), true);
  }
  const std::vector<glm::vec2>& uvs = mesh.uv[material.base->uv_set];
  model::Vec2<float> uv[3] = {{0, 0}, {0, 0}, {0, 0}};
  if (!uvs.empty())
    for (int k = 0; k < 3; ++k) uv[k] = {uvs[corner[k]].x, uvs[corner[k]].y};
  return alpha * model::sample_alpha<float>(*material.base, model::footprint(w, uv));
}

// Rejects what a picture cannot hold. Side = sign of Ng . direction, both in model space, where a
// mirroring placement of the *object* changes nothing: glTF turns the front side with it.
void filter(const RTCFilterFunctionNArguments* arguments) {
  const PartFilter& part = *static_cast<const PartFilter*>(arguments->geometryUserPtr);
  const auto& context = *reinterpret_cast<const RayContext*>(arguments->context);
  RTCHitN* hit = arguments->hit;
  RTCRayN* ray = arguments->ray;
  const unsigned n = arguments->N;
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] != -1) continue;
    const glm::vec3 normal{RTCHitN_Ng_x(hit, n, i), RTCHitN_Ng_y(hit, n, i),
                           RTCHitN_Ng_z(hit, n, i)};
    const glm::vec3 direction{RTCRayN_dir_x(ray, n, i), RTCRayN_dir_y(ray, n, i),
                              RTCRayN_dir_z(ray, n, i)};
    if (context.sides == RaySides::seen && !part.material->double_sided &&
        part.front * glm::dot(normal, direction) >= 0) {
      arguments->valid[i] = 0;
      continue;
    }
    if (!part.material->masked) continue;
    const glm::vec2 barycentric{RTCHitN_u(hit, n, i), RTCHitN_v(hit, n, i)};
    const std::uint32_t object = RTCHitN_instID(hit, n, i, 0);
    if (alpha_at(part, RTCHitN_primID(hit, n, i), barycentric, context.picture,
                 context.model_from_world[object]) < part.material->alpha_cutoff)
      arguments->valid[i] = 0;
  }
}

void place_vertices(const Part& part, const Mesh& mesh, const glm::dmat4& to_from_model,
                    glm::vec3* vertices) {
  const glm::dmat4 to_from_mesh = to_from_model * glm::dmat4(part.model_from_mesh);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    vertices[v] = glm::vec3(to_from_mesh * glm::dvec4(mesh.positions[v], 1));
}

// Points as balls, lines as rods with round ends; null if memory does not suffice. Embree's
// vertices are a place and a radius.
RTCGeometry stroke_geometry(RTCDevice device, const Part& part, const Mesh& mesh,
                            const glm::dmat4& to_from_model, float px_radius) {
  const bool lines = mesh.primitive == Primitive::lines;
  RTCGeometry geometry = rtcNewGeometry(
      device, lines ? RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE : RTC_GEOMETRY_TYPE_SPHERE_POINT);
  const std::size_t count = mesh.primitives() * corners_of(mesh.primitive);
  auto* vertices = static_cast<glm::vec4*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, sizeof(glm::vec4), count));
  auto* first = lines ? static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
                            geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT,
                            sizeof(std::uint32_t), mesh.primitives()))
                      : nullptr;
  if (!vertices || (lines && !first)) {
    rtcReleaseGeometry(geometry);
    return nullptr;
  }
  const glm::dmat4 to_from_mesh = to_from_model * glm::dmat4(part.model_from_mesh);
  const float radius = mesh.width > 0
                           ? 0.5f * mesh.width * float(smallest_stretch(glm::mat4(to_from_mesh)))
                           : px_radius;
  for (std::size_t i = 0; i < count; ++i)
    vertices[i] =
        glm::vec4(glm::vec3(to_from_mesh * glm::dvec4(mesh.positions[mesh.indices[i]], 1)), radius);
  for (std::uint32_t i = 0; lines && i < mesh.primitives(); ++i) first[i] = 2 * i;
  return geometry;
}

}  // namespace

void filter_objects(const RTCFilterFunctionNArguments* arguments) {
  const auto& context = *reinterpret_cast<const RayContext*>(arguments->context);
  for (unsigned i = 0; i < arguments->N; ++i)
    if (arguments->valid[i] == -1 &&
        !context.objects[RTCHitN_instID(arguments->hit, arguments->N, i, 0)])
      arguments->valid[i] = 0;
}

Result<EmbreeModel> build_embree_model(const EmbreeModelOptions& options, int of,
                                       const glm::dmat4& to_from_model, std::vector<int>& part_of) {
  const Model& model = options.scene->models[std::size_t(of)];
  EmbreeModel built;
  built.scene.reset(rtcNewScene(options.device));
  rtcSetSceneFlags(built.scene.get(), kEmbreeFlags);
  part_of.clear();
  for (int p = 0; p < int(model.parts.size()); ++p) {
    const Part& part = model.parts[std::size_t(p)];
    const Mesh& mesh = options.scene->meshes[std::size_t(part.mesh)];
    const SurfaceMaterial& material = options.materials->of_mesh(part.mesh);
    if (mesh.primitive != Primitive::triangles) {
      if (options.included != RayParts::strokes || mesh.primitives() == 0) continue;
      RTCGeometry strokes =
          stroke_geometry(options.device, part, mesh, to_from_model, 1e-3f * model.bounds.radius());
      if (!strokes) return Error{"Embree", "out of memory"};
      built.filters.push_back(
          std::make_unique<PartFilter>(PartFilter{&mesh, nullptr, &material, 1}));
      rtcCommitGeometry(strokes);
      rtcAttachGeometry(built.scene.get(), strokes);
      rtcReleaseGeometry(strokes);
      part_of.push_back(p);
      continue;
    }
    if ((material.blended && options.included != RayParts::all) || mesh.triangles() == 0) continue;
    RTCGeometry geometry = rtcNewGeometry(options.device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<glm::vec3*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                sizeof(glm::vec3), mesh.positions.size()));
    auto* indices = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t), mesh.indices.size() / 3));
    if (!vertices || !indices) {
      rtcReleaseGeometry(geometry);
      return Error{"Embree", "out of memory"};
    }
    place_vertices(part, mesh, to_from_model, vertices);
    std::copy(mesh.indices.begin(), mesh.indices.end() - mesh.indices.size() % 3, indices);
    const bool mirrors = is_mirroring(glm::dmat3(to_from_model * glm::dmat4(part.model_from_mesh)));
    built.filters.push_back(std::make_unique<PartFilter>(
        PartFilter{&mesh, vertices, &material, mirrors ? -1.0f : 1.0f}));
    rtcSetGeometryUserData(geometry, built.filters.back().get());
    if (!material.double_sided || material.masked) {
      rtcSetGeometryIntersectFilterFunction(geometry, filter);
      rtcSetGeometryOccludedFilterFunction(geometry, filter);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(built.scene.get(), geometry);
    rtcReleaseGeometry(geometry);
    part_of.push_back(p);
  }
  rtcCommitScene(built.scene.get());
  return {std::move(built)};
}

bool rebuild_embree_model(const Model& model, std::span<const int> part_of,
                          const glm::dmat4& to_from_model, std::span<const int> meshes,
                          EmbreeModel& built) {
  bool bent = false;
  for (unsigned g = 0; g < part_of.size(); ++g) {
    const Part& part = model.parts[std::size_t(part_of[g])];
    // Points and lines have none that bend.
    if (std::find(meshes.begin(), meshes.end(), part.mesh) == meshes.end() ||
        !built.filters[g]->vertices)
      continue;
    RTCGeometry geometry = rtcGetGeometry(built.scene.get(), g);
    place_vertices(part, *built.filters[g]->mesh, to_from_model, built.filters[g]->vertices);
    rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(geometry);
    bent = true;
  }
  if (bent) rtcCommitScene(built.scene.get());
  return bent;
}

}  // namespace rilievo
