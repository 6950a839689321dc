#include "rilievo/layered_impostor/gl/layered_drawer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

constexpr int kMaxViews = shader::kMaxViewsAtHand;
static_assert(kMaxViews == int(ServingViews::kMaxCount));
constexpr std::size_t kInstances = shader::kMaxInstances;

// The frame as seen from an instance: its own axes, with the eye at the origin.
struct Local {
  glm::dvec3 eye;  // in the impostor's world
  glm::mat4 clip_from_local;
};

Local local_of(const Camera& frame, const LayeredInstance& instance) {
  const glm::dvec3 eye(glm::inverse(instance.world_from_impostor) *
                       glm::dvec4(frame.position(), 1));
  // Two steps in doubles that cancel large translations before floats see them.
  glm::dmat4 relative = instance.world_from_impostor;
  relative[3] = {0, 0, 0, 1};
  return {eye, glm::mat4(clip_from_relative(frame) * relative)};
}

shader::LayeredView view_block(const LayeredImpostor& impostor, int layer, const glm::dvec3& eye) {
  const Camera& camera = impostor.pictures[layer].camera;
  const glm::dmat3 axes(camera.world_from_eye);
  const auto& [l, r, b, t] = camera.window;
  const double w = camera.width, h = camera.height;
  const glm::dvec3 apex = camera.position() - eye, forward = -axes[2];
  // eye_z and (u w, v w) of a point P, from its offset to the apex.
  const glm::dvec3 u_row = (axes[0] - l * forward) * (w / (r - l));
  const glm::dvec3 v_row = (t * forward - axes[1]) * (h / (t - b));
  const auto row = [&](const glm::dvec3& v) {
    return glm::vec4(glm::vec3(v), float(-glm::dot(v, apex)));
  };
  return {row(u_row),
          row(v_row),
          row(forward),
          glm::vec4(glm::vec3(apex), camera.keeps_farthest() ? -1.0f : 1.0f),
          glm::vec4(glm::vec3(forward + l * axes[0] + t * axes[1]), float(layer)),
          glm::vec4(glm::vec3(axes[0] * ((r - l) / w)), float(w)),
          glm::vec4(glm::vec3(axes[1] * (-(t - b) / h)), float(h)),
          glm::vec4(float(camera.z_near), float(camera.z_far), impostor.complete[layer] ? 1 : 0,
                    impostor.sees_through[layer] ? 1 : 0)};
}

void set_state() {
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  glDisable(GL_SAMPLE_ALPHA_TO_COVERAGE);
}

}  // namespace

Result<LayeredDrawer> LayeredDrawer::create() {
  LayeredDrawer drawer;
  for (int output = 0; output < 2; ++output) {
    Result<gl::Program> surface = shader::make_surface_program(shader::LayeredOutput(output));
    if (!surface) return surface.error();
    drawer.surface_programs_[output] = std::move(*surface);
    Result<gl::Program> slice = shader::make_slice_program(shader::LayeredOutput(output));
    if (!slice) return slice.error();
    drawer.slice_programs_[output] = std::move(*slice);
  }
  Result<gl::Program> box = shader::make_box_program();
  if (!box) return box.error();
  drawer.box_program_ = std::move(*box);
  drawer.no_attributes_ = gl::make_vertex_array();
  drawer.slice_attributes_ = gl::make_vertex_array();
  for (GLuint i = 0; i < sizeof(shader::LayeredSlice) / sizeof(glm::vec4); ++i) {
    glEnableVertexArrayAttrib(drawer.slice_attributes_, i);
    glVertexArrayAttribFormat(drawer.slice_attributes_, i, 4, GL_FLOAT, GL_FALSE,
                              GLuint(i * sizeof(glm::vec4)));
    glVertexArrayAttribBinding(drawer.slice_attributes_, i, 0);
  }
  glVertexArrayBindingDivisor(drawer.slice_attributes_, 0, 1);
  return drawer;
}

void LayeredDrawer::draw(LayeredPictures& pictures, const Camera& frame,
                         std::span<const LayeredInstance> instances,
                         const LayeredOptions& options) {
  stats_ = {};
  const auto how = options.method == LayeredMethod::surfaces ? &LayeredDrawer::draw_surfaces
                                                             : &LayeredDrawer::draw_slices;
  (this->*how)(pictures, frame, instances, options, shader::LayeredOutput::color);
}

void LayeredDrawer::draw_objects(LayeredPictures& pictures, const Camera& frame,
                                 std::span<const LayeredInstance> instances,
                                 const LayeredOptions& options) {
  stats_ = {};
  const auto how = options.method == LayeredMethod::surfaces ? &LayeredDrawer::draw_surfaces
                                                             : &LayeredDrawer::draw_slices;
  (this->*how)(pictures, frame, instances, options, shader::LayeredOutput::objects);
}

void LayeredDrawer::draw_outlines(const LayeredPictures& pictures, const Camera& frame,
                                  std::span<const LayeredInstance> instances) {
  if (instances.empty()) return;
  const Box& bounds = pictures.impostor().bounds;
  set_state();
  glUseProgram(box_program_);
  glBindVertexArray(no_attributes_);
  for (const LayeredInstance& instance : instances) {
    const Local local = local_of(frame, instance);
    const glm::vec3 low(glm::dvec3(bounds.min) - local.eye),
        high(glm::dvec3(bounds.max) - local.eye);
    glUniformMatrix4fv(0, 1, GL_FALSE, &local.clip_from_local[0][0]);
    glUniform3fv(1, 1, &low[0]);
    glUniform3fv(2, 1, &high[0]);
    glDrawArrays(GL_LINES, 0, 24);
  }
}

void LayeredDrawer::draw_surfaces(LayeredPictures& pictures, const Camera& frame,
                                  std::span<const LayeredInstance> instances,
                                  const LayeredOptions& options, shader::LayeredOutput output) {
  RILIEVO_EXPECTS(frame.projection == Projection::perspective);
  if (instances.empty()) return;
  const LayeredImpostor& impostor = pictures.impostor();
  // Rounding must not cut off what lies on a face of the bounds.
  const glm::dvec3 slack(1e-4 * double(impostor.bounds.radius()) + 1e-9);
  const LayeredPictures::SurfaceTextures textures = pictures.surface_textures();
  glUseProgram(surface_programs_[int(output)]);
  glUniform1iv(2, GLsizei(textures.level_at.size()), textures.level_at.data());
  glBindTextureUnit(0, pictures.color_texture());
  glBindTextureUnit(1, textures.q);
  glBindTextureUnit(2, textures.slope);
  glBindTextureUnit(3, textures.links);
  glBindTextureUnit(4, textures.cells);
  if (output == shader::LayeredOutput::objects) {
    glUniform1i(1, pictures.object_texture() != 0);
    glBindTextureUnit(5, pictures.object_texture());
  }
  set_state();
  // Back faces, however far away.
  glEnable(GL_CULL_FACE);
  glCullFace(GL_FRONT);
  glFrontFace(GL_CCW);
  glEnable(GL_DEPTH_CLAMP);
  glBindVertexArray(no_attributes_);
  while (!instances.empty()) {
    const auto some = instances.first(std::min(instances.size(), kInstances));
    instances = instances.subspan(some.size());
    views_.clear();
    blocks_.clear();
    for (const LayeredInstance& instance : some) {
      const Local local = local_of(frame, instance);
      const ServingViews served = views_for_eye(impostor, local.eye, options);
      shader::LayeredInstanceBlock block;
      block.clip_from_local = local.clip_from_local;
      block.box_min = glm::vec4(glm::vec3(glm::dvec3(impostor.bounds.min) - slack - local.eye),
                                float(served.asked));
      block.box_max = glm::vec4(glm::vec3(glm::dvec3(impostor.bounds.max) + slack - local.eye), 0);
      for (int i = 0; i < kMaxViews; ++i) block.weights[i / 4][i % 4] = served.weights[i];
      block.views = {int(views_.size()), served.count, served.weighted, int(instance.object)};
      blocks_.push_back(block);
      for (int i = 0; i < served.count; ++i)
        views_.push_back(view_block(impostor, served.views[i], local.eye));
    }
    stats_.views += int(views_.size());
    // A block must be there as a whole.
    views_.resize(kInstances * std::size_t(kMaxViews));
    blocks_.resize(kInstances);
    view_buffer_.upload_and_bind(GL_UNIFORM_BUFFER, 0, std::as_bytes(std::span(views_)));
    instance_buffer_.upload_and_bind(GL_UNIFORM_BUFFER, 1, std::as_bytes(std::span(blocks_)));
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 14, GLsizei(some.size()));
  }
  glDisable(GL_DEPTH_CLAMP);
  glCullFace(GL_BACK);
  glDisable(GL_CULL_FACE);
}

void LayeredDrawer::draw_slices(LayeredPictures& pictures, const Camera& frame,
                                std::span<const LayeredInstance> instances,
                                const LayeredOptions& options, shader::LayeredOutput output) {
  RILIEVO_EXPECTS(frame.projection == Projection::perspective);
  const LayeredImpostor& impostor = pictures.impostor();
  const GLuint interval = pictures.interval_texture();
  for (const LayeredInstance& instance : instances) {
    const Local local = local_of(frame, instance);
    SliceChooser& chooser = pictures.slice_chooser();
    chooser.choose(impostor, local.eye, options);
    views_.clear();
    slices_.clear();
    const SliceQuad* last = nullptr;
    for (const SliceQuad& quad : chooser.quads()) {
      if (!last || last->view != quad.view)
        views_.push_back(view_block(impostor, quad.view, local.eye));
      last = &quad;
      const Slice& slice = impostor.slices[quad.view][quad.slice];
      const SliceScale scale = slice_scale(impostor, quad.view);
      stats_.texels +=
          double(quad.texels.z - quad.texels.x) * double(quad.texels.w - quad.texels.y);
      slices_.push_back({quad.texels,
                         glm::vec4(slice.eye_z, scale(slice.front), scale(slice.back), 0),
                         glm::vec4(quad.from, quad.to, float(views_.size() - 1),
                                   std::bit_cast<float>(instance.object))});
    }
    stats_.slices += chooser.slices();
    stats_.views += int(views_.size());
    stats_.quads += slices_.size();
    if (slices_.empty()) continue;
    const auto bytes = std::as_bytes(std::span(slices_));
    if (bytes.size() > slice_capacity_) {
      slice_capacity_ = bytes.size() + bytes.size() / 2;
      slice_buffer_ = gl::make_buffer(slice_capacity_, nullptr, GL_DYNAMIC_STORAGE_BIT);
    }
    glInvalidateBufferData(slice_buffer_);
    glNamedBufferSubData(slice_buffer_, 0, GLsizeiptr(bytes.size()), bytes.data());
    glVertexArrayVertexBuffer(slice_attributes_, 0, slice_buffer_, 0, sizeof(shader::LayeredSlice));
    view_buffer_.upload_and_bind(GL_SHADER_STORAGE_BUFFER, 0, std::as_bytes(std::span(views_)));
    glUseProgram(slice_programs_[int(output)]);
    glUniformMatrix4fv(0, 1, GL_FALSE, &local.clip_from_local[0][0]);
    glBindTextureUnit(0, pictures.color_texture());
    glBindTextureUnit(1, interval);
    if (output == shader::LayeredOutput::objects) {
      glUniform1i(1, pictures.object_texture() != 0);
      glBindTextureUnit(5, pictures.object_texture());
    }
    set_state();
    glDisable(GL_CULL_FACE);
    glBindVertexArray(slice_attributes_);
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, GLsizei(slices_.size()));
  }
}

}  // namespace rilievo
