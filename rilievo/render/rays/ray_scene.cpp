#include "rilievo/render/rays/ray_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_inverse.hpp>
#include <limits>

namespace rilievo {
namespace {

// What the filter of one geometry needs to know.
struct PartFilter {
  const Scene* scene;
  int mesh;
  bool double_sided, masked;
  float front;  // -1 where the part's placement mirrors: its front is then clockwise
};

struct SceneDeleter {
  void operator()(RTCScene s) const { rtcReleaseScene(s); }
};
using EmbreeScene = std::unique_ptr<RTCSceneTy, SceneDeleter>;

glm::vec4 texel(const Texture& texture, const Rgba8Image& image, int x, int y) {
  const auto wrapped = [](int i, int n, Wrap wrap) {
    if (wrap == Wrap::clamp_to_edge) return std::clamp(i, 0, n - 1);
    const int period = wrap == Wrap::mirrored_repeat ? 2 * n : n;
    const int k = ((i % period) + period) % period;
    return k < n ? k : period - 1 - k;
  };
  const glm::u8vec4 c =
      image(wrapped(x, image.width(), texture.wrap_u), wrapped(y, image.height(), texture.wrap_v));
  return {linear_from_srgb(float(c.r) / 255), linear_from_srgb(float(c.g) / 255),
          linear_from_srgb(float(c.b) / 255), float(c.a) / 255};
}

glm::vec4 sample(const Scene& scene, int index, const glm::vec2& uv) {
  if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) return glm::vec4(1.0f);
  const Texture& texture = scene.textures[std::size_t(index)];
  const Rgba8Image& image = scene.images[std::size_t(texture.image)];
  // Far from the origin a float has no fraction left to wrap.
  const glm::vec2 near_uv = glm::abs(uv.x) + glm::abs(uv.y) < 1e6f ? uv : glm::vec2(0.0f);
  const glm::vec2 at = near_uv * glm::vec2(image.width(), image.height()) - 0.5f;
  const glm::vec2 cell = glm::floor(texture.nearest ? at + 0.5f : at);
  const int x = int(cell.x), y = int(cell.y);
  const auto at_cell = [&](int dx, int dy) { return texel(texture, image, x + dx, y + dy); };
  if (texture.nearest) return at_cell(0, 0);
  const glm::vec2 f = at - cell;
  return glm::mix(glm::mix(at_cell(0, 0), at_cell(1, 0), f.x),
                  glm::mix(at_cell(0, 1), at_cell(1, 1), f.x), f.y);
}

// What every query carries: for the filter.
struct Query {
  RTCIntersectContext context;  // first: Embree gives back a pointer to it
  RaySides sides;
};

Query make_query(RaySides sides) {
  Query query{};
  rtcInitIntersectContext(&query.context);
  query.sides = sides;
  return query;
}

// Rejects what a picture cannot hold. Side = sign of Ng . direction, both in model space, where a
// mirroring placement of the *object* changes nothing: glTF turns the front side with it.
void filter(const RTCFilterFunctionNArguments* arguments) {
  if (arguments->valid[0] != -1) return;
  const PartFilter& part = *static_cast<const PartFilter*>(arguments->geometryUserPtr);
  RTCHitN* hit = arguments->hit;
  RTCRayN* ray = arguments->ray;
  const glm::vec3 normal{RTCHitN_Ng_x(hit, 1, 0), RTCHitN_Ng_y(hit, 1, 0), RTCHitN_Ng_z(hit, 1, 0)};
  const glm::vec3 direction{RTCRayN_dir_x(ray, 1, 0), RTCRayN_dir_y(ray, 1, 0),
                            RTCRayN_dir_z(ray, 1, 0)};
  const RaySides sides = reinterpret_cast<const Query*>(arguments->context)->sides;
  if (sides == RaySides::seen && !part.double_sided &&
      part.front * glm::dot(normal, direction) >= 0) {
    arguments->valid[0] = 0;
    return;
  }
  if (!part.masked) return;
  const glm::vec2 barycentric{RTCHitN_u(hit, 1, 0), RTCHitN_v(hit, 1, 0)};
  const int material = part.scene->meshes[part.mesh].material;
  if (base_color_at(*part.scene, part.mesh, RTCHitN_primID(hit, 1, 0), barycentric).a <
      part.scene->materials[material].alpha_cutoff)
    arguments->valid[0] = 0;
}

RTCRay ray_from(const glm::vec3& origin, const glm::vec3& direction, float t_near, float t_far) {
  RTCRay ray{};
  ray.org_x = origin.x, ray.org_y = origin.y, ray.org_z = origin.z;
  ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
  ray.tnear = t_near;
  ray.tfar = t_far;
  ray.mask = 0xffffffffu;
  return ray;
}

}  // namespace

struct RayScene::State {
  const Scene* scene = nullptr;
  RTCDevice device = nullptr;
  std::vector<glm::mat4> poses;
  std::vector<glm::mat3> normal_from_model;
  std::vector<std::unique_ptr<PartFilter>> filters;
  std::vector<std::vector<int>> parts;  // per model: the part of each geometry
  std::vector<EmbreeScene> models;
  EmbreeScene world;

  ~State() {
    world.reset();
    models.clear();
    if (device) rtcReleaseDevice(device);
  }
};

RayScene::RayScene(std::unique_ptr<State> state) : state_(std::move(state)) {}
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;
RayScene::~RayScene() = default;

const Scene& RayScene::scene() const { return *state_->scene; }
const std::vector<glm::mat4>& RayScene::poses() const { return state_->poses; }

std::optional<bool> double_sided(const Scene& scene, int mesh) {
  const int material = scene.meshes[mesh].material;
  if (material < 0) return false;
  if (scene.materials[material].alpha_mode == AlphaMode::blend) return std::nullopt;
  return scene.materials[material].double_sided;
}

glm::vec4 base_color_at(const Scene& scene, int mesh_index, std::uint32_t triangle,
                        const glm::vec2& barycentric) {
  const Mesh& mesh = scene.meshes[mesh_index];
  const std::uint32_t* corner = &mesh.indices[3 * std::size_t(triangle)];
  const glm::vec3 w{1 - barycentric.x - barycentric.y, barycentric.x, barycentric.y};
  glm::vec4 color(1.0f);
  if (!mesh.colors.empty())
    color =
        w.x * mesh.colors[corner[0]] + w.y * mesh.colors[corner[1]] + w.z * mesh.colors[corner[2]];
  if (mesh.material < 0) return color;
  const Material& material = scene.materials[mesh.material];
  color *= material.base_color;
  const TextureUse& use = material.base_color_texture;
  if (use.texture < 0) return color;
  const std::vector<glm::vec2>& uvs = mesh.uv[use.uv_set];
  if (uvs.empty()) return color * sample(scene, use.texture, {0, 0});
  const glm::vec2 uv = w.x * uvs[corner[0]] + w.y * uvs[corner[1]] + w.z * uvs[corner[2]];
  return color * sample(scene, use.texture, glm::vec2(use.texture_from_uv * glm::vec3(uv, 1)));
}

Result<RayScene> RayScene::create(const Scene& scene, double time) {
  auto state = std::make_unique<State>();
  state->scene = &scene;
  state->device = rtcNewDevice(nullptr);
  if (!state->device) return Error{"Embree", "no device"};
  pose(scene, time, state->poses);

  // Every model in its own space, without what blends.
  state->parts.resize(scene.models.size());
  for (std::size_t m = 0; m < scene.models.size(); ++m) {
    const Model& model = scene.models[m];
    state->models.emplace_back(rtcNewScene(state->device));
    // Else rays slip through between triangles that share an edge.
    rtcSetSceneFlags(state->models.back().get(), RTC_SCENE_FLAG_ROBUST);
    for (int p = 0; p < int(model.parts.size()); ++p) {
      const Part& part = model.parts[p];
      const Mesh& mesh = scene.meshes[part.mesh];
      const std::optional<bool> both_sides = double_sided(scene, part.mesh);
      if (!both_sides || mesh.indices.size() < 3) continue;
      const bool masked =
          mesh.material >= 0 && scene.materials[mesh.material].alpha_mode == AlphaMode::mask;
      RTCGeometry geometry = rtcNewGeometry(state->device, RTC_GEOMETRY_TYPE_TRIANGLE);
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
      for (std::size_t v = 0; v < mesh.positions.size(); ++v)
        vertices[v] = glm::vec3(part.model_from_mesh * glm::vec4(mesh.positions[v], 1));
      std::copy(mesh.indices.begin(), mesh.indices.end() - mesh.indices.size() % 3, indices);
      const bool mirrors = glm::determinant(glm::mat3(part.model_from_mesh)) < 0;
      state->filters.push_back(std::make_unique<PartFilter>(
          PartFilter{&scene, part.mesh, *both_sides, masked, mirrors ? -1.0f : 1.0f}));
      rtcSetGeometryUserData(geometry, state->filters.back().get());
      if (!*both_sides || masked) {
        rtcSetGeometryIntersectFilterFunction(geometry, filter);
        rtcSetGeometryOccludedFilterFunction(geometry, filter);
      }
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(state->models[m].get(), geometry);
      rtcReleaseGeometry(geometry);
      state->parts[m].push_back(p);
    }
    rtcCommitScene(state->models[m].get());
  }

  state->world.reset(rtcNewScene(state->device));
  rtcSetSceneFlags(state->world.get(), RTC_SCENE_FLAG_ROBUST);
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    RTCGeometry instance = rtcNewGeometry(state->device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, state->models[scene.objects[i].model].get());
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &state->poses[i][0][0]);
    rtcCommitGeometry(instance);
    rtcAttachGeometry(state->world.get(), instance);
    rtcReleaseGeometry(instance);
    state->normal_from_model.push_back(glm::inverseTranspose(glm::mat3(state->poses[i])));
  }
  rtcCommitScene(state->world.get());
  if (rtcGetDeviceError(state->device) != RTC_ERROR_NONE)
    return Error{"Embree", "the scene cannot be built"};
  return RayScene(std::move(state));
}

std::optional<RayHit> RayScene::first_hit(const glm::vec3& origin, const glm::vec3& direction,
                                          float t_near, float t_far, RaySides sides) const {
  Query carried = make_query(sides);
  RTCRayHit query{};
  query.ray = ray_from(origin, direction, t_near, t_far);
  query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(state_->world.get(), &carried.context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  RayHit hit;
  hit.distance = query.ray.tfar;
  hit.object = query.hit.instID[0] + 1;
  const int model = state_->scene->objects[query.hit.instID[0]].model;
  hit.part = state_->parts[model][query.hit.geomID];
  hit.triangle = query.hit.primID;
  hit.barycentric = {query.hit.u, query.hit.v};
  const glm::vec3 normal{query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z};
  const auto& part = *static_cast<const PartFilter*>(
      rtcGetGeometryUserData(rtcGetGeometry(state_->models[model].get(), query.hit.geomID)));
  hit.normal =
      glm::normalize(state_->normal_from_model[query.hit.instID[0]] * (part.front * normal));
  return hit;
}

bool RayScene::occluded(const glm::vec3& origin, const glm::vec3& direction, float t_near,
                        float t_far) const {
  Query carried = make_query(RaySides::seen);
  RTCRay ray = ray_from(origin, direction, t_near, t_far);
  rtcOccluded1(state_->world.get(), &carried.context, &ray);
  return ray.tfar < 0;
}

}  // namespace rilievo
