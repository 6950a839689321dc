// Splats that show a layered picture: their quality and their speed (S4.9: figure 6).
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "bench/benches.h"
#include "bench/relief_objects.h"
#include "bench/report.h"
#include "rilievo/core/color.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/layered_relief/splat_layers_test_helpers.h"
#include "rilievo/measure/flip.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/measure/ssim.h"
#include "rilievo/render/rays/cast_picture.h"

namespace rilievo::bench {
namespace {

constexpr glm::vec3 kBackground{0.55f, 0.62f, 0.70f};
// lrt_rect: splats of 1.5 source texels; lrt_exact: of one, which meet exactly where depths are
// equal; lrt_paper: of two, (u +- du, v +- dv).
constexpr const char* kSplatWays[] = {"ldi_rect",  "ldi_gauss", "lrt_rect",
                                      "lrt_gauss", "lrt_exact", "lrt_paper"};
constexpr int kWayCount = 6;
constexpr double kSplatSizes[kWayCount] = {1, 1, 1.5, 1, 1, 2};

// The object itself, on the background: the mean of four texels with a ray each.
class Truth {
 public:
  explicit Truth(const RayScene& rays) : caster_(rays) {}

  Rgba8Image operator()(Camera camera) {
    const int w = camera.width, h = camera.height;
    const std::array<float, 256>& linear = linear_of_srgb_bytes();
    camera.width *= 2, camera.height *= 2;
    caster_.draw(camera, {}, 1, fine_);
    Rgba8Image frame(w, h);
    parallel_for(0, h, [&](int y) {
      // Rows of what is cast begin at the bottom.
      const glm::u8vec4* const rows =
          &fine_.color[std::size_t(2 * (h - 1 - y)) * std::size_t(2 * w)];
      for (int x = 0; x < w; ++x) {
        glm::vec3 sum(0);
        for (int i = 0; i < 4; ++i) {
          const glm::u8vec4 c = rows[std::ptrdiff_t(i >> 1) * 2 * w + 2 * x + (i & 1)];
          sum += c.a ? glm::vec3(linear[c.r], linear[c.g], linear[c.b]) : kBackground;
        }
        for (int c = 0; c < 3; ++c)
          frame(x, y)[c] = std::uint8_t(srgb_from_linear(0.25f * sum[c]) * 255 + 0.5f);
        frame(x, y).a = 255;
      }
    });
    return frame;
  }

 private:
  PictureCaster caster_;
  RasterPicture fine_;
};

struct Sums {
  double ms = 0, psnr = 0, ssim = 0, flip = 0;
};

SplattedFrame drawn(int way, const LayeredRelief& relief, Prewarp& prewarp, Prewarped& picture,
                    const Camera& camera) {
  if (way < 2) return splat_layers(relief, camera, way ? SplatShape::gaussian : SplatShape::square);
  SplattedFrame frame = empty_frame(camera);
  if (!prewarp.warp(camera.position(), nullptr, picture)) return frame;
  if (way == 3)
    picture = picture_of(splat_layers(relief, picture.geometry.capture, SplatShape::gaussian),
                         picture.geometry);
  map_picture(picture, frame);
  return frame;
}

}  // namespace

Result<BenchReport> splats(const BenchOptions& options) {
  BenchReport report;
  Table table{"Against the object itself, at magnification 2, per object and way",
              {"object", "way", "PSNR dB", "SSIM", "FLIP", "ms"},
              {}};
  const int eyes = options.quick ? 2 : options.full ? 200 : 14, size = options.quick ? 64 : 512;
  Sums all[kWayCount];
  int done = 0, counted = 0;
  for (const char* name : {"fish", "cube", "fern"}) {
    const Result<ReliefObject> object = relief_object(name);
    if (!object) return object.error();
    const Result<LayeredDepthImage> layers =
        relief_layers(*object, size, glm::normalize(glm::dvec3(0.3, 0.35, 1)));
    if (!layers) return layers.error();
    const Result<LayeredRelief> relief = build_layered_relief(*layers);
    if (!relief) return relief.error();
    std::vector<Prewarp> prewarps;
    for (const double splat_size : kSplatSizes) {
      PrewarpOptions warp;
      warp.max_size = 2048;
      warp.splat_size = splat_size;
      prewarps.emplace_back(*relief, warp);
    }
    Truth truth(*object->rays);
    Prewarped picture;
    const ReliefFrame source = relief->frame();
    const double texel = glm::length(source.a);
    std::mt19937 rng(1);
    std::uniform_real_distribution<double> unit(-1, 1);
    Sums sums[kWayCount];
    for (int e = 0; e < eyes; ++e) {
      if (options.progress) options.progress(done++, 3 * eyes);
      // Up to 27 degrees to each side, and turned; a pixel is half a texel at the plane.
      const double away = 2.5 * size * texel;
      const double u = size * (0.5 + 1.25 * unit(rng)), v = size * (0.5 + 1.25 * unit(rng));
      const glm::dvec3 eye = source.world(u, v, -away);
      const glm::dvec3 target = source.world(0.5 * size, 0.5 * size, 0);
      const glm::dvec3 up{0.4 * unit(rng), 1, 0.4 * unit(rng)};
      const int pixels = 2 * size;
      const double fov = 2 * std::atan(0.25 * pixels * texel / away);
      const Camera camera = look_at(eye, target, up, fov, pixels, pixels, 0.01 * away, 10 * away);
      const Rgba8Image expected = truth(camera);
      const FlipTruth expected_flip(expected);
      for (int way = 0; way < kWayCount; ++way) {
        const Stopwatch watch;
        const SplattedFrame frame =
            drawn(way, *relief, prewarps[std::size_t(way)], picture, camera);
        const double took_ms = watch.ms();
        const Rgba8Image shown = frame_over(frame, kBackground);
        sums[way].ms += took_ms / eyes;
        sums[way].psnr += psnr_db(expected, shown) / eyes;
        sums[way].ssim += ssim(expected, shown) / eyes;
        sums[way].flip += expected_flip.flip(shown) / eyes;
        if (e == 1)
          report.pictures.push_back(
              png_picture(fmt::format("{}, {}", name, kSplatWays[way]), shown));
      }
      if (e == 1) report.pictures.push_back(png_picture(fmt::format("{} itself", name), expected));
    }
    ++counted;
    for (int way = 0; way < kWayCount; ++way) {
      const Sums& s = sums[way];
      table.rows.push_back({name, kSplatWays[way], fmt::format("{:.2f}", s.psnr),
                            fmt::format("{:.4f}", s.ssim), fmt::format("{:.4f}", s.flip),
                            fmt::format("{:.1f}", s.ms)});
      all[way].ms += s.ms, all[way].psnr += s.psnr;
      all[way].ssim += s.ssim, all[way].flip += s.flip;
    }
    table.rows.push_back({name, "samples", std::to_string(relief->samples()), "", "", ""});
  }
  for (int way = 0; way < kWayCount; ++way) {
    const auto figure = [&](const char* what, double sum) {
      report.figures.emplace_back(fmt::format("{}_{}", what, kSplatWays[way]), sum / counted);
    };
    figure("flip", all[way].flip);
    figure("psnr_db", all[way].psnr);
    figure("ssim", all[way].ssim);
    figure("ms", all[way].ms);
  }
  report.tables = {std::move(table)};
  report.notes = {
      fmt::format("{} eyes an object, up to 27 degrees to each side of the capture. ldi: samples "
                  "splatted into the frame; lrt: into the relief's plane, whose picture is then "
                  "drawn (interpolated), all by processors. Times with everything but the truth.",
                  eyes)};
  return report;
}

}  // namespace rilievo::bench
