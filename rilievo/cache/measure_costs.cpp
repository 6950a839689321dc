// Frames, N being their number of balls, all of them over the same pixels P:
//
//   heavy - light  = N_light (T_heavy - T_light) triangle
//   small - light  = (N_small - N_light) object + (N_small T_small - N_light T_light) triangle
//   light - empty  = N_light object + N_light T_light triangle + P pixel
//
// and the same with pictures, which have no triangles. Captures of C objects, with t texels:
//
//   heavy  - small = C (T_heavy - T_small) triangle
//   larger - small = C (t_larger - t) texel
//   small          = C (capture + T_small triangle + t texel)
#include "rilievo/cache/measure_costs.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <numeric>

#include "rilievo/core/expects.h"
#include "rilievo/core/stopwatch.h"

namespace rilievo {
namespace {

constexpr int kRuns = 4, kFewRuns = 2;
constexpr double kTurnMs = 6;  // at least, so that what is short is measured often
constexpr int kWidth = 640, kHeight = 320;
constexpr double kFov = 0.2, kDistance = 100;  // radians, metres; all balls look alike
constexpr int kLarge = 80, kLittle = 20;       // pixels of a ball
constexpr int kCaptured = 24;
constexpr int kFewTexels = 16, kManyTexels = 160;  // a side

// Noise can make a difference small or negative. The least that is believed: of a picture, a
// capture or an object, which take a call or more; and of a pixel, a texel or a triangle.
constexpr double kLeastOfOne = 100, kLeastOfPart = 0.1;

// A ball of radius 1, 2 rings segments around: 4 rings (rings - 1) triangles.
Mesh ball_mesh(int rings) {
  Mesh mesh;
  mesh.material = 0;
  const int around = 2 * rings;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j <= around; ++j) {
      const float polar = glm::pi<float>() * float(i) / float(rings);
      const float turn = 2 * glm::pi<float>() * float(j) / float(around);
      const glm::vec3 p(std::sin(polar) * std::cos(turn), std::cos(polar),
                        -std::sin(polar) * std::sin(turn));
      mesh.positions.push_back(p);
      mesh.normals.push_back(p);
    }
  const auto at = [&](int i, int j) { return std::uint32_t(i * (around + 1) + j); };
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < around; ++j) {
      if (i > 0) mesh.indices.insert(mesh.indices.end(), {at(i, j), at(i + 1, j), at(i, j + 1)});
      if (i + 1 < rings)
        mesh.indices.insert(mesh.indices.end(), {at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)});
    }
  return mesh;
}

// Adds balls of `pixels` across, side by side over the whole frame.
MeasuredRun add_balls(int rings, int pixels, const Camera& frame, Scene& scene) {
  MeasuredRun run{std::uint32_t(scene.objects.size()), 0, 0};
  scene.meshes.push_back(ball_mesh(rings));
  run.triangles = scene.meshes.back().triangles();
  Model model;
  model.parts.push_back({int(scene.meshes.size()) - 1});
  scene.models.push_back(model);
  const double radius =
      0.5 * pixels * kDistance * (frame.window.right - frame.window.left) / frame.width;
  for (int y = 0; y < kHeight / pixels; ++y)
    for (int x = 0; x < kWidth / pixels; ++x) {
      const glm::dvec3 at =
          world_from_raster(frame, {(x + 0.5) * pixels, (y + 0.5) * pixels}, kDistance);
      Object object;
      object.model = int(scene.models.size()) - 1;
      object.placement = glm::translate(glm::mat4(1), glm::vec3(at)) *
                         glm::scale(glm::mat4(1), glm::vec3(float(radius)));
      scene.objects.push_back(object);
      ++run.count;
    }
  return run;
}

glm::dvec3 center_of(const Object& object) { return glm::dvec3(object.placement[3]); }
double radius_of(const Object& object) { return double(object.placement[0][0]); }

// A camera with the frame's axes and eye around a ball.
Camera around(const Object& object, const Camera& frame, int texels) {
  const glm::dvec3 at = center_of(object);
  const double radius = radius_of(object);
  Camera camera = frame;
  const double distance = -at.z - radius, half = 1.05 * radius / distance;
  const double x = at.x / -at.z, y = at.y / -at.z;
  camera.window = {x - half, x + half, y - half, y + half};
  camera.z_near = 0.99 * distance, camera.z_far = 1.01 * (distance + 2 * radius);
  camera.width = camera.height = texels;
  return camera;
}

// The ball, by rays.
DepthImage ball_picture(const Object& object, const Camera& frame, int texels) {
  DepthImage picture;
  picture.camera = around(object, frame, texels);
  picture.color = ColorImage(texels, texels, glm::vec4(0));
  picture.depth = Image<float>(texels, texels, kNoDepth);
  const glm::dvec3 to_center = center_of(object) - frame.position();
  const double radius = radius_of(object);
  for (int y = 0; y < texels; ++y)
    for (int x = 0; x < texels; ++x) {
      const glm::dvec3 ray =
          world_from_raster(picture.camera, {x + 0.5, y + 0.5}, 1.0) - frame.position();
      const double along = glm::dot(ray, to_center), square = glm::dot(ray, ray);
      const double inside =
          along * along - square * (glm::dot(to_center, to_center) - radius * radius);
      if (inside < 0) continue;
      picture.depth(x, y) = float((along - std::sqrt(inside)) / square);
      picture.color(x, y) = glm::vec4(float(x) / float(texels), float(y) / float(texels), 0.3f, 1);
    }
  return picture;
}

double triangles(const MeasuredRun& run) { return double(run.count) * double(run.triangles); }

// The least milliseconds of each of several pieces of work, which take turns.
template <std::size_t N, typename Work>
Result<std::array<double, N>> least_ms(const Work& work, int runs = kRuns) {
  std::array<double, N> least;
  least.fill(std::numeric_limits<double>::infinity());
  for (int run = 0; run <= runs; ++run)
    for (std::size_t i = 0; i < N; ++i) {
      const Stopwatch turn;
      do {
        const Stopwatch watch;
        if (Result<> done = work(i); !done) return done.error();
        if (run > 0) least[i] = std::min(least[i], watch.ms());  // the first touches memory
      } while (run > 0 && turn.ms() < kTurnMs);
    }
  return least;
}

}  // namespace

double rounded_ns(double ns) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(),
                                 std::clamp(ns, kLeastNs, kMostNs), std::chars_format::general, 3);
  double value = 0;
  std::from_chars(text.data(), end.ptr, value);
  return value;
}

MeasuredScene measured_scene() {
  MeasuredScene made;
  made.frame = look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, kFov, kWidth, kHeight, 1, 2 * kDistance);
  Scene& scene = made.scene;
  scene.materials.emplace_back();
  made.heavy = add_balls(28, kLarge, made.frame, scene);
  // As many triangles in all as the small ones have, and as large: what differs is the objects.
  made.light = add_balls(14, kLarge, made.frame, scene);
  made.small = add_balls(4, kLittle, made.frame, scene);
  finish(scene);
  for (std::uint32_t i = 0; i < made.light.count; ++i)
    made.pictures.push_back(ball_picture(scene.objects[made.light.first + i], made.frame, kLarge));
  for (std::uint32_t i = 0; i < made.small.count; ++i)
    made.pictures.push_back(ball_picture(scene.objects[made.small.first + i], made.frame, kLittle));
  return made;
}

Result<DrawTimes> measure_drawing(const MeasuredScene& scene, MeasuredFrames& frames) {
  const MeasuredRun large{0, scene.light.count}, little{scene.light.count, scene.small.count};
  struct Drawn {
    MeasuredRun objects, pictures;
  };
  const Drawn drawn[] = {{{}, {}},          {scene.heavy, {}}, {scene.light, {}},
                         {scene.small, {}}, {{}, large},       {{}, little}};
  const auto ms =
      least_ms<6>([&](std::size_t i) { return frames.draw(drawn[i].objects, drawn[i].pictures); });
  if (!ms) return ms.error();
  const auto ns = [&](int more, int less) {
    return 1e6 * ((*ms)[std::size_t(more)] - (*ms)[std::size_t(less)]);
  };
  const double many = scene.small.count, few = scene.light.count, pixels = double(kWidth) * kHeight;
  DrawTimes times;
  const double triangle =
      std::max(kLeastOfPart, ns(1, 2) / (triangles(scene.heavy) - triangles(scene.light)));
  const double object = std::max(
      kLeastOfOne,
      (ns(3, 2) - (triangles(scene.small) - triangles(scene.light)) * triangle) / (many - few));
  const double picture = std::max(kLeastOfOne, ns(5, 4) / (many - few));
  times.triangle_ns = rounded_ns(triangle);
  times.object_ns = rounded_ns(object);
  times.polygon_pixel_ns = rounded_ns(std::max(
      kLeastOfPart, (ns(2, 0) - few * object - triangles(scene.light) * triangle) / pixels));
  times.picture_ns = rounded_ns(picture);
  times.picture_pixel_ns = rounded_ns(std::max(kLeastOfPart, (ns(4, 0) - few * picture) / pixels));
  return times;
}

Result<PolygonTimes> measure_polygons(const MeasuredScene& scene, MeasuredFrames& frames) {
  const auto ms = least_ms<2>(
      [&](std::size_t i) { return frames.draw(i == 0 ? scene.light : scene.heavy, {}); }, kFewRuns);
  if (!ms) return ms.error();
  const double few = triangles(scene.light), many = triangles(scene.heavy);
  PolygonTimes times;
  times.triangle_ns = std::max(kLeastOfPart, 1e6 * ((*ms)[1] - (*ms)[0]) / (many - few));
  times.pixel_ns = std::max(
      kLeastOfPart, (1e6 * (*ms)[0] - few * times.triangle_ns) / (double(kWidth) * kHeight));
  return times;
}

CaptureTimes measure_captures(const MeasuredScene& scene, NailboardStore& pictures) {
  const auto capture = [&](const MeasuredRun& objects, int texels) {
    for (std::uint32_t i = 0; i < kCaptured; ++i) {
      const std::uint32_t object = objects.first + i;
      const Camera camera = around(scene.scene.objects[object], scene.frame, texels);
      [[maybe_unused]] const bool room = pictures.allocate(i, texels, texels);
      RILIEVO_EXPECTS(room);
      pictures.capture(i, camera, {&object, 1});
      static_cast<void>(pictures.gaps(camera, {&object, 1}));
    }
    for (std::uint32_t i = 0; i < kCaptured; ++i) static_cast<void>(pictures.delta_range(i));
    pictures.finish();
    for (std::uint32_t i = 0; i < kCaptured; ++i) pictures.free(i);
  };
  const auto ms = least_ms<3>([&](std::size_t i) -> Result<> {
    capture(i == 1 ? scene.heavy : scene.small, i == 2 ? kManyTexels : kFewTexels);
    return Done{};
  });
  const auto ns = [&](std::size_t i) { return 1e6 * (*ms)[i] / kCaptured; };
  const double few = kFewTexels * kFewTexels, many = kManyTexels * kManyTexels;
  const double triangle = std::max(
      kLeastOfPart, (ns(1) - ns(0)) / double(scene.heavy.triangles - scene.small.triangles));
  const double texel = std::max(kLeastOfPart, (ns(2) - ns(0)) / (many - few));
  CaptureTimes times;
  times.triangle_ns = rounded_ns(triangle);
  times.texel_ns = rounded_ns(texel);
  times.picture_ns = rounded_ns(
      std::max(kLeastOfOne, ns(0) - double(scene.small.triangles) * triangle - few * texel));
  return times;
}

void MeasuredChooser::add_sets(FrameContent& content) {
  content.sets.push_back({pictures_.drawable.get(), {}});
}

Result<> MeasuredChooser::choose(const Camera&, const PlacedScene&, FrameContent& content,
                                 FrameStats&) {
  content.sky = false;
  content.polygons.resize(objects_.count);
  std::iota(content.polygons.begin(), content.polygons.end(), objects_.first);
  const auto first = pictures_.instances.begin() + shown_.first;
  content.sets[0].instances.assign(first, first + shown_.count);
  return Done{};
}

}  // namespace rilievo
