// Nailboards in a millisecond, and the cost of one against a plain textured quad that fetches as
// many texels.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "bench/benches.h"
#include "bench/timing.h"
#include "rilievo/nailboard/gl/nailboard_atlas.h"
#include "rilievo/nailboard/gl/nailboard_drawer.h"
#include "rilievo/render/opengl/frame_target.h"

namespace rilievo::bench {
namespace {

constexpr int kFill = 1024;  // pixels and texels a side
constexpr int kWidth = 1280, kHeight = 720;
constexpr int kMany = 10000, kManySize = 16;

// The plain quad fetches what a nailboard fetches (a colour between four texels, a Delta from one),
// and writes the colour: neither depth nor coverage, nothing is discarded.
const char* const kQuadVertex = R"(#version 450
out vec2 v_uv;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  v_uv = corner * 1024.0;
  gl_Position = vec4(corner * 2.0 - 1.0, 0.0, 1.0);
}
)";
const char* const kQuadFragment = R"(#version 450
in vec2 v_uv;
layout(binding = 0) uniform sampler2DArray color_texture;
layout(binding = 1) uniform sampler2DArray delta_texture;
layout(location = 0) out vec4 out_color;
void main() {
  float delta = texelFetch(delta_texture, ivec3(v_uv, 0), 0).r;
  vec4 color = texture(color_texture, vec3(v_uv * (1.0 / 1024.0), 0.0));
  out_color = vec4(color.rgb, delta);  // both are needed
}
)";

// A picture taken by `camera`: a tilted plane in full, or a ball in the middle.
Nailboard picture_of(const Camera& camera, bool ball) {
  Nailboard board;
  board.geometry = picture_geometry(camera);
  board.geometry.delta_bits = 8;
  board.color = Rgba8Image(camera.width, camera.height);
  board.delta =
      Image<std::uint16_t>(camera.width, camera.height, std::uint16_t(delta_transparent(8)));
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const float u = (float(x) + 0.5f) / float(camera.width),
                  v = (float(y) + 0.5f) / float(camera.height);
      const float r = 2 * std::hypot(u - 0.5f, v - 0.5f);
      if (ball && r > 1) continue;
      board.color(x, y) = {std::uint8_t(255 * u), std::uint8_t(255 * v), 128, 255};
      board.delta(x, y) = std::uint16_t(encode_delta(ball ? r * r : u, 8));
    }
  return board;
}

Camera square_camera(const glm::dvec3& eye, const glm::dvec3& target, double half_angle, int size,
                     double z_near, double z_far) {
  return look_at(eye, target, {0, 1, 0}, 2 * half_angle, size, size, z_near, z_far);
}

struct Fill {
  double nailboard_ms = 0, quad_ms = 0;
};

// One nailboard, then one quad, over all pixels of the frame, texel on pixel.
Result<Fill> measure_fill(DepthMode mode, int samples, int runs) {
  Result<FrameTarget> target = FrameTarget::create(kFill, kFill, samples);
  if (!target) return target.error();
  Result<NailboardAtlas> atlas = NailboardAtlas::create({std::size_t(128) << 20, 8, 1});
  if (!atlas) return atlas.error();
  Result<NailboardDrawer> drawer = NailboardDrawer::create();
  if (!drawer) return drawer.error();
  Result<gl::Program> quad = gl::make_program("quad", kQuadVertex, kQuadFragment);
  if (!quad) return quad.error();
  const gl::VertexArray no_vertices = gl::make_vertex_array();

  const Camera camera = square_camera({0, 0, 0}, {0, 0, -1}, 0.4, kFill, 5, 6);
  const Nailboard board = picture_of(camera, false);
  const auto slot = atlas->allocate(kFill, kFill);
  if (!slot) return Error{"bench", "no room for one picture"};
  atlas->write(*slot, board);
  Camera frame = camera;
  frame.z_near = 1, frame.z_far = 100;
  const std::vector<NailboardInstance> instances{{*slot, board.geometry, glm::dmat4(1.0), 1}};

  Fill fill;
  const auto clear = [&] { target->begin(); };
  fill.nailboard_ms = finished_ms(
      runs, 2, [&] { drawer->draw(*atlas, frame, mode, instances); }, clear);
  fill.quad_ms = finished_ms(
      runs, 2,
      [&] {
        glUseProgram(*quad);
        glBindVertexArray(no_vertices);
        glBindTextureUnit(0, atlas->color_texture());
        glBindTextureUnit(1, atlas->delta_texture());
        glEnable(GL_DEPTH_TEST);
        glDepthFunc(GL_LESS);
        glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
      },
      clear);
  return fill;
}

// Many small balls all over the frame, near and far, in one call: milliseconds of the whole frame.
Result<double> measure_many(DepthMode mode, int samples, int count, int runs) {
  Result<FrameTarget> target = FrameTarget::create(kWidth, kHeight, samples);
  if (!target) return target.error();
  Result<NailboardAtlas> atlas = NailboardAtlas::create({std::size_t(192) << 20, 8, 1});
  if (!atlas) return atlas.error();
  Result<NailboardDrawer> drawer = NailboardDrawer::create();
  if (!drawer) return drawer.error();
  const Camera frame = look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.9, kWidth, kHeight, 0.1, 1000);
  std::vector<NailboardInstance> instances;
  std::uint32_t state = 1;
  const auto random = [&state] {  // [Marsaglia 2003], xorshift; 24 bits of it
    state ^= state << 13, state ^= state >> 17, state ^= state << 5;
    return double(state >> 8) / double(1 << 24);
  };
  for (int i = 0; i < count; ++i) {
    const double distance = 5 + 95 * random();
    const glm::dvec3 middle =
        world_from_raster(frame, {kWidth * random(), kHeight * random()}, distance);
    const double half_angle = 0.5 * kManySize * texel_angle(frame);
    const double radius = half_angle * glm::length(middle);
    const Camera camera = square_camera({0, 0, 0}, middle, half_angle, kManySize,
                                        glm::length(middle) - radius, glm::length(middle) + radius);
    const auto slot = atlas->allocate(kManySize, kManySize);
    if (!slot) return Error{"bench", "no room for the pictures"};
    const Nailboard board = picture_of(camera, true);
    atlas->write(*slot, board);
    instances.push_back({*slot, board.geometry, glm::dmat4(1.0), std::uint32_t(i + 1)});
  }
  return finished_ms(runs, 2, [&] {
    target->begin();
    drawer->draw(*atlas, frame, mode, instances);
    target->resolve();
  });
}

}  // namespace

Result<BenchReport> draw(const BenchOptions& options) {
  const int runs = options.quick ? 1 : 31, count = options.quick ? 100 : kMany;
  BenchReport report;
  Table fill_table{"One nailboard of 1024 x 1024 texels over as many pixels",
                   {"samples", "depth", "nailboard ms", "quad ms", "ratio"},
                   {}};
  Table many_table{fmt::format("A frame of {} nailboards of {} x {} pixels, 1280 x 720", count,
                               kManySize, kManySize),
                   {"samples", "depth", "ms", "nailboards per ms"},
                   {}};
  const std::pair<const char*, DepthMode> modes[] = {
      {"exact", DepthMode::exact}, {"linear", DepthMode::linear}, {"flat", DepthMode::flat}};
  int done = 0;
  for (const int samples : {1, 4})
    for (const auto& [name, mode] : modes) {
      const Result<Fill> fill = measure_fill(mode, samples, runs);
      if (!fill) return fill.error();
      const Result<double> many_ms = measure_many(mode, samples, count, runs);
      if (!many_ms) return many_ms.error();
      const double ratio = fill->nailboard_ms / fill->quad_ms, per_ms = count / *many_ms;
      fill_table.rows.push_back(
          {std::to_string(samples), name, fmt::format("{:.2f}", fill->nailboard_ms),
           fmt::format("{:.2f}", fill->quad_ms), fmt::format("{:.2f}", ratio)});
      many_table.rows.push_back({std::to_string(samples), name, fmt::format("{:.2f}", *many_ms),
                                 fmt::format("{:.0f}", per_ms)});
      if (samples == 4 && mode == DepthMode::exact)
        report.figures = {{"fill_cost_ratio", ratio},
                          {"nailboards_per_ms", per_ms},
                          {"ten_thousand_ms", *many_ms}};
      if (options.progress) options.progress(++done, 6);
    }
  report.tables = {std::move(fill_table), std::move(many_table)};
  report.notes = {
      "The quad fetches the same two texels (colour between four, Delta from one) and writes "
      "colours; it writes no depth of its own and discards nothing.",
      "The figures are those of exact depth at 4 samples a pixel."};
  return report;
}

}  // namespace rilievo::bench
