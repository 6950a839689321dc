#include "rilievo/render/rays/ray_scene.h"

#include <algorithm>
#include <cmath>

#include "rilievo/core/expects.h"
#include "rilievo/core/linear_maps.h"
#include "rilievo/render/rays/embree_model.h"
#include "rilievo/render/shading/shading_model.h"

namespace rilievo {

namespace {

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
  const Scene* scene;
  RayParts included;
  RTCDevice device = nullptr;
  SurfaceMaterials materials;
  std::vector<glm::mat4> poses, model_from_world;
  std::vector<glm::dmat3> normal_from_model;
  std::vector<std::vector<int>> parts;  // per model: the part of each geometry
  std::vector<EmbreeModel> models;      // in their own spaces
  // By object: a copy of its model in the world, if its placement cannot be inverted (it makes a
  // sheet of it), as Embree does with those of instances. The object's matrices are then 1.
  std::vector<EmbreeModel> flat;
  EmbreeScene world;
  std::vector<RTCGeometry> instances;  // by object; owned by `world`
  std::vector<std::uint8_t> kept;      // by object: can rays hit it?
  double time = NAN;

  State(const Scene& scene, RayParts included)
      : scene(&scene),
        included(included),
        materials(scene,
                  included == RayParts::all ? TexturedMaterials::all : TexturedMaterials::opaque) {}
  [[nodiscard]] RayContext context(const RayPictureView* picture, RaySides sides,
                                   std::span<const bool> objects) const {
    RILIEVO_EXPECTS(objects.empty() || objects.size() == scene->objects.size());
    RayContext context;
    rtcInitIntersectContext(&context.embree);
    context.picture = picture;
    context.model_from_world = model_from_world;
    context.sides = sides;
    context.objects = objects;
    if (!objects.empty()) context.embree.filter = filter_objects;
    return context;
  }
  Result<EmbreeModel> build(int model, const glm::dmat4& to_from_model) {
    return build_embree_model({device, scene, &materials, included}, model, to_from_model,
                              parts[std::size_t(model)]);
  }
  Result<> place(std::size_t object, const glm::dmat4& world_from_model);
  bool rebuild(int model, const glm::dmat4& to_from_model, std::span<const int> meshes,
               EmbreeModel& built) const {
    return rebuild_embree_model(scene->models[std::size_t(model)], parts[std::size_t(model)],
                                to_from_model, meshes, built);
  }
  [[nodiscard]] const EmbreeModel& model_of(std::size_t object) const {
    return flat[object].scene ? flat[object] : models[std::size_t(scene->objects[object].model)];
  }

  ~State() {
    world.reset();
    flat.clear();
    models.clear();
    if (device) rtcReleaseDevice(device);
  }
};

RayScene::RayScene(std::unique_ptr<State> state) : state_(std::move(state)) {}
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;
RayScene::~RayScene() = default;

const Scene& RayScene::scene() const { return *state_->scene; }
RayParts RayScene::parts() const { return state_->included; }
const std::vector<glm::mat4>& RayScene::poses() const { return state_->poses; }
const SurfaceMaterials& RayScene::materials() const { return state_->materials; }

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
  if (material.base_color_texture.texture < 0) return color;
  const SurfaceTexture texture = unscaled_texture(scene, material.base_color_texture, true);
  const std::vector<glm::vec2>& uvs = mesh.uv[texture.uv_set];
  glm::vec2 uv(0.0f);
  if (!uvs.empty()) uv = w.x * uvs[corner[0]] + w.y * uvs[corner[1]] + w.z * uvs[corner[2]];
  const shading_model::Vec4<float> texel =
      shading_model::sample_color<float>(texture, {{uv.x, uv.y}, {0, 0}, {0, 0}});
  return color * glm::vec4(texel.x, texel.y, texel.z, texel.w);
}

Result<> RayScene::State::place(std::size_t object, const glm::dmat4& world_from_model) {
  const int model = scene->objects[object].model;
  glm::dmat4 matrix = world_from_model;
  EmbreeModel copy;
  if (!is_invertible(glm::dmat3(matrix))) {
    Result<EmbreeModel> built = build(model, matrix);
    if (!built) return built.error();
    copy = std::move(*built);
    matrix = glm::dmat4(1.0);
  }
  if (copy.scene || flat[object].scene)
    rtcSetGeometryInstancedScene(
        instances[object], copy.scene ? copy.scene.get() : models[std::size_t(model)].scene.get());
  flat[object] = std::move(copy);
  const glm::mat4 rounded(matrix);
  rtcSetGeometryTransform(instances[object], 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &rounded[0][0]);
  rtcCommitGeometry(instances[object]);
  normal_from_model[object] = normal_map(glm::dmat3(matrix));
  model_from_world[object] = glm::mat4(glm::inverse(matrix));
  return Done{};
}

Result<RayScene> RayScene::create(const Scene& scene, double time, RayParts parts) {
  auto state = std::make_unique<State>(scene, parts);
  state->device = rtcNewDevice(nullptr);
  if (!state->device) return Error{"Embree", "no device"};

  state->parts.resize(scene.models.size());
  for (std::size_t m = 0; m < scene.models.size(); ++m) {
    Result<EmbreeModel> built = state->build(int(m), glm::dmat4(1.0));
    if (!built) return built.error();
    state->models.push_back(std::move(*built));
  }
  state->flat.resize(scene.objects.size());

  state->world.reset(rtcNewScene(state->device));
  rtcSetSceneFlags(state->world.get(), kEmbreeFlags);
  for (const Object& object : scene.objects) {
    state->instances.push_back(rtcNewGeometry(state->device, RTC_GEOMETRY_TYPE_INSTANCE));
    RTCGeometry instance = state->instances.back();
    rtcSetGeometryInstancedScene(instance, state->models[std::size_t(object.model)].scene.get());
    rtcAttachGeometry(state->world.get(), instance);
    rtcReleaseGeometry(instance);
  }
  state->kept.assign(scene.objects.size(), 1);
  RayScene rays(std::move(state));
  if (Result<> placed = rays.set_time(time); !placed) return placed.error();
  return {std::move(rays)};
}

Result<> RayScene::set_time(double time) {
  State& s = *state_;
  const bool first = s.poses.empty();
  if (time == s.time || (!first && s.scene->channels.empty())) return Done{};
  s.time = time;
  pose(*s.scene, time, s.poses);
  s.normal_from_model.resize(s.poses.size());
  s.model_from_world.resize(s.poses.size());
  for (std::size_t i = 0; i < s.poses.size(); ++i) {
    if (!first && !s.scene->objects[i].moving) continue;
    if (Result<> placed = s.place(i, glm::dmat4(s.poses[i])); !placed) return placed;
  }
  rtcCommitScene(s.world.get());
  if (rtcGetDeviceError(s.device) != RTC_ERROR_NONE)
    return Error{"Embree", "the scene cannot be built"};
  return Done{};
}

Result<> RayScene::update_meshes(std::span<const int> meshes) {
  State& s = *state_;
  std::vector<bool> bent(s.models.size(), false);
  for (std::size_t m = 0; m < s.models.size(); ++m)
    bent[m] = s.rebuild(int(m), glm::dmat4(1.0), meshes, s.models[m]);
  for (std::size_t i = 0; i < s.instances.size(); ++i) {
    const int model = s.scene->objects[i].model;
    if (!bent[std::size_t(model)]) continue;
    if (s.flat[i].scene) (void)s.rebuild(model, glm::dmat4(s.poses[i]), meshes, s.flat[i]);
    rtcCommitGeometry(s.instances[i]);
  }
  rtcCommitScene(s.world.get());
  if (rtcGetDeviceError(s.device) != RTC_ERROR_NONE)
    return Error{"Embree", "the scene cannot be built"};
  return Done{};
}

Result<> RayScene::keep_objects(std::span<const std::uint32_t> objects) {
  State& s = *state_;
  std::vector<std::uint8_t> kept(s.instances.size(), objects.empty() ? 1 : 0);
  for (const std::uint32_t object : objects) kept[object] = 1;
  if (kept == s.kept) return Done{};
  for (std::size_t i = 0; i < kept.size(); ++i)
    if (kept[i] != s.kept[i])
      kept[i] ? rtcEnableGeometry(s.instances[i]) : rtcDisableGeometry(s.instances[i]);
  s.kept.swap(kept);
  rtcCommitScene(s.world.get());
  if (rtcGetDeviceError(s.device) != RTC_ERROR_NONE)
    return Error{"Embree", "the scene cannot be built"};
  return Done{};
}

ObjectSet::ObjectSet(const Scene& scene, std::span<const std::uint32_t> objects) {
  if (objects.empty()) return;
  size_ = scene.objects.size();
  included_ = std::make_unique<bool[]>(size_);
  for (const std::uint32_t object : objects) included_[object] = true;
}

std::optional<RayHit> RayScene::first_hit(const glm::vec3& origin, const glm::vec3& direction,
                                          float t_near, float t_far, RaySides sides,
                                          std::span<const bool> objects) const {
  return first_hit(state_->context(nullptr, sides, objects), origin, direction, t_near, t_far);
}

std::optional<RayHit> RayScene::first_hit(const RayPictureView& view, const glm::vec3& origin,
                                          const glm::vec3& direction, float t_near,
                                          float t_far) const {
  return first_hit(state_->context(&view, RaySides::seen, view.objects), origin, direction, t_near,
                   t_far);
}

std::optional<RayHit> RayScene::first_hit(RayContext&& context, const glm::vec3& origin,
                                          const glm::vec3& direction, float t_near,
                                          float t_far) const {
  RTCRayHit query{};
  query.ray = ray_from(origin, direction, t_near, t_far);
  query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(state_->world.get(), &context.embree, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  RayHit hit;
  hit.distance = query.ray.tfar;
  hit.object = query.hit.instID[0] + 1;
  const int model = state_->scene->objects[query.hit.instID[0]].model;
  hit.part = state_->parts[model][query.hit.geomID];
  hit.triangle = query.hit.primID;
  hit.barycentric = {query.hit.u, query.hit.v};
  const glm::vec3 normal{query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z};
  const PartFilter& part =
      *state_->model_of(query.hit.instID[0]).filters[std::size_t(query.hit.geomID)];
  hit.normal = glm::vec3(glm::normalize(state_->normal_from_model[query.hit.instID[0]] *
                                        glm::dvec3(part.front * normal)));
  return hit;
}

void RayScene::first_hits(const RayPictureView& view, RayPacket& packet) const {
  constexpr int kCount = RayPacket::kMaxCount;
  RILIEVO_EXPECTS(0 < packet.count && packet.count <= kCount);
  RayContext context = state_->context(&view, RaySides::seen, view.objects);
  context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  alignas(64) int valid[kCount];
  RTCRayHit16 query{};
  for (int i = 0; i < kCount; ++i) {
    valid[i] = i < packet.count ? -1 : 0;
    const int k = std::min(i, packet.count - 1);
    query.ray.org_x[i] = packet.origin[0][k], query.ray.org_y[i] = packet.origin[1][k];
    query.ray.org_z[i] = packet.origin[2][k];
    query.ray.dir_x[i] = packet.direction[0][k], query.ray.dir_y[i] = packet.direction[1][k];
    query.ray.dir_z[i] = packet.direction[2][k];
    query.ray.tnear[i] = packet.t_near[k], query.ray.tfar[i] = packet.t_far[k];
    query.ray.mask[i] = 0xffffffffu;
    query.hit.geomID[i] = query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
  rtcIntersect16(valid, state_->world.get(), &context.embree, &query);
  for (int i = 0; i < packet.count; ++i) {
    packet.object[i] = 0;
    if (query.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
    const std::uint32_t object = query.hit.instID[0][i];
    packet.object[i] = object + 1;
    packet.distance[i] = query.ray.tfar[i];
    packet.triangle[i] = query.hit.primID[i];
    packet.part[i] = state_->parts[state_->scene->objects[object].model][query.hit.geomID[i]];
  }
}

bool RayScene::occluded(const glm::vec3& origin, const glm::vec3& direction, float t_near,
                        float t_far) const {
  RayContext context = state_->context(nullptr, RaySides::seen, {});
  RTCRay ray = ray_from(origin, direction, t_near, t_far);
  rtcOccluded1(state_->world.get(), &context.embree, &ray);
  return ray.tfar < 0;
}

}  // namespace rilievo
