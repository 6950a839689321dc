// Which triangle of which node does each sample of a frame show? Internal to
// environment_nodes/software. Samples lie in visibility buffers (SampleBuffer), of surfaces, of
// skins, and of skins that are drawn in part.
//
// A skin is drawn only where it is narrow enough. Skins that are so everywhere are rasterised by
// SIMD, as surfaces are; of those that are so in part each pixel is asked before it is drawn.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/environment_nodes/node_store.h"
#include "rilievo/environment_nodes/software/corner_edges.h"
#include "rilievo/environment_nodes/software/edge_pixels.h"
#include "rilievo/environment_nodes/software/frame_blocks.h"
#include "rilievo/environment_nodes/software/software_node.h"
#include "rilievo/render/raster/sample_raster.h"

namespace rilievo {

// A node to draw.
struct DrawnNode {
  const SoftwareNode* node = nullptr;
  float widest_skin = 0;    // pixels: wider ones are left open
  bool front_only = false;  // of surfaces only what the eye sees from the front
};

// A triangle in the frame, or what the near plane leaves of it. At pixel (px, py), y downwards, it
// has the colour at (u / w, v / w) of its face, in texels from the middle of the corner texel of
// the face's border:
//
//   (u, v, w) = at + (px - x) per_x + (py - y) per_y
struct alignas(64) NodeTriangle {
  glm::vec3 at{0.0f}, per_x{0.0f}, per_y{0.0f};
  float x = 0, y = 0;
  std::uint32_t face = 0;
  std::uint32_t node = 0;  // of the drawn ones
};

// Nodes in one z-buffer.
class NodeLayer {
 public:
  // Requires a perspective camera.
  void place(const Camera& frame, int samples, std::span<const DrawnNode> nodes);
  // A layer that is merged with others has one sample a pixel, and its skins are asked for only
  // where no layer shows a surface. So surfaces are placed first, of all layers, then skins, where
  // they touch the blocks `gaps`. With `only`, which must outlive what is drawn, nothing elsewhere.
  void place_surfaces(const Camera& frame, std::span<const DrawnNode> nodes,
                      const FrameBlocks* only = nullptr);
  void place_skins(const FrameBlocks& gaps);
  // Is the block of a pixel, y downwards, among those that it is drawn in?
  [[nodiscard]] bool reaches(int x, int y) const { return !only_ || only_->holds(x, y); }
  // The depths of surfaces in a row of pixels, y downwards: 1 for nothing; null if no pixel of the
  // frame shows any. Of a layer of one sample a pixel.
  [[nodiscard]] const float* surface_depths(int y) const {
    return surfaces_.triangle.empty() ? nullptr : surfaces_.raster.seen().depths(height_ - 1 - y);
  }

  // Marks the pixels that silhouettes of surfaces cross, unless what lies before them hides them.
  // Several layers may mark at a time.
  void mark_silhouettes(EdgePixels& pixels) const;
  // What kEdgeSamples samples of each marked pixel show: first of surfaces, of all pixels, then of
  // skins, of `gaps` among them. After either, for all rows, fill_edge_samples(). Requires one
  // sample a pixel.
  void begin_edge_surfaces(const EdgePixels& pixels);
  void begin_edge_skins(const EdgePixels& gaps);
  // The rows [low, high) of the pixels `wanted`, whole blocks of them; `pixels` has their numbers.
  void fill_edge_samples(const EdgePixels& pixels, const EdgePixels& wanted, int low, int high);
  static constexpr int kEdgeSamples = 4;
  // The samples of a marked pixel, by its number: depths, 1 for nothing, and triangles.
  [[nodiscard]] const float* edge_depths(std::uint32_t pixel) const {
    return &edge_depth_[kEdgeSamples * std::size_t(pixel)];
  }
  [[nodiscard]] const std::uint32_t* edge_triangles(std::uint32_t pixel) const {
    return &edge_triangle_[kEdgeSamples * std::size_t(pixel)];
  }

  [[nodiscard]] int samples() const { return samples_; }
  [[nodiscard]] std::size_t nodes() const { return nodes_.size(); }
  [[nodiscard]] const DrawnNode& drawn(std::size_t node) const { return nodes_[node].drawn; }
  // Of all parts; from first_skin() on they are skins.
  [[nodiscard]] std::span<const NodeTriangle> triangles() const { return triangles_; }
  [[nodiscard]] std::uint32_t first_skin() const {
    return std::uint32_t(surfaces_.triangle.size());
  }

  // The triangles of a part: number 0 of the buffer is number `first` of triangles().
  struct Seen {
    const SampleBuffer* samples = nullptr;  // null: shows nothing
    std::uint32_t first = 0;
  };
  // Of those that show something, the nearest is seen; of equally near ones the last.
  [[nodiscard]] std::array<Seen, 3> seen() const;
  // 1 / eye_z of a sample is (kSkyDepth - depth) / nearest().
  static constexpr float kSkyDepth = 1 - 0x1p-20f;
  [[nodiscard]] double nearest() const { return nearest_; }

  // How wide a skin is: its stretch at p = (x, y, 1), y upwards, is stretch.p / weight.p.
  struct SkinWidth {
    glm::dvec3 stretch{0.0}, weight{0.0};
    double widest = 0;  // pixels
    // At the pixel with this lower left corner, whole numbers.
    [[nodiscard]] bool is_narrow(double x, double y) const;
  };
  // A corner of a triangle, in the frame.
  struct ClipCorner {
    glm::dvec3 raster;  // (x w, y w, w), y upwards
    double disparity;
  };

 private:
  struct Placed {
    DrawnNode drawn;
    glm::dvec4 row_x, row_y,
        row_w;  // (x w, y w, w) in pixels, y upwards, of (direction, disparity)
    std::array<bool, 6> visible{};
    double eye_distance = 0;       // of the frame from the node
    std::size_t first_corner = 0;  // in corners_
  };
  // Triangles that are ready to be rasterised: corners in pixels with their depth.
  struct Soup {
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> indices;
    std::vector<std::uint32_t> node, triangle;  // of each
    std::vector<std::uint8_t> face;
    std::vector<RasterInstance> instances;
    SampleRaster raster;
  };
  // The planes through a triangle's corners as rows give them: a pixel's weights.
  struct Weights {
    glm::dvec3 of[3];
  };
  [[nodiscard]] Weights weights(const Placed& placed, std::uint32_t triangle) const;
  [[nodiscard]] SkinWidth skin_width(const Placed& placed, std::uint32_t triangle) const;
  [[nodiscard]] int narrowness(const Placed& placed, std::uint32_t triangle,
                               std::span<const ClipCorner> corners) const;
  enum class Part : std::uint8_t { surfaces, skins, doubtful };
  void begin(const Camera& frame, int samples, std::span<const DrawnNode> nodes);
  // Of all nodes what touches the blocks, if not null.
  void add(Part part, Soup& soup, const FrameBlocks* only);
  void add(std::uint32_t node, Part part, Soup& soup, const FrameBlocks* only);
  static void rasterize(Soup& soup, int width, int height, int samples);
  void rasterize_doubtful(const FrameBlocks* gaps);
  void mark_edge(const Placed& placed, const MeshEdge& edge, EdgePixels& pixels) const;
  [[nodiscard]] bool shows_edge(int x, int y, float nearness) const;
  void find_near_edges(const EdgePixels& pixels, Part part);
  [[nodiscard]] const Soup& soup_of(Part part) const {
    return part == Part::surfaces ? surfaces_ : part == Part::skins ? skins_ : doubtful_;
  }
  // A skin that is narrow in part.
  struct DoubtfulSkin {
    CornerEdges edges;
    SkinWidth width;
  };
  [[nodiscard]] NodeTriangle triangle_of(const Soup& soup, std::size_t triangle) const;
  void find_triangles();

  int width_ = 0, height_ = 0, samples_ = 1;
  const FrameBlocks* only_ = nullptr;  // null: everywhere
  double nearest_ = 1;                 // eye_z of the plane at which triangles are cut
  std::vector<Placed> nodes_;
  std::vector<glm::dvec3> corners_;   // of the nodes' vertices
  Soup surfaces_, skins_, doubtful_;  // doubtful: skins that are narrow in part
  std::vector<DoubtfulSkin> doubtful_edges_;
  SampleBuffer doubtful_seen_;  // where they are
  std::vector<NodeTriangle> triangles_;
  // A triangle of a soup that reaches a marked pixel.
  struct NearEdge {
    Part part;
    std::uint32_t triangle;
    int low, high;  // its rows in the frame, from the top
  };
  std::vector<NearEdge> near_edges_;
  std::vector<float> edge_depth_;
  std::vector<std::uint32_t> edge_triangle_;
};

// Marks the silhouettes of layers of one frame, and finds what samples of the marked pixels show of
// surfaces; then, once skins are placed, of skins where no layer has a surface: in `gaps`. Both
// begin with nothing marked.
void find_edge_surfaces(std::span<NodeLayer> layers, int height, EdgePixels& edges,
                        EdgePixels& gaps);
void find_edge_skins(std::span<NodeLayer> layers, int height, const EdgePixels& edges,
                     const EdgePixels& gaps);

}  // namespace rilievo
