#include "rilievo/nailboard/gl/nailboard_drawer.h"

#include <algorithm>
#include <bit>

#include "rilievo/nailboard/gl/nailboard_shaders.h"

namespace rilievo {

namespace {

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

Result<NailboardDrawer> NailboardDrawer::create(SampleRounding rounding) {
  NailboardDrawer drawer;
  drawer.rounding_ = rounding;
  for (int mode = 0; mode < 3; ++mode)
    for (int output = 0; output < 3; ++output) {
      Result<gl::Program> program =
          shader::make_nailboard_program(DepthMode(mode), shader::NailboardOutput(output));
      if (!program) return program.error();
      drawer.programs_[mode][output] = std::move(*program);
    }
  Result<gl::Program> outline = shader::make_nailboard_outline_program();
  if (!outline) return outline.error();
  drawer.outline_ = std::move(*outline);
  drawer.vertex_array_ = gl::make_vertex_array();
  return drawer;
}

void NailboardDrawer::place(const Camera& frame, std::span<const NailboardInstance> instances) {
  const glm::dvec3 eye = frame.position();
  clip_from_relative_ = glm::mat4(clip_from_relative(frame));

  // Front to back, so that what is hidden is not shaded.
  order_.clear();
  for (std::uint32_t i = 0; i < instances.size(); ++i) {
    const PictureGeometry& g = instances[i].geometry;
    const glm::dvec3 middle = g.capture.position() + g.capture.forward() * g.plane_z;
    const glm::dvec3 to =
        glm::dvec3(instances[i].world_now_from_capture * glm::dvec4(middle, 1)) - eye;
    order_.push_back({float(glm::dot(to, to)), i});
  }
  std::sort(order_.begin(), order_.end(), [](const Key& a, const Key& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.index < b.index;
  });
  rank_.resize(order_.size());
  for (std::uint32_t i = 0; i < order_.size(); ++i) rank_[order_[i].index] = i;

  staging_.clear();
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const NailboardInstance& in = instances[order_[i].index];
    const Camera& capture = in.geometry.capture;
    const Polygon polygon = polygon_of(in.geometry);
    const glm::dmat4& motion = in.world_now_from_capture;
    const glm::dmat3 turned(motion);
    const auto point = [&](const glm::dvec3& p) {
      return glm::vec3(glm::dvec3(motion * glm::dvec4(p, 1)) - eye);
    };
    staging_.push_back({glm::vec4(point(polygon.origin), float(in.slot.layer)),
                        glm::vec4(glm::vec3(turned * polygon.u_axis), float(in.slot.x)),
                        glm::vec4(glm::vec3(turned * polygon.v_axis), float(in.slot.y)),
                        glm::vec4(point(capture.position()), float(in.slot.width)),
                        glm::vec4(glm::vec3(turned * capture.forward()), float(in.slot.height)),
                        glm::vec4(float(capture.z_near), float(capture.z_far),
                                  float(in.geometry.plane_z), std::bit_cast<float>(in.object)),
                        glm::vec4(in.share_from, in.share_to, 0, 0),
                        {}});
  }
}

void NailboardDrawer::upload() {
  instance_buffer_.upload_and_bind(GL_SHADER_STORAGE_BUFFER, 0, std::as_bytes(std::span(staging_)));
  glBindVertexArray(vertex_array_);
}

void NailboardDrawer::find_cells(NailboardAtlas& atlas, const Camera& frame, DepthMode mode,
                                 std::span<const NailboardInstance> instances) {
  GLint viewport[4];
  glGetIntegerv(GL_VIEWPORT, viewport);
  frame_size_ = {viewport[2], viewport[3]};
  standing_.clear();
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const NailboardInstance& in = instances[order_[i].index];
    const Instance& placed = staging_[i];
    PlacedPolygon standing;
    standing.origin = placed.origin_layer, standing.eye = placed.eye_slot_width;
    standing.u_axis = placed.u_axis_slot_x, standing.v_axis = placed.v_axis_slot_y;
    standing.z_near = in.geometry.capture.z_near, standing.z_far = in.geometry.capture.z_far;
    standing.plane_z = in.geometry.plane_z;
    standing.relief = mode != DepthMode::flat;
    // Depths by eq. (4) are not between those of the surface.
    standing.hides = mode != DepthMode::linear;
    standing.share = in.share_from > 0 || in.share_to < 1;
    if (in.partner) standing.partner = rank_[*in.partner];
    standing.blocks = atlas.blocks(in.slot);
    standing_.push_back(standing);
  }
  visible_.find(glm::dmat4(clip_from_relative_), viewport[2], viewport[3], frame.z_near,
                frame.z_far, standing_);
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const glm::mat3 texel_from_raster(visible_.texel_from_raster(i));
    for (int k = 0; k < 3; ++k)
      staging_[i].texel_from_raster[k] = glm::vec4(texel_from_raster[k], 0);
  }
  const std::span<const DrawnCells> cells = visible_.drawn();
  static_assert(sizeof(DrawnCells) == 12, "three words, as the vertex shader reads them");
  cell_buffer_.upload_and_bind(GL_SHADER_STORAGE_BUFFER, 1, std::as_bytes(cells));
  if (cells.size() <= index_capacity_) return;
  index_capacity_ = 2 * cells.size();
  std::vector<std::uint32_t> indices;
  for (std::uint32_t i = 0; i < index_capacity_; ++i)
    for (const std::uint32_t corner : {0, 1, 2, 2, 1, 3}) indices.push_back(4 * i + corner);
  index_buffer_ = gl::make_buffer(indices.size() * sizeof(std::uint32_t), indices.data(), 0);
  glVertexArrayElementBuffer(vertex_array_, index_buffer_);
}

void NailboardDrawer::draw_cells(const NailboardAtlas& atlas, DepthMode mode,
                                 shader::NailboardOutput output, std::size_t first,
                                 std::size_t count) {
  if (count == 0) return;
  const bool objects = output == shader::NailboardOutput::objects;
  glUseProgram(programs_[int(mode)][int(output)]);
  glUniformMatrix4fv(0, 1, GL_FALSE, &clip_from_relative_[0][0]);
  glUniform1f(1, atlas.delta_scale());
  glUniform1f(2, atlas.largest_delta());
  glUniform2f(3, 2.0f / frame_size_.x, 2.0f / frame_size_.y);
  glBindTextureUnit(0, atlas.color_texture());
  glBindTextureUnit(1, atlas.delta_texture());
  if (objects) glBindTextureUnit(2, atlas.object_texture());
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  const bool nearest = rounding_ == SampleRounding::nearest;
  if (!objects) glUniform1i(4, nearest);
  if (objects || nearest)
    glDisable(GL_SAMPLE_ALPHA_TO_COVERAGE);
  else
    glEnable(GL_SAMPLE_ALPHA_TO_COVERAGE), glEnable(GL_SAMPLE_ALPHA_TO_ONE);
  for (GLenum side = 0; side < 4; ++side) glEnable(GL_CLIP_DISTANCE0 + side);
  glDrawElements(GL_TRIANGLES, GLsizei(6 * count), GL_UNSIGNED_INT,
                 reinterpret_cast<const void*>(6 * first * sizeof(std::uint32_t)));
  for (GLenum side = 0; side < 4; ++side) glDisable(GL_CLIP_DISTANCE0 + side);
  glDisable(GL_SAMPLE_ALPHA_TO_COVERAGE), glDisable(GL_SAMPLE_ALPHA_TO_ONE);
}

void NailboardDrawer::draw(NailboardAtlas& atlas, const Camera& frame, DepthMode mode,
                           std::span<const NailboardInstance> instances) {
  if (instances.empty()) return;
  place(frame, instances);
  find_cells(atlas, frame, mode, instances);
  upload();
  const std::size_t shares = visible_.drawn_before_shares();
  draw_cells(atlas, mode, shader::NailboardOutput::color, 0, shares);
  draw_cells(atlas, mode, shader::NailboardOutput::share_of_color, shares,
             visible_.drawn().size() - shares);
}

void NailboardDrawer::draw_objects(NailboardAtlas& atlas, const Camera& frame, DepthMode mode,
                                   std::span<const NailboardInstance> instances) {
  if (instances.empty()) return;
  place(frame, instances);
  find_cells(atlas, frame, mode, instances);
  upload();
  draw_cells(atlas, mode, shader::NailboardOutput::objects, 0, visible_.drawn().size());
}

void NailboardDrawer::draw_outlines(const Camera& frame,
                                    std::span<const NailboardInstance> instances) {
  if (instances.empty()) return;
  place(frame, instances);
  upload();
  glUseProgram(outline_);
  glUniformMatrix4fv(0, 1, GL_FALSE, &clip_from_relative_[0][0]);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_FALSE);
  glDisable(GL_BLEND);
  glDrawArraysInstanced(GL_LINE_LOOP, 0, 4, GLsizei(instances.size()));
  glDepthMask(GL_TRUE);
}

}  // namespace rilievo
