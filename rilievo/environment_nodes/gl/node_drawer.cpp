#include "rilievo/environment_nodes/gl/node_drawer.h"

#include <algorithm>
#include <cstddef>

#include "rilievo/core/color.h"
#include "rilievo/environment_nodes/cube_grid.h"

namespace rilievo {
namespace {

// A gap's width up to which it counts as a crack, pixels.
constexpr float kCrack = 2.0f;
constexpr float kAnyWidth = 1e30f;
// One step of a float before the far plane, which is the empty frame's: a sky that is drawn later
// must not cover the node's.
constexpr double kFarthest = 1 - 0x1p-23;

Result<> keep(Result<gl::Program> made, gl::Program& program) {
  if (!made) return made.error();
  program = std::move(*made);
  return Done{};
}

}  // namespace

StoredNode StoredNode::create(const EnvironmentMap& map, const NodeMesh& mesh) {
  StoredNode node;
  node.shape_.world_from_node = mesh.world_from_node;
  node.shape_.face_size = mesh.face_size;
  node.shape_.surfaces = mesh.surfaces;
  node.shape_.skins = mesh.skins;
  node.reaches_ = side_reaches(mesh);
  node.triangles_ = mesh.triangles();

  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_CUBE_MAP, 1, &name);
  node.faces_ = gl::Texture(name);
  const int size = mesh.face_size;
  glTextureStorage2D(name, 1, GL_RGBA8, size, size);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTextureParameteri(name, filter, GL_LINEAR);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  for (int f = 0; f < 6; ++f) {
    // OpenGL's rows start at the bottom.
    Rgba8Image face = srgb8_from_linear(map.faces[std::size_t(f)].color);
    for (std::size_t i = 0; i < face.texels().size(); ++i)
      face.texels()[i].a = mesh.weights[std::size_t(f)].texels()[i];
    for (int y = 0; y < size / 2; ++y)
      std::swap_ranges(face.row(y).begin(), face.row(y).end(), face.row(size - 1 - y).begin());
    glTextureSubImage3D(name, 0, 0, 0, f, size, size, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                        face.texels().data());
  }
  GLuint disparities = 0;
  glCreateTextures(GL_TEXTURE_CUBE_MAP, 1, &disparities);
  node.disparities_ = gl::Texture(disparities);
  glTextureStorage2D(disparities, 1, GL_R32F, size, size);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTextureParameteri(disparities, filter, GL_NEAREST);
  for (int f = 0; f < 6; ++f) {
    Image<float> face = face_disparity(map.faces[std::size_t(f)]);
    for (int y = 0; y < size / 2; ++y)
      std::swap_ranges(face.row(y).begin(), face.row(y).end(), face.row(size - 1 - y).begin());
    glTextureSubImage3D(disparities, 0, 0, 0, f, size, size, 1, GL_RED, GL_FLOAT,
                        face.texels().data());
  }
  if (!map.faces[0].object.empty()) {
    GLuint objects = 0;
    glCreateTextures(GL_TEXTURE_CUBE_MAP, 1, &objects);
    node.objects_ = gl::Texture(objects);
    glTextureStorage2D(objects, 1, GL_R32UI, size, size);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      glTextureParameteri(objects, filter, GL_NEAREST);
    for (int f = 0; f < 6; ++f) {
      Image<std::uint32_t> face = map.faces[std::size_t(f)].object;
      if (face.empty()) face = Image<std::uint32_t>(size, size, kNoObject);
      for (int y = 0; y < size / 2; ++y)
        std::swap_ranges(face.row(y).begin(), face.row(y).end(), face.row(size - 1 - y).begin());
      glTextureSubImage3D(objects, 0, 0, 0, f, size, size, 1, GL_RED_INTEGER, GL_UNSIGNED_INT,
                          face.texels().data());
    }
  }
  const std::size_t vertex_bytes = mesh.vertices.size() * sizeof(NodeVertex);
  const std::size_t index_bytes = mesh.indices.size() * sizeof(std::uint32_t);
  node.vertices_ = gl::make_buffer(vertex_bytes, mesh.vertices.data());
  node.indices_ = gl::make_buffer(index_bytes, mesh.indices.data());
  node.bytes_ = rilievo::bytes(mesh) +
                std::size_t(6) * std::size_t(size) * std::size_t(size) * (node.objects_ ? 12 : 8);

  static_assert(sizeof(NodeVertex) == 8 * sizeof(float), "two vectors of the edges' shader");
  const std::array<std::vector<MeshEdge>, 6> edges = find_mesh_edges(mesh);
  std::vector<std::array<std::uint32_t, 4>> corners;
  for (std::size_t f = 0; f < 6; ++f) {
    node.first_edge_[f] = corners.size();
    for (const MeshEdge& edge : edges[f]) {
      corners.push_back({edge.from, edge.to, edge.inner, edge.outer});
      node.edge_reaches_[f].push_back(edge.reach);
    }
  }
  const std::size_t edge_bytes = corners.size() * sizeof corners[0];
  if (edge_bytes > 0) node.edges_ = gl::make_buffer(edge_bytes, corners.data());
  node.bytes_ += edge_bytes + corners.size() * sizeof(float);

  node.vertex_array_ = gl::make_vertex_array();
  const GLuint array = node.vertex_array_;
  glVertexArrayVertexBuffer(array, 0, node.vertices_, 0, sizeof(NodeVertex));
  glVertexArrayElementBuffer(array, node.indices_);
  const GLuint offsets[] = {offsetof(NodeVertex, direction), offsetof(NodeVertex, texture)};
  for (GLuint i = 0; i < 2; ++i) {
    glEnableVertexArrayAttrib(array, i);
    glVertexArrayAttribFormat(array, i, 4, GL_FLOAT, GL_FALSE, offsets[i]);
    glVertexArrayAttribBinding(array, i, 0);
  }
  return node;
}

Result<NodeDrawer::Output> NodeDrawer::make_output(bool objects) {
  using shader::NodeOutput;
  Output output;
  output.objects = objects;
  const NodeOutput alone = objects ? NodeOutput::object : NodeOutput::color,
                   layer = objects ? NodeOutput::object_layer : NodeOutput::layer;
  for (Result<> made : {keep(shader::make_node_program(alone), output.alone),
                        keep(shader::make_node_skin_program(alone), output.alone_skin),
                        keep(shader::make_node_program(layer), output.layer),
                        keep(shader::make_node_skin_program(layer), output.layer_skin)})
    if (!made) return made.error();
  return output;
}

Result<NodeDrawer> NodeDrawer::create() {
  NodeDrawer drawer;
  using shader::NodeOutput;
  for (const bool objects : {false, true}) {
    Result<Output> made = make_output(objects);
    if (!made) return made.error();
    (objects ? drawer.objects_ : drawer.color_) = std::move(*made);
  }
  for (Result<> made :
       {keep(shader::make_node_program(NodeOutput::direction), drawer.direction_),
        keep(shader::make_node_skin_program(NodeOutput::direction), drawer.direction_skin_),
        keep(shader::make_cube_map_program(), drawer.cube_map_),
        keep(shader::make_node_line_program(), drawer.line_),
        keep(shader::make_node_merged_program(), drawer.merged_),
        keep(shader::make_node_edge_program(), drawer.edge_)})
    if (!made) return made.error();
  for (int merge = 1; merge <= 4; ++merge)
    if (Result<> made = use_merge(drawer.color_, merge, 2); !made) return made.error();
  // By default frames have a third one where two lack something.
  if (Result<> made = use_merge(drawer.color_, int(NodeMerge::positional), 3); !made)
    return made.error();
  drawer.no_vertices_ = gl::make_vertex_array();
  return drawer;
}

void NodeDrawer::draw_node(const Camera& frame, const StoredNode& node, const gl::Program* surfaces,
                           const gl::Program* skins, float widest_skin, Sides sides) {
  const std::array<bool, 6> visible = visible_faces(node.shape_, node.reaches_, frame);
  const glm::mat4 to_clip(clip_from_node(node.shape_, frame));
  glEnable(GL_DEPTH_TEST);
  // The sky is as far as what the frame was cleared to.
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_TRUE);
  glEnable(GL_DEPTH_CLAMP);
  glDepthRange(0, kFarthest);
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glFrontFace(GL_CCW);
  glCullFace(GL_BACK);
  glBindVertexArray(node.vertex_array_);
  glBindTextureUnit(0, node.faces_);
  glBindTextureUnit(1, node.disparities_);
  glBindTextureUnit(2, node.objects_);
  const auto draw_ranges = [&](const gl::Program& program,
                               const std::array<TriangleRange, 6>& ranges) {
    glUseProgram(program);
    glUniformMatrix4fv(0, 1, GL_FALSE, &to_clip[0][0]);
    // Not every program has these.
    glUniform1f(glGetUniformLocation(program, "widest_skin"), widest_skin);
    for (std::size_t f = 0; f < 6; ++f) {
      // Neighbouring sides in one call.
      if (!visible[f]) continue;
      const std::uint32_t first = ranges[f].first;
      std::uint32_t count = ranges[f].count;
      while (f + 1 < 6 && visible[f + 1]) count += ranges[++f].count;
      if (count == 0) continue;
      glDrawElements(
          GL_TRIANGLES, GLsizei(3 * count), GL_UNSIGNED_INT,
          reinterpret_cast<const void*>(std::uintptr_t(first) * 3 * sizeof(std::uint32_t)));
    }
  };
  if (sides == Sides::front) glEnable(GL_CULL_FACE);
  if (surfaces) draw_ranges(*surfaces, node.shape_.surfaces);
  glDisable(GL_CULL_FACE);
  if (skins) draw_ranges(*skins, node.shape_.skins);
  glDisable(GL_DEPTH_CLAMP);
  glDepthRange(0, 1);
}

Result<> NodeDrawer::make_layers(int width, int height, int count, bool objects, bool antialiased) {
  const bool enough = width == width_ && height == height_ && count <= count_;
  if (enough && (!objects || layer_objects_) && (!antialiased || merged_framebuffer_))
    return Done{};
  count = enough ? count_ : count;
  layer_framebuffers_.clear();
  if (!enough) {
    layer_colors_ = gl::make_texture_2d_array(GL_RGBA8, width, height, count);
    layer_depths_ = gl::make_texture_2d_array(GL_DEPTH_COMPONENT32F, width, height, count);
    merged_framebuffer_ = {};
  }
  if (antialiased && !merged_framebuffer_) {
    merged_color_ = gl::make_texture_2d(GL_RGBA8, width, height);
    merged_depth_ = gl::make_texture_2d(GL_DEPTH_COMPONENT32F, width, height);
    merged_framebuffer_ = gl::make_framebuffer();
    glNamedFramebufferTexture(merged_framebuffer_, GL_COLOR_ATTACHMENT0, merged_color_, 0);
    glNamedFramebufferTexture(merged_framebuffer_, GL_DEPTH_ATTACHMENT, merged_depth_, 0);
  }
  layer_objects_ =
      objects ? gl::make_texture_2d_array(GL_R32UI, width, height, count) : gl::Texture();
  // Identifiers are not filtered: with a linear filter the texture would be incomplete.
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    if (objects) glTextureParameteri(layer_objects_, filter, GL_NEAREST);
  for (int i = 0; i < count; ++i) {
    layer_framebuffers_.push_back(gl::make_framebuffer());
    const GLuint name = layer_framebuffers_.back();
    glNamedFramebufferTextureLayer(name, GL_COLOR_ATTACHMENT0, layer_colors_, 0, i);
    glNamedFramebufferTextureLayer(name, GL_DEPTH_ATTACHMENT, layer_depths_, 0, i);
    if (objects) glNamedFramebufferTextureLayer(name, GL_COLOR_ATTACHMENT1, layer_objects_, 0, i);
    if (glCheckNamedFramebufferStatus(name, GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
      count_ = 0;
      return Error{"nodes", "the driver refuses a framebuffer of " + std::to_string(width) + " x " +
                                std::to_string(height)};
    }
  }
  width_ = width, height_ = height, count_ = count;
  return Done{};
}

Result<> NodeDrawer::use_merge(Output& output, int merge, std::size_t nodes) {
  gl::Program& program = output.merge[std::size_t(merge) - 1][nodes];
  if (!program)
    if (Result<> made =
            keep(shader::make_node_merge_program(merge, int(nodes), output.objects), program);
        !made)
      return made;
  glUseProgram(program);
  return Done{};
}

// The program is the current one.
void NodeDrawer::draw_edges(const Camera& frame, const StoredNode& node, Sides sides) const {
  if (!node.edges_) return;
  const std::array<bool, 6> visible = visible_faces(node.shape_, node.reaches_, frame);
  const glm::mat4 to_clip(clip_from_node(node.shape_, frame));
  const double distance = glm::distance(frame.position(), node.eye());
  glUniformMatrix4fv(20, 1, GL_FALSE, &to_clip[0][0]);
  glUniform1i(21, sides == Sides::front);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, node.vertices_);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, node.edges_);
  for (std::size_t f = 0; f < 6; ++f) {
    const std::vector<float>& reaches = node.edge_reaches_[f];
    const auto end = std::upper_bound(reaches.begin(), reaches.end(), float(distance));
    if (visible[f] && end != reaches.begin())
      glDrawArrays(GL_LINES, GLint(2 * node.first_edge_[f]), GLsizei(2 * (end - reaches.begin())));
  }
}

void NodeDrawer::begin_framebuffer(GLuint name, bool objects) {
  const GLfloat nothing[] = {0, 0, 0, 0}, far = 1;
  const GLuint no_object[] = {0, 0, 0, 0};
  const GLenum buffers[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, name);
  glNamedFramebufferDrawBuffers(name, objects ? 2 : 1, buffers);
  glClearNamedFramebufferfv(name, GL_COLOR, 0, nothing);
  if (objects) glClearNamedFramebufferuiv(name, GL_COLOR, 1, no_object);
  glClearNamedFramebufferfv(name, GL_DEPTH, 0, &far);
}

Result<> NodeDrawer::draw_objects(const Camera& frame, std::span<const StoredNode* const> nodes,
                                  std::uint32_t object, const NodeDrawOptions& options) {
  return draw_output(objects_, frame, nodes, object, options);
}

Result<> NodeDrawer::draw(const Camera& frame, std::span<const StoredNode* const> nodes,
                          const NodeDrawOptions& options) {
  return draw_output(color_, frame, nodes, kNoObject, options);
}

Result<> NodeDrawer::draw_output(Output& output, const Camera& frame,
                                 std::span<const StoredNode* const> nodes, std::uint32_t object,
                                 const NodeDrawOptions& options) {
  RILIEVO_EXPECTS(!nodes.empty() && nodes.size() <= kMaxNodes);
  const glm::dvec3 eye = frame.position();
  // Closer than a frame of a walk's motion by far.
  const bool from_own =
      glm::distance(eye, nodes[0]->eye()) < 1e-6 * std::max(1.0, glm::length(eye));
  if (from_own) nodes = nodes.first(1);
  glProgramUniform1f(output.alone, 4, from_own ? -1.0f : options.tolerance);
  // Without identifiers of its own a node shows one object.
  const auto set_object = [&](const StoredNode& node, const gl::Program& surfaces,
                              const gl::Program& skins) {
    if (!output.objects) return;
    const std::uint32_t shown = object != kNoObject || node.objects_ ? object : 1;
    for (const gl::Program* program : {&surfaces, &skins}) glProgramUniform1ui(*program, 3, shown);
  };
  const float widest = options.skin ? kAnyWidth : kCrack;
  if (nodes.size() == 1 || options.merge == NodeMerge::layering) {
    for (const StoredNode* node : nodes) {
      set_object(*node, output.alone, output.alone_skin);
      draw_node(frame, *node, &output.alone, &output.alone_skin, node == nodes[0] ? widest : kCrack,
                sides_of(node == nodes[0]));
    }
    return Done{};
  }

  glProgramUniform1f(output.layer, 4, options.tolerance);
  // One for each node's surfaces, and one for all skins.
  GLint samples = 0;
  glGetIntegerv(GL_SAMPLES, &samples);
  const bool antialiased = !output.objects && samples > 1 && samples <= shader::kMaxEdgeSamples;
  if (Result<> made = make_layers(frame.width, frame.height, int(nodes.size()) + 1, output.objects,
                                  antialiased);
      !made)
    return made;
  GLint framebuffer = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer);
  double sum = 0;
  for (const StoredNode* node : nodes) sum += 1 / std::max(1e-9, glm::distance(eye, node->eye()));
  float nearness[kMaxNodes] = {};
  glm::mat4 node_from_eye[kMaxNodes];
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    // Squared: the nearer node's texels are smaller in both directions.
    const double share = 1 / std::max(1e-9, glm::distance(eye, nodes[i]->eye())) / sum;
    nearness[i] = float(std::max(1e-9, share * share));
    begin_framebuffer(layer_framebuffers_[i], output.objects);
    set_object(*nodes[i], output.layer, output.layer_skin);
    draw_node(frame, *nodes[i], &output.layer, nullptr, 0, sides_of(i == 0));
    node_from_eye[i] =
        glm::mat4(glm::inverse(nodes[i]->shape_.world_from_node) * frame.world_from_eye);
  }
  begin_framebuffer(layer_framebuffers_[nodes.size()], output.objects);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    set_object(*nodes[i], output.layer, output.layer_skin);
    draw_node(frame, *nodes[i], nullptr, &output.layer_skin, i == 0 ? widest : kCrack, Sides::both);
  }
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, GLuint(framebuffer));
  if (Result<> made = use_merge(output, int(options.merge), nodes.size()); !made) return made;
  if (antialiased) begin_framebuffer(merged_framebuffer_, false);
  glBindVertexArray(no_vertices_);
  glBindTextureUnit(0, layer_colors_);
  glBindTextureUnit(1, layer_depths_);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    glBindTextureUnit(GLuint(2 + i), nodes[i]->disparities_);
  if (output.objects) glBindTextureUnit(10, layer_objects_);
  glUniform2f(2, float(frame.z_near), float(frame.z_far));
  // Not all of the merges have all of these.
  if (options.merge == NodeMerge::positional) glUniform1fv(3, GLsizei(nodes.size()), nearness);
  if (options.merge != NodeMerge::first) {
    glUniform1f(1, options.tolerance);
    glUniformMatrix4fv(11, GLsizei(nodes.size()), GL_FALSE, &node_from_eye[0][0][0]);
    const auto& window = frame.window;
    glUniform4f(19, float(window.left), float(window.bottom),
                float((window.right - window.left) / frame.width),
                float((window.top - window.bottom) / frame.height));
  }
  glDrawArrays(GL_TRIANGLES, 0, 3);
  if (!antialiased) return Done{};
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, GLuint(framebuffer));
  draw_merged(frame, nodes, samples);
  return Done{};
}

void NodeDrawer::draw_merged(const Camera& frame, std::span<const StoredNode* const> nodes,
                             int samples) const {
  glBindTextureUnit(0, merged_color_);
  glBindTextureUnit(1, merged_depth_);
  glUseProgram(merged_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glUseProgram(edge_);
  glUniform2f(2, float(frame.z_near), float(frame.z_far));
  glm::vec2 from_centre[shader::kMaxEdgeSamples];
  for (int i = 0; i < samples; ++i) {
    glGetMultisamplefv(GL_SAMPLE_POSITION, GLuint(i), &from_centre[i].x);
    from_centre[i] -= 0.5f;
  }
  glUniform1i(22, samples);
  glUniform2fv(23, samples, &from_centre[0].x);
  // Half of its width lies on each side of a line: nearly all samples beyond it that are of pixels
  // whose centres are not.
  glLineWidth(1);
  glEnable(GL_DEPTH_CLAMP);
  glDepthRange(0, kFarthest);
  glDepthMask(GL_FALSE);
  for (std::size_t i = 0; i < nodes.size(); ++i) draw_edges(frame, *nodes[i], sides_of(i == 0));
  glDepthMask(GL_TRUE);
  glDepthRange(0, 1);
  glDisable(GL_DEPTH_CLAMP);
}

void NodeDrawer::draw_lines(const Camera& frame, std::span<const glm::dvec3> ends) {
  if (ends.empty()) return;
  const glm::dvec3 eye = frame.position();
  const glm::mat4 to_clip(clip_from_relative(frame));
  line_ends_.clear();
  for (const glm::dvec3& end : ends) line_ends_.emplace_back(glm::vec3(end - eye), 1.0f);
  line_buffer_.upload_and_bind(GL_SHADER_STORAGE_BUFFER, 0, std::as_bytes(std::span(line_ends_)));
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_FALSE);
  glDisable(GL_BLEND);
  glUseProgram(line_);
  glUniformMatrix4fv(0, 1, GL_FALSE, &to_clip[0][0]);
  glBindVertexArray(no_vertices_);
  glDrawArrays(GL_LINES, 0, GLsizei(ends.size()));
  glDepthMask(GL_TRUE);
}

void NodeDrawer::draw_directions(const Camera& frame, const StoredNode& node, bool skin) {
  draw_node(frame, node, &direction_, &direction_skin_, skin ? kAnyWidth : kCrack, Sides::both);
}

void NodeDrawer::draw_cube_map(const Camera& frame, const StoredNode& node) {
  const glm::dmat3 node_from_world = glm::transpose(glm::dmat3(node.shape_.world_from_node));
  // Of the frame's corners at (-1, -1) and twice as far to the right and to the top.
  const auto ray = [&](double x, double y) {
    const glm::dvec3 to = world_from_raster(frame, {x * frame.width, (1 - y) * frame.height}, 1.0);
    return glm::vec3(node_from_world * (to - frame.position()));
  };
  const glm::vec3 rays[] = {ray(0, 0), ray(2, 0), ray(0, 2)};
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  glUseProgram(cube_map_);
  glBindVertexArray(no_vertices_);
  glBindTextureUnit(0, node.faces_);
  glUniform3fv(0, 3, &rays[0].x);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace rilievo
