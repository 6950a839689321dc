#include "bench/coverage_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "bench/analyze_coverage.h"
#include "bench/report.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/layered_impostor/warp.h"
#include "rilievo/render/rays/cast_picture.h"

namespace rilievo::bench {
namespace {

constexpr glm::vec4 kPaper{0.86f, 0.88f, 0.9f, 1.0f};  // behind pictures, linear

// An eye in `direction` that sees the whole ball around the box.
Camera camera_around(const Box& box, const glm::dvec3& direction, int size) {
  constexpr double kRadii = 5;
  const glm::dvec3 center(box.center());
  const double radius = box.radius(), distance = kRadii * radius;
  return look_at(center + distance * glm::normalize(direction), center, {0, 1, 0},
                 2.0 * std::asin(1.0 / kRadii), size, size, distance - 1.5 * radius,
                 distance + 1.5 * radius);
}

Rgba8Image on_paper(ColorImage color) {
  for (glm::vec4& c : color.texels()) c += (1.0f - c.a) * kPaper;
  return srgb8_from_linear(color);
}

// Pictures of one size side by side, `columns` a row.
Rgba8Image sheet_of(std::span<const Rgba8Image> pictures, int columns) {
  constexpr int kGap = 4;
  const int w = pictures[0].width(), h = pictures[0].height();
  const int rows = (int(pictures.size()) + columns - 1) / columns;
  Rgba8Image sheet(columns * (w + kGap) - kGap, rows * (h + kGap) - kGap, {255, 255, 255, 255});
  for (int i = 0; i < int(pictures.size()); ++i)
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x)
        sheet(i % columns * (w + kGap) + x, i / columns * (h + kGap) + y) = pictures[i](x, y);
  return sheet;
}

// A straight line with depth, two pixels wide.
void draw_line(DepthImage& frame, const glm::dvec3& from, const glm::dvec3& to) {
  const int steps = 4 * std::max(frame.camera.width, frame.camera.height);
  for (int i = 0; i <= steps; ++i) {
    const glm::dvec3 at =
        raster_from_world(frame.camera, glm::mix(from, to, double(i) / double(steps)));
    for (const glm::dvec2 offset : {glm::dvec2(0), {1, 0}, {0, 1}, {1, 1}}) {
      const int x = int(std::floor(at.x + offset.x)), y = int(std::floor(at.y + offset.y));
      if (x < 0 || y < 0 || x >= frame.camera.width || y >= frame.camera.height) continue;
      if (!(float(at.z) <= frame.depth(x, y))) continue;
      frame.depth(x, y) = float(at.z);
      frame.color(x, y) = {0.05f, 0.1f, 0.35f, 1.0f};
    }
  }
}

// Edges of the dodecahedron with vertices on the ball: neighbouring vertices are the nearest.
void draw_dodecahedron(DepthImage& frame, const glm::dvec3& center, double radius) {
  ViewSetOptions vertices;
  vertices.spread = ViewSpread::vertices_20;
  const std::vector<glm::dvec3> corners = make_view_set(vertices).directions;
  double edge = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < corners.size(); ++i)
    edge = std::min(edge, glm::distance(corners[0], corners[i]));
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (glm::distance(corners[i], corners[k]) < 1.01 * edge)
        draw_line(frame, center + radius * corners[i], center + radius * corners[k]);
}

}  // namespace

Rgba8Image color_by_coverage(const RayScene& rays, const Camera& taken, const Camera& camera) {
  constexpr int kFine = 3;  // rays a pixel in x and in y
  Camera fine = camera;
  fine.width *= kFine, fine.height *= kFine;
  const DepthImage seen = cast_picture(rays, fine);
  ColorImage color(camera.width, camera.height);
  parallel_for(0, camera.height, [&](int y) {
    for (int x = 0; x < camera.width; ++x)
      for (int i = 0; i < kFine * kFine; ++i) {
        const int fx = kFine * x + i % kFine, fy = kFine * y + i / kFine;
        glm::vec4 shown = kPaper;
        if (seen.covered(fx, fy)) {
          const CameraRay ray = camera_ray(fine, {fx + 0.5, fy + 0.5});
          const std::optional<RayHit> hit = rays.first_hit(ray.origin, ray.direction, 0, 1);
          const bool sampled =
              hit &&
              std::isfinite(sample_spacing(
                  rays, taken,
                  {glm::vec3(ray.origin + double(hit->distance) * ray.direction), hit->normal}));
          const glm::vec4 c = seen.color(fx, fy);
          // A shade of the surface as bright as it is.
          const float light = 0.15f + glm::dot(glm::vec3(c), glm::vec3(0.21f, 0.72f, 0.07f));
          shown = sampled ? c : glm::vec4(light * glm::vec3(2.2f, 0.12f, 0.1f), 1.0f);
        }
        color(x, y) += shown / float(kFine * kFine);
      }
  });
  return srgb8_from_linear(color);
}

Result<std::vector<BenchPicture>> figure_2(const BenchObject& object, int size) {
  const Result<RayScene> rays = RayScene::create(object.scene);
  if (!rays) return rays.error();
  const Box box = world_bounds(object.scene);
  // Taken from the front, a little above; looked at from the side, and warped for a higher eye.
  const glm::dvec3 viewers{0.25, 0.45, 1.0}, side{-1.0, 0.35, 0.15}, higher{0.15, 1.1, 0.9};
  std::vector<BenchPicture> pictures;
  for (const auto& [projection, name] :
       {std::pair(Projection::perspective, "ordinary"),
        std::pair(Projection::back_perspective, "back-perspective")}) {
    ViewCameraOptions options;
    options.projection = projection;
    options.size = size;
    const Result<Camera> taken = view_camera(box, viewers, options);
    if (!taken) return taken.error();
    DepthImage picture = cast_picture(*rays, *taken);
    const Rgba8Image itself = on_paper(picture.color);
    std::vector<DepthImage> one;
    one.push_back(std::move(picture));
    const Result<LayeredImpostor> impostor = make_layered_impostor(std::move(one), {});
    if (!impostor) return impostor.error();
    SurfaceWarpOptions alone;
    alone.max_views = 1;
    const DepthImage warped = warp_surfaces(*impostor, camera_around(box, higher, size), alone);
    const Rgba8Image row[] = {itself,
                              color_by_coverage(*rays, *taken, camera_around(box, side, size)),
                              on_paper(warped.color)};
    pictures.push_back(png_picture(
        fmt::format("Figure 2, {}, {}: the picture; what it holds, seen from the side, what it "
                    "lacks in red; that picture alone warped for a higher eye",
                    object.name, name),
        sheet_of(row, 3)));
  }
  return pictures;
}

Result<std::vector<BenchPicture>> figure_5(const BenchObject& object, int size) {
  const Result<RayScene> rays = RayScene::create(object.scene);
  if (!rays) return rays.error();
  const Box box = world_bounds(object.scene);
  std::vector<DepthImage> pictures;
  std::vector<Rgba8Image> shown;
  for (const glm::dvec3& direction : make_view_set({}).directions) {
    ViewCameraOptions options;
    options.size = size;
    const Result<Camera> camera = view_camera(box, direction, options);
    if (!camera) return camera.error();
    pictures.push_back(cast_picture(*rays, *camera));
    shown.push_back(on_paper(pictures.back().color));
  }
  const Result<LayeredImpostor> impostor = make_layered_impostor(std::move(pictures), {});
  if (!impostor) return impostor.error();
  constexpr double kAround = 0.85;  // of the ball around the box: lines pierce the object
  DepthImage frame = warp_surfaces(*impostor, camera_around(box, {0.5, 0.4, 1.0}, 4 * size));
  draw_dodecahedron(frame, glm::dvec3(box.center()), kAround * box.radius());
  return std::vector{
      png_picture(
          fmt::format("Figure 5: the 32 back-perspective pictures of the {}, {} texels square",
                      object.name, size),
          sheet_of(shown, 8)),
      png_picture("A frame warped from them, with the dodecahedron as lines in the same z-buffer",
                  on_paper(frame.color))};
}

}  // namespace rilievo::bench
