// The colours of triangles where pixels show them.
//
// Triangles are added pixel by pixel, as a visibility buffer has them, and shaded together, mesh by
// mesh: what belongs to one is placed and made alike. A triangle is shaded at the pixel's centre if
// all of several samples show it, else in the middle of those that do: the centre may lie outside
// the triangle, and on the plane of a slanted one far from it. Internal to render/raster and
// render/rays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rilievo/render/shading/surface_points.h"
#include "rilievo/render/shading/surface_shading.h"

namespace rilievo {

// A mesh in a picture.
struct PlacedMesh {
  const Mesh* mesh = nullptr;
  SurfacePlacement surface;
  // The range of its triangles in the SampleBuffer.
  std::uint32_t first_triangle = 0, triangles = 0;
  std::uint32_t object = 0;  // index into Scene::objects
};

// The index of the mesh that has a triangle of the SampleBuffer. Requires meshes in the order of
// their triangles.
[[nodiscard]] std::size_t mesh_of_triangle(std::span<const PlacedMesh> meshes,
                                           std::uint32_t triangle);

// The inputs of shading a picture's triangles.
struct ShadedScene {
  std::span<const PlacedMesh> meshes;  // in the order of their triangles
  PictureRays rays;
  SurfaceLights lights;
  int samples = 1;  // of a pixel: 1 or 4
  ColorScale scale = ColorScale::srgb;
  bool staggered = false;  // as SampleBuffer's
};

// Collects triangles, and shades them. Keeps its buffers; use one object for each thread.
class SeenTriangles {
 public:
  // A triangle in a pixel.
  struct Pixel {
    std::uint32_t triangle;  // primitive index, as in the SampleBuffer
    std::uint16_t x, y;      // from the lower left, as PictureRays has it
    std::uint16_t samples;   // that show it, a bit each
  };
  // Some of them, shaded: entry i of all three.
  struct Shaded {
    std::span<const Pixel> pixels;
    const Surfaces& surfaces;
    const SurfaceColors& colors;
  };

  // Adds one. Mostly it is of the same mesh as the last one.
  void add(std::span<const PlacedMesh> meshes, const Pixel& pixel) {
    if (pixel.triangle - first_triangle_ >= triangles_) find_mesh(meshes, pixel.triangle);
    std::uint32_t& first = first_of_[mesh_];
    seen_.push_back({pixel, first});
    first = std::uint32_t(seen_.size() - 1);
  }

  // Shades all that were added, and forgets them; calls write(Shaded) for a few at a time. Those of
  // one mesh come together, the last one first.
  template <class Write>
  void shade(const ShadedScene& scene, const Write& write) {
    for (const std::uint32_t mesh : met_) {
      const PlacedMesh& placed = scene.meshes[mesh];
      if (shaded_of_.size() <= mesh) shaded_of_.resize(scene.meshes.size());
      for (std::uint32_t next = first_of_[mesh]; next != kNone;) {
        const std::size_t before = surfaces_.count;
        next = gather(scene, placed, next);
        shaded_of_[mesh] += surfaces_.count - before;
        if (surfaces_.count + TriangleRays::kMaxCount > Surfaces::kMaxCount) flush(scene, write);
      }
      first_of_[mesh] = kNone;
    }
    flush(scene, write);
    met_.clear();
    seen_.clear();
    triangles_ = 0;  // of no mesh
  }

  // How many pixels of a mesh have been shaded since clear_counts()?
  [[nodiscard]] std::uint64_t shaded_of(std::size_t mesh) const {
    return mesh < shaded_of_.size() ? shaded_of_[mesh] : 0;
  }
  void clear_counts() { shaded_of_.assign(shaded_of_.size(), 0); }

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFu;

  struct Seen {
    Pixel pixel;
    std::uint32_t next;  // index of another one of its mesh, or kNone
  };

  template <class Write>
  void flush(const ShadedScene& scene, const Write& write) {
    if (surfaces_.count == 0) return;
    shade_surfaces(scene.lights, surfaces_, scene.scale, colors_);
    write(Shaded{std::span(waiting_, surfaces_.count), surfaces_, colors_});
    surfaces_.count = 0;
  }
  void find_mesh(std::span<const PlacedMesh> meshes, std::uint32_t triangle);
  // Appends surfaces of one mesh, at most TriangleRays::kMaxCount; returns the next of the list.
  std::uint32_t gather(const ShadedScene& scene, const PlacedMesh& placed, std::uint32_t first);

  std::vector<Seen> seen_;
  std::vector<std::uint32_t> first_of_;               // by mesh: index into seen_, or kNone
  std::vector<std::uint32_t> met_;                    // meshes that are seen
  std::vector<std::uint64_t> shaded_of_;              // by mesh: pixels
  std::uint32_t mesh_ = 0;                            // the last one met
  std::uint32_t first_triangle_ = 0, triangles_ = 0;  // its triangles
  TriangleRays rays_;
  Surfaces surfaces_;
  SurfaceColors colors_;
  Pixel waiting_[Surfaces::kMaxCount];  // of the surfaces
};

}  // namespace rilievo
