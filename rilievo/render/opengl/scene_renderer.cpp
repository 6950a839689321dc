#include "rilievo/render/opengl/scene_renderer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "rilievo/core/expects.h"
#include "rilievo/render/draw_list.h"
#include "rilievo/render/opengl/gpu_scene.h"
#include "rilievo/render/opengl/scene_shaders.h"
#include "rilievo/render/opengl/stroke_shaders.h"

namespace rilievo {
namespace {

shader::LightBlock light_block(const Light& light, const glm::dvec3& eye) {
  shader::LightBlock block;
  block.position_range = glm::vec4(glm::vec3(glm::dvec3(light.position) - eye), light.range);
  block.direction_kind = glm::vec4(light.direction, float(light.kind));
  block.intensity_inner = glm::vec4(light.intensity, std::cos(light.inner_cone));
  block.outer = glm::vec4(std::cos(light.outer_cone), 0, 0, 0);
  return block;
}

bool lit_by_one_sun(const Scene& scene) {
  return scene.lights.empty() ||
         (scene.lights.size() == 1 && scene.lights[0].kind == Light::Kind::directional);
}

shader::ViewBlock view_block(const Camera& camera, const Scene& scene, const Sky& sky) {
  shader::ViewBlock view;
  const glm::dmat4 clip = clip_from_relative(camera);
  view.clip_from_relative = glm::mat4(clip);
  view.relative_from_clip = glm::mat4(glm::inverse(clip));
  const bool parallel = camera.projection == Projection::parallel;
  view.eye_direction = glm::vec4(
      glm::vec3((camera.keeps_farthest() ? 1.0 : -1.0) * camera.forward()), parallel ? 0.0f : 1.0f);
  view.zenith = glm::vec4(sky.zenith, 0);
  view.horizon = glm::vec4(sky.horizon, 0);
  view.ground = glm::vec4(sky.ground, 0);
  const Light first = scene.lights.empty() ? default_sun() : scene.lights[0];
  view.sun_direction_count = glm::vec4(first.direction, float(scene.lights.size()));
  view.sun_intensity = glm::vec4(first.intensity, 0);
  view.raster = glm::vec4(camera.width, camera.height, 0, 0);
  return view;
}

}  // namespace

struct SceneRenderer::State {
  const Scene* scene;
  GpuScene gpu;
  std::map<unsigned, gl::Program> programs;
  std::map<std::string, gl::Program, std::less<>> kept;  // of passes, by name
  gl::Program sky[2];                                    // srgb, linear
  gl::VertexArray no_vertices;

  PlacedScene placed;

  DrawList list;
  float least_roughness = 0;  // of draw_at_depth()
  std::vector<GpuInstance> staging;
  std::vector<glm::vec2> shares;  // by object, while shares are drawn; else empty
  std::vector<std::uint32_t> shared_objects, shared_in;  // shared_in: by object, the last pass
  std::uint32_t shared_pass = 0;
  std::vector<CrossFade> waiting;
  std::vector<shader::LightBlock> lights;
  gl::StreamBuffer view_buffer, light_buffer;
  gl::Buffer instance_buffer;
  std::size_t instance_capacity = 0;

  explicit State(const Scene& scene) : scene(&scene), placed(scene) {}
  Result<> compile();
  Result<const gl::Program*> program(unsigned features);
  void upload_view(const Camera& camera) { upload_view(camera, scene->sky); }
  void upload_view(const Camera& camera, const Sky& sky);
  void upload_lights(const Camera& camera);
  void upload_instances();
  void draw_list(const Camera& camera, unsigned extra_features, bool farthest = false);
  void draw_mesh(const GpuMesh& mesh, const Batch& batch, GLuint program,
                 float texels_per_pixel) const;
  void draw_ranges(const Camera& camera, std::span<const CrossFade> ranges, unsigned features);
};

// Compiled by create(); later only if the scene's lights have become others.
Result<const gl::Program*> SceneRenderer::State::program(unsigned features) {
  if (!lit_by_one_sun(*scene)) features |= shader::kAnyLights;
  if (scene->lights.size() > shader::kFewLights) features |= shader::kManyLights;
  if (features & (shader::kUnlit | shader::kObjectIds)) features &= ~shader::kOfLight;
  if (features & shader::kObjectIds) features &= ~shader::kPositionCode;
  const auto found = programs.find(features);
  if (found != programs.end()) return &found->second;
  Result<gl::Program> made = shader::make_scene_program(features);
  if (!made) return made.error();
  return &programs.emplace(features, std::move(*made)).first->second;
}

Result<> SceneRenderer::State::compile() {
  using namespace shader;
  std::set<unsigned> used;
  for (const GpuMaterial& material : gpu.materials) used.insert(material.features);
  for (const GpuMesh& mesh : gpu.meshes)
    used.insert(gpu.materials[std::size_t(mesh.material)].features | mesh.features);
  for (const unsigned features : used)
    for (const unsigned extra :
         {0u, +kLinear, +kObjectIds, +kShare, kShare | kLinear, kShare | kObjectIds,
          +kBackPerspective, kBackPerspective | kLinear})
      if (auto made = program(features | extra); !made) return made.error();
  for (bool linear : {false, true}) {
    Result<gl::Program> made = make_sky_program(linear);
    if (!made) return made.error();
    sky[linear] = std::move(*made);
  }
  return Done{};
}

void SceneRenderer::State::upload_view(const Camera& camera, const Sky& sky) {
  const shader::ViewBlock view = view_block(camera, *scene, sky);
  view_buffer.upload_and_bind(GL_UNIFORM_BUFFER, 0, std::as_bytes(std::span(&view, 1)));
}

void SceneRenderer::State::upload_lights(const Camera& camera) {
  lights.clear();
  for (const Light& light : scene->lights) lights.push_back(light_block(light, camera.position()));
  const bool few = lights.size() <= shader::kFewLights;
  if (few) lights.resize(shader::kFewLights);  // all of a uniform block is bound
  light_buffer.upload_and_bind(few ? GL_UNIFORM_BUFFER : GL_SHADER_STORAGE_BUFFER,
                               shader::kLightsBinding, std::as_bytes(std::span(lights)));
}

void SceneRenderer::State::upload_instances() {
  staging.clear();
  for (const Placement& placement : list.instances()) {
    const glm::mat4 rows = glm::transpose(placement.relative_from_mesh);
    const glm::vec2 share = shares.empty() ? glm::vec2(0, 1) : shares[placement.object];
    staging.push_back({{rows[0], rows[1], rows[2]}, placement.object + 1, share.x, share.y, 0});
  }
  for (const Batch& batch : list.batches()) {
    const GpuMesh& mesh = gpu.meshes[batch.mesh];
    if (mesh.width <= 0) continue;
    for (std::uint32_t i = batch.first; i < batch.first + batch.count; ++i)
      staging[i].radius = float(0.5 * double(mesh.width) *
                                smallest_stretch(list.instances()[i].relative_from_mesh));
  }
  if (staging.size() > instance_capacity || !instance_buffer) {
    instance_capacity = staging.size() + staging.size() / 2 + 64;
    instance_buffer =
        gl::make_buffer(instance_capacity * sizeof(GpuInstance), nullptr, GL_DYNAMIC_STORAGE_BIT);
  }
  if (staging.empty()) return;
  glInvalidateBufferData(instance_buffer);
  glNamedBufferSubData(instance_buffer, 0, GLsizeiptr(staging.size() * sizeof(GpuInstance)),
                       staging.data());
}

// `farthest`: the last surface instead of the first along each line of sight, back faces included.
void SceneRenderer::State::draw_list(const Camera& camera, unsigned extra_features, bool farthest) {
  if (list.batches().empty()) return;
  upload_view(camera);
  if (!(extra_features & shader::kObjectIds) && !lit_by_one_sun(*scene)) upload_lights(camera);
  upload_instances();
  for (const GLuint array : {GLuint(gpu.vertex_array), GLuint(gpu.stroke_array)})
    glVertexArrayVertexBuffer(array, kInstanceBinding, instance_buffer, 0, sizeof(GpuInstance));
  glEnable(GL_DEPTH_TEST);
  const bool peel = extra_features & shader::kPeel;
  if (peel && !(extra_features & shader::kObjectIds))
    glDepthFunc(GL_EQUAL);
  else
    glDepthFunc(camera.keeps_farthest() != farthest ? GL_GREATER : GL_LESS);
  glFrontFace(GL_CCW);

  int bound_material = -1;
  unsigned bound_features = 0;  // of meshes
  GLuint bound_program = 0;
  glDisable(GL_SAMPLE_ALPHA_TO_COVERAGE);  // masks make their own
  for (const Batch& batch : list.batches()) {
    const GpuMesh& mesh = gpu.meshes[batch.mesh];
    const GpuMaterial& material = gpu.materials[std::size_t(mesh.material)];
    if (mesh.material != bound_material || mesh.features != bound_features) {
      bound_material = mesh.material, bound_features = mesh.features;
      const unsigned features = material.features | mesh.features | extra_features |
                                (camera.keeps_farthest() ? shader::kBackPerspective : 0u);
      const Result<const gl::Program*> program_of_material = program(features);
      // The same source as of create(), but for the lights.
      RILIEVO_EXPECTS(program_of_material.ok());
      bound_program = **program_of_material;
      glUseProgram(bound_program);
      glBindBufferRange(GL_UNIFORM_BUFFER, 1, gpu.material_blocks, material.block_offset,
                        sizeof(GpuMaterialBlock));
      if (features & shader::kTextures)
        for (GLuint unit = 0; unit < kMaterialUnits; ++unit)
          glBindTextureUnit(unit, gpu.textures[std::size_t(material.textures[unit])]);
      // Not there in programs that shade nothing.
      if (peel) {
        glUniform1i(glGetUniformLocation(bound_program, "double_sided"),
                    material.double_sided || mesh.features != 0);
        glUniform1f(glGetUniformLocation(bound_program, "least_roughness"), least_roughness);
      }
      if (material.double_sided || mesh.features != 0 || farthest || peel)
        glDisable(GL_CULL_FACE);
      else
        glEnable(GL_CULL_FACE);
    }
    // Seen from an apex behind the object, the faces that the viewer sees are the ones turned away.
    glCullFace(batch.mirrored != camera.keeps_farthest() ? GL_FRONT : GL_BACK);
    draw_mesh(mesh, batch, bound_program, camera.texels_per_pixel);
  }
}

void SceneRenderer::State::draw_mesh(const GpuMesh& mesh, const Batch& batch, GLuint program,
                                     float texels_per_pixel) const {
  if (mesh.primitive == Primitive::triangles) {
    glBindVertexArray(gpu.vertex_array);
    glDrawElementsInstancedBaseVertexBaseInstance(
        GL_TRIANGLES, mesh.index_count, GL_UNSIGNED_INT,
        reinterpret_cast<const void*>(std::uintptr_t(mesh.first_index) * sizeof(std::uint32_t)),
        GLsizei(batch.count), mesh.base_vertex, batch.first);
    return;
  }
  glBindVertexArray(gpu.stroke_array);
  glUniform1f(glGetUniformLocation(program, "stroke_radius_px"),
              0.5f * mesh.width_px * texels_per_pixel);
  const GLsizei corners = GLsizei(corners_of(mesh.primitive)), all = mesh.primitives * corners;
  for (GLsizei first = 0; first < all; first += kStrokeChunk) {
    const GLsizei count = std::min(kStrokeChunk, all - first);
    const GLintptr at = GLintptr(mesh.base_vertex) + first;
    const auto bind = [&](GLuint binding, const gl::Buffer& buffer, GLsizeiptr bytes) {
      glBindBufferRange(GL_SHADER_STORAGE_BUFFER, binding, buffer, at * bytes,
                        GLsizeiptr(count) * bytes);
    };
    bind(shader::kStrokeVertices, gpu.vertices, kVertexBytes);
    if (gpu.materials[std::size_t(mesh.material)].features & shader::kTextures)
      bind(shader::kStrokeUvs, gpu.uvs, kUvBytes);
    const int each =
        mesh.primitive == Primitive::points ? shader::kDiscVertices : shader::kLineVertices;
    glDrawArraysInstancedBaseInstance(GL_TRIANGLES, 0, count / corners * each, GLsizei(batch.count),
                                      batch.first);
  }
}

SceneRenderer::SceneRenderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
SceneRenderer::SceneRenderer(SceneRenderer&&) noexcept = default;
SceneRenderer& SceneRenderer::operator=(SceneRenderer&&) noexcept = default;
SceneRenderer::~SceneRenderer() = default;

Result<SceneRenderer> SceneRenderer::create(const Scene& scene) {
  auto state = std::make_unique<State>(scene);
  Result<GpuScene> gpu = upload(scene);
  if (!gpu) return gpu.error();
  state->gpu = std::move(*gpu);
  state->no_vertices = gl::make_vertex_array();
  if (Result<> ok = state->compile(); !ok) return ok.error();
  return SceneRenderer(std::move(state));
}

void SceneRenderer::set_time(double time) { state_->placed.set_time(time); }
const PlacedScene& SceneRenderer::placed() const { return state_->placed; }

void SceneRenderer::draw_opaque(const Camera& camera, std::span<const std::uint32_t> objects,
                                OutputEncoding encoding) {
  State& s = *state_;
  s.list.build_front_to_back(*s.scene, camera, objects, s.placed.poses(), s.placed.bounds(),
                             s.placed.opaque_meshes());
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  s.draw_list(camera, encoding == OutputEncoding::linear ? unsigned(shader::kLinear) : 0u);
}

// One range of each object at a time.
void SceneRenderer::State::draw_ranges(const Camera& camera, std::span<const CrossFade> ranges,
                                       unsigned features) {
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  shares.resize(placed.bounds().size());
  shared_in.resize(placed.bounds().size(), 0);
  waiting.assign(ranges.begin(), ranges.end());
  while (!waiting.empty()) {
    ++shared_pass;
    shared_objects.clear();
    std::erase_if(waiting, [&](const CrossFade& share) {
      if (shared_in[share.object] == shared_pass) return false;
      shared_in[share.object] = shared_pass;
      shares[share.object] = {share.from, share.to};
      shared_objects.push_back(share.object);
      return true;
    });
    list.build_front_to_back(*scene, camera, shared_objects, placed.poses(), placed.bounds(),
                             placed.opaque_meshes());
    draw_list(camera, shader::kShare | features);
  }
  shares.clear();
}

void SceneRenderer::draw_cross_fades(const Camera& camera, std::span<const CrossFade> shares,
                                     OutputEncoding encoding) {
  state_->draw_ranges(camera, shares,
                      encoding == OutputEncoding::linear ? unsigned(shader::kLinear) : 0u);
}

void SceneRenderer::draw_fading_objects(const Camera& camera, std::span<const CrossFade> fading) {
  state_->draw_ranges(camera, fading, shader::kObjectIds);
}

void SceneRenderer::draw_blended(const Camera& camera, std::span<const std::uint32_t> objects,
                                 OutputEncoding encoding) {
  State& s = *state_;
  s.list.build_back_to_front(*s.scene, camera, objects, s.placed.poses(), s.placed.bounds(),
                             s.placed.blended_meshes());
  if (s.list.batches().empty()) return;
  glDepthMask(GL_FALSE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  s.draw_list(camera, encoding == OutputEncoding::linear ? unsigned(shader::kLinear) : 0u);
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
}

void SceneRenderer::draw_objects(const Camera& camera, std::span<const std::uint32_t> objects) {
  State& s = *state_;
  s.list.build_front_to_back(*s.scene, camera, objects, s.placed.poses(), s.placed.bounds(),
                             s.placed.opaque_meshes());
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  s.draw_list(camera, unsigned(shader::kObjectIds));
}

void SceneRenderer::draw_hindmost(const Camera& camera, std::span<const std::uint32_t> objects) {
  State& s = *state_;
  s.list.build_front_to_back(*s.scene, camera, objects, s.placed.poses(), s.placed.bounds(),
                             s.placed.opaque_meshes());
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  s.draw_list(camera, unsigned(shader::kObjectIds), true);
}

void SceneRenderer::draw_objects_behind(const Camera& camera,
                                        std::span<const std::uint32_t> objects,
                                        unsigned peeled_depth) {
  State& s = *state_;
  s.list.build_front_to_back(*s.scene, camera, objects, s.placed.poses(), s.placed.bounds(),
                             s.placed.opaque_meshes());
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  glBindTextureUnit(shader::kPeeledUnit, peeled_depth);
  s.draw_list(camera, shader::kObjectIds | shader::kPeel);
}

void SceneRenderer::draw_at_depth(const Camera& camera, std::span<const std::uint32_t> objects,
                                  float least_roughness) {
  State& s = *state_;
  s.list.build_front_to_back(*s.scene, camera, objects, s.placed.poses(), s.placed.bounds(),
                             s.placed.opaque_meshes());
  glDepthMask(GL_FALSE);
  glDisable(GL_BLEND);
  s.least_roughness = least_roughness;
  s.draw_list(camera, shader::kLinear | shader::kPeel);
  glDepthMask(GL_TRUE);
}

void SceneRenderer::draw_sky(const Camera& camera, OutputEncoding encoding) {
  draw_sky(state_->scene->sky, camera, encoding);
}

void SceneRenderer::draw_sky(const Sky& sky, const Camera& camera, OutputEncoding encoding) {
  State& s = *state_;
  s.upload_view(camera, sky);
  glUseProgram(s.sky[encoding == OutputEncoding::linear]);
  glBindVertexArray(s.no_vertices);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_FALSE);
  glDepthFunc(GL_LEQUAL);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDepthMask(GL_TRUE);
}

Result<GLuint> SceneRenderer::kept_program(std::string_view name,
                                           Result<gl::Program> (*make)(std::string_view name)) {
  auto found = state_->kept.find(name);
  if (found == state_->kept.end()) {
    Result<gl::Program> made = make(name);
    if (!made) return made.error();
    found = state_->kept.emplace(name, std::move(*made)).first;
  }
  return GLuint(found->second);
}

}  // namespace rilievo
