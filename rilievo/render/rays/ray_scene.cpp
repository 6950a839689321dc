#include "rilievo/render/rays/ray_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>

#include "rilievo/core/expects.h"
#include "rilievo/core/linear_maps.h"
#include "rilievo/render/shading/shading_model.h"

namespace rilievo {

// What a ray takes along.
struct RayContext {
  RTCIntersectContext embree;  // the first member: Embree hands on a pointer to it
  const RayPictureView* picture = nullptr;
  std::span<const glm::mat4> model_from_world;
  RaySides sides = RaySides::seen;
  std::span<const bool> objects;  // for each: can it be hit? Empty: all can
};

namespace {

namespace model = shading_model;

// What the filter of one geometry needs to know.
struct PartFilter {
  const Mesh* mesh;
  glm::vec3* vertices;  // of the mesh, in model space: Embree's buffer
  const SurfaceMaterial* material;
  float front;  // -1 where the part's placement mirrors: its front is then clockwise
};

struct SceneDeleter {
  void operator()(RTCScene s) const { rtcReleaseScene(s); }
};
using EmbreeScene = std::unique_ptr<RTCSceneTy, SceneDeleter>;

// A model in Embree.
struct EmbreeModel {
  EmbreeScene scene;
  std::vector<std::unique_ptr<PartFilter>> filters;  // of each geometry
};

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

// Rejects objects that are not in the picture.
void filter_objects(const RTCFilterFunctionNArguments* arguments) {
  const auto& context = *reinterpret_cast<const RayContext*>(arguments->context);
  for (unsigned i = 0; i < arguments->N; ++i)
    if (arguments->valid[i] == -1 &&
        !context.objects[RTCHitN_instID(arguments->hit, arguments->N, i, 0)])
      arguments->valid[i] = 0;
}

// Robust: else rays slip through between triangles that share an edge. And filter_objects() is a
// filter of the context, which is not called otherwise where a part has none of its own.
const RTCSceneFlags kSceneFlags = RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;

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
  Result<EmbreeModel> build(int model, const glm::dmat4& to_from_model);
  Result<> place(std::size_t object, const glm::dmat4& world_from_model);
  bool rebuild(int model, const glm::dmat4& to_from_model, std::span<const int> meshes,
               EmbreeModel& built) const;
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
  const model::Vec4<float> texel =
      model::sample_color<float>(texture, {{uv.x, uv.y}, {0, 0}, {0, 0}});
  return color * glm::vec4(texel.x, texel.y, texel.z, texel.w);
}

// A model, placed by a matrix that its vertices take.
Result<EmbreeModel> RayScene::State::build(int of, const glm::dmat4& to_from_model) {
  const Model& model = scene->models[std::size_t(of)];
  EmbreeModel built;
  built.scene.reset(rtcNewScene(device));
  rtcSetSceneFlags(built.scene.get(), kSceneFlags);
  std::vector<int>& part_of = parts[std::size_t(of)];
  part_of.clear();
  for (int p = 0; p < int(model.parts.size()); ++p) {
    const Part& part = model.parts[std::size_t(p)];
    const Mesh& mesh = scene->meshes[std::size_t(part.mesh)];
    const SurfaceMaterial& material = materials.of_mesh(part.mesh);
    if (mesh.primitive != Primitive::triangles) {
      if (included != RayParts::strokes || mesh.primitives() == 0) continue;
      RTCGeometry strokes =
          stroke_geometry(device, part, mesh, to_from_model, 1e-3f * model.bounds.radius());
      if (!strokes) return Error{"Embree", "out of memory"};
      built.filters.push_back(
          std::make_unique<PartFilter>(PartFilter{&mesh, nullptr, &material, 1}));
      rtcCommitGeometry(strokes);
      rtcAttachGeometry(built.scene.get(), strokes);
      rtcReleaseGeometry(strokes);
      part_of.push_back(p);
      continue;
    }
    if ((material.blended && included != RayParts::all) || mesh.triangles() == 0) continue;
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
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
  rtcSetSceneFlags(state->world.get(), kSceneFlags);
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

// Takes the vertices of these meshes again; whether the model has any of them.
bool RayScene::State::rebuild(int of, const glm::dmat4& to_from_model, std::span<const int> meshes,
                              EmbreeModel& built) const {
  bool bent = false;
  const std::vector<int>& part_of = parts[std::size_t(of)];
  for (unsigned g = 0; g < part_of.size(); ++g) {
    const Part& part = scene->models[std::size_t(of)].parts[std::size_t(part_of[g])];
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
