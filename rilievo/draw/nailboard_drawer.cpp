#include "rilievo/draw/nailboard_drawer.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "rilievo/draw/nailboard_shaders.h"

namespace rilievo {

struct NailboardDrawer::Instance {
  glm::vec4 origin_layer, u_axis_slot_x, v_axis_slot_y, eye_slot_width, forward_slot_height, depths,
      share;
};

namespace {

constexpr GLuint kAttributes = 7;

// The picture's polygon in the world, as of its capture: lower left corner and the edges from
// there.
struct Polygon {
  glm::dvec3 origin, u_axis, v_axis;
};

Polygon polygon_of(const PictureGeometry& geometry) {
  const Camera& c = geometry.capture;
  const double w = c.width, h = c.height;
  // Raster space runs downwards, OpenGL's textures upwards.
  const glm::dvec3 origin = world_from_raster(c, {0, h}, geometry.plane_z);
  return {origin, world_from_raster(c, {w, h}, geometry.plane_z) - origin,
          world_from_raster(c, {0, 0}, geometry.plane_z) - origin};
}

}  // namespace

Result<NailboardDrawer> NailboardDrawer::create() {
  NailboardDrawer drawer;
  for (int mode = 0; mode < 3; ++mode)
    for (int output = 0; output < 3; ++output) {
      Result<gl::Program> program =
          shader::make_nailboard_program(DepthMode(mode), shader::NailboardOutput(output));
      if (!program) return program.error();
      drawer.programs_[mode][output] = std::move(*program);
    }
  Result<gl::Program> outline = shader::make_outline_program();
  if (!outline) return outline.error();
  drawer.outline_ = std::move(*outline);
  drawer.vertex_array_ = gl::make_vertex_array();
  for (GLuint i = 0; i < kAttributes; ++i) {
    glEnableVertexArrayAttrib(drawer.vertex_array_, i);
    glVertexArrayAttribFormat(drawer.vertex_array_, i, 4, GL_FLOAT, GL_FALSE,
                              GLuint(i * sizeof(glm::vec4)));
    glVertexArrayAttribBinding(drawer.vertex_array_, i, 0);
  }
  glVertexArrayBindingDivisor(drawer.vertex_array_, 0, 1);
  return drawer;
}

void NailboardDrawer::upload(const Camera& frame, std::span<const NailboardInstance> instances) {
  const glm::dvec3 eye = frame.position();
  glm::dmat4 turn = frame.world_from_eye;
  turn[3] = {0, 0, 0, 1};
  clip_from_relative_ = glm::mat4(clip_from_eye(frame) * glm::transpose(turn));

  // Front to back, so that what is hidden is not shaded.
  order_.clear();
  whole_ = 0;
  for (std::uint32_t i = 0; i < instances.size(); ++i) {
    const PictureGeometry& g = instances[i].geometry;
    const glm::dvec3 middle = g.capture.position() + g.capture.forward() * g.plane_z;
    const glm::dvec3 to =
        glm::dvec3(instances[i].world_now_from_capture * glm::dvec4(middle, 1)) - eye;
    const bool share = instances[i].share_from > 0 || instances[i].share_to < 1;
    whole_ += !share;
    order_.push_back({share, float(glm::dot(to, to)), i});
  }
  std::sort(order_.begin(), order_.end(), [](const Key& a, const Key& b) {
    if (a.share != b.share) return b.share;
    return a.distance != b.distance ? a.distance < b.distance : a.index < b.index;
  });

  staging_.resize(order_.size() * sizeof(Instance));
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const NailboardInstance& in = instances[order_[i].index];
    const Camera& capture = in.geometry.capture;
    const Polygon polygon = polygon_of(in.geometry);
    const glm::dmat4& motion = in.world_now_from_capture;
    const glm::dmat3 turned(motion);
    const auto point = [&](const glm::dvec3& p) {
      return glm::vec3(glm::dvec3(motion * glm::dvec4(p, 1)) - eye);
    };
    const Instance out{glm::vec4(point(polygon.origin), float(in.slot.layer)),
                       glm::vec4(glm::vec3(turned * polygon.u_axis), float(in.slot.x)),
                       glm::vec4(glm::vec3(turned * polygon.v_axis), float(in.slot.y)),
                       glm::vec4(point(capture.position()), float(in.slot.width)),
                       glm::vec4(glm::vec3(turned * capture.forward()), float(in.slot.height)),
                       glm::vec4(float(capture.z_near), float(capture.z_far),
                                 float(in.geometry.plane_z), std::bit_cast<float>(in.object)),
                       glm::vec4(in.share_from, in.share_to, 0, 0)};
    std::memcpy(staging_.data() + i * sizeof(Instance), &out, sizeof out);
  }
  if (staging_.size() > capacity_ || !instance_buffer_) {
    capacity_ = staging_.size() + staging_.size() / 2 + 64 * sizeof(Instance);
    instance_buffer_ = gl::make_buffer(capacity_, nullptr, GL_DYNAMIC_STORAGE_BIT);
  }
  glInvalidateBufferData(instance_buffer_);
  glNamedBufferSubData(instance_buffer_, 0, GLsizeiptr(staging_.size()), staging_.data());
  glVertexArrayVertexBuffer(vertex_array_, 0, instance_buffer_, 0, sizeof(Instance));
  glBindVertexArray(vertex_array_);
}

void NailboardDrawer::draw_polygons(const PictureAtlas& atlas, DepthMode mode,
                                    shader::NailboardOutput output, std::size_t first,
                                    std::size_t count) {
  if (count == 0) return;
  const bool objects = output == shader::NailboardOutput::objects;
  glUseProgram(programs_[int(mode)][int(output)]);
  glUniformMatrix4fv(0, 1, GL_FALSE, &clip_from_relative_[0][0]);
  const float steps = float(delta_steps(atlas.delta_bits()));
  glUniform1f(1, (atlas.delta_bits() > 8 ? 65535.0f : 255.0f) / steps);
  // Half a step above 1: the reserved code is a whole step above.
  glUniform1f(2, 1.0f + 0.5f / steps);
  glBindTextureUnit(0, atlas.color_texture());
  glBindTextureUnit(1, atlas.delta_texture());
  if (objects) glBindTextureUnit(2, atlas.object_texture());
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  if (objects)
    glDisable(GL_SAMPLE_ALPHA_TO_COVERAGE);
  else
    glEnable(GL_SAMPLE_ALPHA_TO_COVERAGE);
  glDrawArraysInstancedBaseInstance(GL_TRIANGLE_STRIP, 0, 4, GLsizei(count), GLuint(first));
  glDisable(GL_SAMPLE_ALPHA_TO_COVERAGE);
}

void NailboardDrawer::draw(const PictureAtlas& atlas, const Camera& frame, DepthMode mode,
                           std::span<const NailboardInstance> instances) {
  if (instances.empty()) return;
  upload(frame, instances);
  draw_polygons(atlas, mode, shader::NailboardOutput::color, 0, whole_);
  draw_polygons(atlas, mode, shader::NailboardOutput::share_of_color, whole_,
                instances.size() - whole_);
}

void NailboardDrawer::draw_objects(const PictureAtlas& atlas, const Camera& frame, DepthMode mode,
                                   std::span<const NailboardInstance> instances) {
  if (instances.empty()) return;
  upload(frame, instances);
  draw_polygons(atlas, mode, shader::NailboardOutput::objects, 0, instances.size());
}

void NailboardDrawer::draw_outlines(const Camera& frame,
                                    std::span<const NailboardInstance> instances,
                                    const glm::vec3& color) {
  if (instances.empty()) return;
  upload(frame, instances);
  glUseProgram(outline_);
  glUniformMatrix4fv(0, 1, GL_FALSE, &clip_from_relative_[0][0]);
  glUniform3f(1, color.r, color.g, color.b);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_FALSE);
  glDisable(GL_BLEND);
  glDrawArraysInstanced(GL_LINE_LOOP, 0, 4, GLsizei(instances.size()));
  glDepthMask(GL_TRUE);
}

}  // namespace rilievo
