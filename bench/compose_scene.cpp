#include "bench/compose_scene.h"

#include <algorithm>
#include <cmath>

#include "bench/random.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/core/random.h"

namespace rilievo::bench {
namespace {

constexpr double kFieldOfView = 0.9;  // radians, vertical

// The coverage of a texel by 16 samples: a ragged box, or leaves in a disc.
float coverage(int x, int y, int width, int height, bool foliage, std::uint64_t seed) {
  if (x <= 0 || y <= 0 || x >= width - 1 || y >= height - 1) return 0;
  const float feature = foliage ? 6 : 24;
  int covered = 0;
  for (int i = 0; i < 16; ++i) {
    const float u = float(x) + (float(i % 4) + 0.5f) / 4, v = float(y) + (float(i / 4) + 0.5f) / 4;
    const float n = 0.3f * noise({u / feature, v / feature, 0}, seed) +
                    0.2f * noise({2.3f * u / feature, 2.3f * v / feature, 7}, seed);
    const float a = 2 * u / float(width) - 1, b = 2 * v / float(height) - 1;
    covered += foliage ? std::hypot(a, b) + 1.2f * n < 0.75f
                       : std::max(std::abs(a), std::abs(b)) + 0.3f * n < 0.88f;
  }
  return float(covered) / 16;
}

void fill(Nailboard& board, bool foliage, std::uint64_t seed) {
  const Camera& capture = board.geometry.capture;
  const int width = capture.width, height = capture.height, bits = board.geometry.delta_bits;
  const double depth = capture.z_far - capture.z_near;
  board.color = Rgba8Image(width, height);
  board.delta = Image<std::uint16_t>(width, height, std::uint16_t(delta_transparent(bits)));
  Image<float> alpha(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) alpha(x, y) = coverage(x, y, width, height, foliage, seed);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      float beside = 0;
      for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v)
        for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u)
          beside = std::max(beside, alpha(u, v));
      if (beside == 0) continue;
      for (int k = 0; k < 3; ++k) {
        const float c = 0.5f + 0.3f * noise({float(x) / 5, float(y) / 5, float(k)}, seed + 1) +
                        0.2f * noise({float(x) / 40, float(y) / 40, float(k)}, seed + 2);
        board.color(x, y)[k] = std::uint8_t(std::lround(255 * alpha(x, y) * c));
      }
      board.color(x, y).a = std::uint8_t(std::lround(255 * alpha(x, y)));
      const float a = 2 * float(x) / float(width) - 1, b = 2 * float(y) / float(height) - 1;
      const float bulge = 0.7f * std::sqrt(std::max(0.0f, 1 - 0.5f * (a * a + b * b))) +
                          0.1f * noise({float(x) / 4, float(y) / 4, 3}, seed);
      const double eye_z = capture.z_near + depth * std::clamp(1.0 - bulge, 0.0, 1.0);
      board.delta(x, y) = std::uint16_t(
          encode_delta(float(depth_from_eye_z(DepthKind::window_z, eye_z, capture, {0, 0})), bits));
    }
}

}  // namespace

Camera compose_frame() {
  return look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, kFieldOfView, 1280, 720, 0.5, 1000);
}

std::vector<Nailboard> compose_pictures(int count, double cover, int delta_bits) {
  const Camera frame = compose_frame();
  SplitMix64 random{7};
  std::vector<glm::dvec2> sizes;
  double area = 0;
  for (int i = 0; i < count; ++i) {
    const double size = random.power(20, 300);
    sizes.emplace_back(size * random.between(0.6, 1), size);
    area += sizes.back().x * sizes.back().y;
  }
  const double scale = std::sqrt(cover * frame.width * frame.height / area);
  std::vector<Nailboard> boards(sizes.size());
  std::vector<std::pair<bool, std::uint64_t>> looks;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const glm::dvec2 size = glm::clamp(scale * sizes[i], 12.0, 310.0);
    const glm::dvec2 at{random.between(0.3 * size.x, frame.width - 0.3 * size.x),
                        random.between(0.3 * size.y, frame.height - 0.3 * size.y)};
    const double z = random.power(20, 200), angle = random.between(0, 2 * M_PI);
    const glm::dvec3 middle = world_from_raster(frame, at, z);
    const glm::dvec3 eye =
        0.0175 * z * glm::dvec3(std::cos(angle), std::sin(angle), random.between(-0.5, 0.5));
    const double distance = glm::length(middle - eye),
                 radius = 0.5 * size.y * texel_angle(frame) * z;
    // Texel on pixel, or a little coarser.
    const double texels = random.between(0.9, 1);
    Camera capture =
        look_at(eye, middle, {random.between(-0.02, 0.02), 1, 0}, 2 * std::atan(radius / distance),
                std::max(8, int(size.x * texels)), std::max(8, int(size.y * texels)),
                distance - radius, distance + radius);
    boards[i].geometry = picture_geometry(capture);
    boards[i].geometry.delta_bits = delta_bits;
    const bool first = random.next() < 0.5;
    looks.emplace_back(first, std::uint64_t(random.below(1 << 30)));
  }
  parallel_for(std::size_t(0), boards.size(),
               [&](std::size_t i) { fill(boards[i], looks[i].first, looks[i].second); });
  return boards;
}

std::vector<Nailboard> compose_balls(int count, int delta_bits) {
  constexpr int kSize = 16;
  const Camera frame = compose_frame();
  SplitMix64 random{1};
  std::vector<Nailboard> boards;
  for (int i = 0; i < count; ++i) {
    const double z = random.between(5, 100);
    const glm::dvec3 middle =
        world_from_raster(frame, {frame.width * random.next(), frame.height * random.next()}, z);
    const double half_angle = 0.5 * kSize * texel_angle(frame);
    const double distance = glm::length(middle), radius = half_angle * distance;
    Nailboard board;
    board.geometry = picture_geometry(look_at({0, 0, 0}, middle, {0, 1, 0}, 2 * half_angle, kSize,
                                              kSize, distance - radius, distance + radius));
    board.geometry.delta_bits = delta_bits;
    board.color = Rgba8Image(kSize, kSize);
    board.delta = Image<std::uint16_t>(kSize, kSize, std::uint16_t(delta_transparent(delta_bits)));
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const float u = (float(x) + 0.5f) / kSize, v = (float(y) + 0.5f) / kSize;
        const float r = 2 * std::hypot(u - 0.5f, v - 0.5f);
        if (r > 1) continue;
        board.color(x, y) = {std::uint8_t(255 * u), std::uint8_t(255 * v), 128, 255};
        board.delta(x, y) = std::uint16_t(encode_delta(r * r, delta_bits));
      }
    boards.push_back(std::move(board));
  }
  return boards;
}

}  // namespace rilievo::bench
