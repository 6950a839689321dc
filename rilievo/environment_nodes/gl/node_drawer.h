// How are environment nodes drawn, and merged where several show the same surface? (S3.3 to S3.8)
//
// Writes depth, so that polygons and other pictures mix with nodes. What lies beyond the frame's
// far plane, such as the sky, is drawn just before it, so that a sky drawn later fills only the
// gaps. Needs a current OpenGL context; draws into the bound framebuffer, whose colours are
// sRGB-encoded, and the viewport, which has the frame's size.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "rilievo/environment_nodes/gl/node_shaders.h"
#include "rilievo/environment_nodes/mesh_edges.h"
#include "rilievo/environment_nodes/node_mesh.h"
#include "rilievo/environment_nodes/node_store.h"
#include "rilievo/environment_nodes/visible_faces.h"
#include "rilievo/gl/object.h"

namespace rilievo {

// A node on the GPU.
class StoredNode {
 public:
  // Uploads a node. Requires a valid environment, and a mesh of it.
  [[nodiscard]] static StoredNode create(const EnvironmentMap& map, const NodeMesh& mesh);

  [[nodiscard]] glm::dvec3 eye() const { return glm::dvec3(shape_.world_from_node[3]); }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  [[nodiscard]] std::size_t triangles() const { return triangles_; }

 private:
  friend class NodeDrawer;
  StoredNode() = default;
  NodeMesh shape_;  // without vertices and indices
  std::array<SideReach, 6> reaches_;
  gl::Texture faces_;        // a cube map, sRGB-encoded; in alpha the texels' weights
  gl::Texture disparities_;  // likewise, 1 / eye_z of the face
  gl::Texture objects_;      // likewise, identifiers; 0 if the pictures have none
  gl::Buffer vertices_, indices_;
  gl::Buffer edges_;  // what may be silhouettes, face by face
  // Of each face the first edge, and the reaches of all, ascending.
  std::array<std::size_t, 6> first_edge_{};
  std::array<std::vector<float>, 6> edge_reaches_;
  gl::VertexArray vertex_array_;
  std::size_t bytes_ = 0, triangles_ = 0;
};

// The programs and buffers that draw nodes.
class NodeDrawer {
 public:
  static constexpr std::size_t kMaxNodes = 8;

  // Compiles the shaders.
  [[nodiscard]] static Result<NodeDrawer> create();

  // Draws one to kMaxNodes nodes, the nearest to the eye first. Of the others only what the eye
  // sees from the front. If the eye is at the first node's own place, only that node is drawn,
  // because it shows everything visible from there. Into a framebuffer of several samples a pixel
  // silhouettes of merged nodes are antialiased. Fails where buffers cannot be allocated.
  Result<> draw(const Camera& frame, std::span<const StoredNode* const> nodes,
                const NodeDrawOptions& options);

  // Draws object identifiers into a ProbeTarget: those of the pictures, or `object` unless it is
  // kNoObject. Of merged nodes those of the node that counts most in draw()'s colour.
  Result<> draw_objects(const Camera& frame, std::span<const StoredNode* const> nodes,
                        std::uint32_t object, const NodeDrawOptions& options);

  // Draws lines, two ends each, in the world, as outlines: over everything that is not nearer.
  void draw_lines(const Camera& frame, std::span<const glm::dvec3> ends);

  // For tests and measures: draws the direction in node space that each pixel shows, into a
  // framebuffer of floats.
  void draw_directions(const Camera& frame, const StoredNode& node, bool skin);

  // Draws the node's picture as a plain cube map: the reference for the mesh seen from its own eye.
  void draw_cube_map(const Camera& frame, const StoredNode& node);

 private:
  // The first node sees the eye, so that the eye sees the front of all that it shows. What the eye
  // would see from behind of another node's surfaces, that node saw through a wall that has one
  // side only, or from around a corner: it must not cover what the first node knows.
  enum class Sides { both, front };
  static Sides sides_of(bool first) { return first ? Sides::both : Sides::front; }
  // Draws surfaces or skins, where they are given.
  void draw_node(const Camera& frame, const StoredNode& node, const gl::Program* surfaces,
                 const gl::Program* skins, float widest_skin, Sides sides);
  // What draws colours, or identifiers.
  struct Output {
    bool objects = false;
    gl::Program alone, alone_skin, layer, layer_skin;
    // By merge - 1 and number of nodes; made when first needed, of colours those of two at once.
    std::array<std::array<gl::Program, kMaxNodes + 1>, 4> merge;
  };
  [[nodiscard]] static Result<Output> make_output(bool objects);
  // `object`: of identifiers.
  Result<> draw_output(Output& output, const Camera& frame,
                       std::span<const StoredNode* const> nodes, std::uint32_t object,
                       const NodeDrawOptions& options);
  static void begin_framebuffer(GLuint name, bool objects);
  // Makes the program the current one.
  static Result<> use_merge(Output& output, int merge, std::size_t nodes);
  // Draws what was merged, and the silhouettes of the nodes, into a frame of several samples.
  void draw_merged(const Camera& frame, std::span<const StoredNode* const> nodes,
                   int samples) const;
  void draw_edges(const Camera& frame, const StoredNode& node, Sides sides) const;
  Result<> make_layers(int width, int height, int count, bool objects, bool antialiased);

  Output color_, objects_;
  gl::Program direction_, direction_skin_, cube_map_, line_, merged_, edge_;
  gl::VertexArray no_vertices_;
  gl::StreamBuffer line_buffer_;
  std::vector<glm::vec4> line_ends_;
  int width_ = 0, height_ = 0, count_ = 0;
  gl::Texture layer_colors_, layer_depths_, layer_objects_;
  std::vector<gl::Framebuffer> layer_framebuffers_;
  // What was merged, of one sample a pixel, where the frame has several.
  gl::Texture merged_color_, merged_depth_;
  gl::Framebuffer merged_framebuffer_;
};

}  // namespace rilievo
