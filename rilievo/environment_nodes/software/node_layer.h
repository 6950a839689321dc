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
// has the colour that lies in the direction, in node space and of any length,
//
//   at + (px - x) per_x + (py - y) per_y
struct alignas(64) NodeTriangle {
  glm::vec3 at{0.0f}, per_x{0.0f}, per_y{0.0f};
  float x = 0, y = 0;
  std::uint32_t node = 0;  // of the drawn ones
};

// Nodes in one z-buffer.
class NodeLayer {
 public:
  // Requires a perspective camera.
  void place(const Camera& frame, int samples, std::span<const DrawnNode> nodes);

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
  };
  // Triangles that are ready to be rasterised: corners in pixels with their depth.
  struct Soup {
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> indices;
    std::vector<std::uint32_t> node, triangle;  // of each
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
  enum class Part { surfaces, skins, doubtful };
  void add(std::uint32_t node, const std::array<bool, 6>& visible, Part part, Soup& soup);
  static void rasterize(Soup& soup, int width, int height, int samples);
  void rasterize_doubtful();
  // A skin that is narrow in part.
  struct DoubtfulSkin {
    CornerEdges edges;
    SkinWidth width;
  };
  [[nodiscard]] NodeTriangle triangle_of(const Soup& soup, std::size_t triangle) const;
  void find_triangles();

  int width_ = 0, height_ = 0, samples_ = 1;
  double nearest_ = 1;  // eye_z of the plane at which triangles are cut
  std::vector<Placed> nodes_;
  std::vector<glm::dvec3> corners_;   // of a node's vertices
  Soup surfaces_, skins_, doubtful_;  // doubtful: skins that are narrow in part
  std::vector<DoubtfulSkin> doubtful_edges_;
  SampleBuffer doubtful_seen_;  // where they are
  std::vector<NodeTriangle> triangles_;
};

}  // namespace rilievo
