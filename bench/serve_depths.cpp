// The depth codec of live walks beside others.
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <random>

#include "bench/depth_coders.h"
#include "bench/live_bench_scene.h"
#include "bench/report.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/serve/live_picture.h"
#include "rilievo/web_walk/plane16.h"

namespace rilievo::bench {
namespace {

template <class Work>
double seconds_of(const Work& work) {
  const BusyWatch busy;
  for (int i = 0; i < 5; ++i) work();
  return 1e-3 * busy.ms() / 5;
}

}  // namespace

Table depth_codec_table() {
  return {"Depths at 0.25 px in a cell of 0.5 m or less",
          {"scene", "bits", "encode Mpx/s", "decode Mpx/s", "worst / bound", "plane16 bits",
           "PNG bits", "RVL bits (Mpx/s)", "deflate bits"},
          {}};
}

void add_depth_codec(const std::string& name, LiveBenchScene& scene, Table& table,
                     BenchReport& report) {
  double pixels = 0, encode_s = 0, decode_s = 0, rvl_s = 0, worst = 0;
  std::map<std::string, double> bytes;
  std::mt19937 random(3);
  for (int i = 0; i < 4; ++i) {
    const Camera camera = scene.camera(scene.sizes().seconds * i / 4);
    const DepthImage drawn = scene.drawn(camera);
    Image<float> inverse_z(camera.width, camera.height);
    for (std::size_t t = 0; t < inverse_z.texels().size(); ++t) {
      const float z = drawn.depth.texels()[t];
      inverse_z.texels()[t] = z > 0 && z < kNoDepth ? 1 / z : 0;
    }
    const FrameScale scale = frame_scale(camera);
    const DepthStep step = choose_depth_step(nearest_of(inverse_z), 0.5, 0.25, scale);
    const Image<std::uint16_t> codes = depth_codes(inverse_z, step.step);
    std::vector<std::uint8_t> packed;
    encode_s += seconds_of([&] { packed = encode_plane16_quickly(codes); });
    decode_s += seconds_of([&] { (void)decode_plane16(packed, camera.width, camera.height); });
    std::vector<std::uint32_t> rvl;
    rvl_s += seconds_of([&] { rvl = encode_rvl(codes); });
    pixels += double(codes.texels().size());
    bytes["ours"] += double(packed.size()), bytes["rvl"] += 4.0 * double(rvl.size());
    bytes["best"] += double(encode_plane16(codes).size());
    bytes["png"] += double(encode_png_rows(codes).size());
    bytes["deflate"] += double(encode_deflate(codes).size());
    // Every texel, from an eye on the cell's border.
    Camera frame = camera;
    for (std::size_t t = 0; t < codes.texels().size(); ++t) {
      const double w = inverse_z.texels()[t];
      if (w == 0) continue;
      const double angle = 6.283185307 * (double(random()) / 4294967296.0);
      const glm::dvec3 off(step.cell * std::cos(angle), step.cell * std::sin(angle), 0);
      frame.world_from_eye = camera.world_from_eye;
      frame.world_from_eye[3] += frame.world_from_eye * glm::dvec4(off, 0);
      const int x = int(t) % camera.width, y = int(t) / camera.width;
      const double coded = inverse_z_of(codes.texels()[t], step.step, kDepthOffset);
      const glm::dvec2 at(x + 0.5, y + 0.5);
      const glm::dvec3 a = raster_from_world(frame, world_from_raster(camera, at, 1 / w));
      const glm::dvec3 b = raster_from_world(frame, world_from_raster(camera, at, 1 / coded));
      if (a.x < 0 || a.y < 0 || a.x > frame.width || a.y > frame.height) continue;
      worst = std::max(worst, std::hypot(a.x - b.x, a.y - b.y) / step.error_px);
    }
  }
  const auto bits = [&](const char* of) { return 8 * bytes[of] / pixels; };
  const double encode = 1e-6 * pixels / encode_s, decode = 1e-6 * pixels / decode_s;
  table.rows.push_back({name, fmt::format("{:.2f}", bits("ours")), fmt::format("{:.0f}", encode),
                        fmt::format("{:.0f}", decode), fmt::format("{:.2f}", worst),
                        fmt::format("{:.2f}", bits("best")), fmt::format("{:.2f}", bits("png")),
                        fmt::format("{:.2f} ({:.0f})", bits("rvl"), 1e-6 * pixels / rvl_s),
                        fmt::format("{:.2f}", bits("deflate"))});
  const FiguresOf figure(name + "_depth", report);
  figure("bits", bits("ours")), figure("worst_over_bound", worst);
  figure("encode_mpixel_s", encode), figure("decode_mpixel_s", decode);
}

}  // namespace rilievo::bench
