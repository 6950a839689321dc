// What a client of a live walk sees, and its cost, over networks of all kinds.
//
// One server and its clients in simulated time (rilievo/serve/live_simulation_test_helpers.h),
// beside JPEG video, the warp of one plane and the warp of one keyframe. And the depth codec beside
// others.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>

#include "bench/benches.h"
#include "bench/depth_coders.h"
#include "bench/real_scenes.h"
#include "bench/report.h"
#include "rilievo/capture/raster_ray_source.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/io/jpeg.h"
#include "rilievo/measure/stats.h"
#include "rilievo/measure/visibility.h"
#include "rilievo/serve/live_picture.h"
#include "rilievo/serve/live_simulation_test_helpers.h"
#include "rilievo/web_walk/dilate.h"
#include "rilievo/web_walk/plane16.h"

namespace rilievo::bench {
namespace {

struct Sizes {
  int width = 1280, height = 720;
  double seconds = 8;
  double frames_a_second = 2;  // that are compared
};

struct NetworkCase {
  std::string name;
  SimulatedNetwork network;
  double cell = 0;
  bool every_scene = true;
};

std::vector<NetworkCase> network_cases(bool quick, bool full) {
  const auto of = [](double latency, double jitter, double mbit_s, double loss = 0) {
    SimulatedNetwork network;
    network.latency_ms = latency, network.jitter_ms = jitter, network.mbit_s = mbit_s;
    network.loss = loss;
    return network;
  };
  const NetworkCase usual{"50 ms, 20 Mbit/s", of(50, 20, 20), 0, true};
  if (quick) return {usual};
  std::vector<NetworkCase> cases{{"0 ms, 20 Mbit/s", of(0, 0, 20), 0, true}};
  cases.push_back({"20 ms, 20 Mbit/s", of(20, 10, 20), 0, true});
  cases.push_back(usual);
  cases.push_back({"250 ms, 20 Mbit/s", of(250, 0, 20), 0, true});
  cases.push_back({"500 ms, 20 Mbit/s", of(500, 0, 20), 0, true});
  if (!full) return cases;
  cases.push_back({"50 ms, 5 Mbit/s", of(50, 20, 5), 0, false});
  cases.push_back({"50 ms, 100 Mbit/s", of(50, 20, 100), 0, false});
  cases.push_back({"50 ms, 20 Mbit/s, loss 0.1 %", of(50, 20, 20, 0.001), 0, false});
  for (const double cell : {0.25, 0.5, 1.0})
    cases.push_back(
        {fmt::format("50 ms, 20 Mbit/s, cell {:g} m", cell), of(50, 20, 20), cell, false});
  return cases;
}

// A scene with what draws it, and true frames that are kept.
struct LiveBenchScene {
  const Scene& scene;
  CameraPath path;
  Sizes sizes;
  PlacedScene placed{scene};
  RayScene rays;
  RasterRaySource source{placed, rays};
  std::map<double, std::pair<Rgba8Image, Image<std::uint32_t>>> true_frames;
  // Of pictures, by processor time over two cores: once, so that no row depends on what else runs.
  double work_s = 0, coarse_work_s = 0;

  LiveBenchScene(const Scene& of, CameraPath walk, RayScene seen, const Sizes& how)
      : scene(of), path(std::move(walk)), sizes(how), rays(std::move(seen)) {}

  [[nodiscard]] Camera camera(double seconds) const {
    return camera_at(path, path.keys.front().time + std::max(seconds, 0.0), sizes.width,
                     sizes.height);
  }
  [[nodiscard]] DepthImage drawn(const Camera& camera) {
    CaptureRequest request;
    request.camera = camera;
    request.with_sky = true;
    return std::move(source.capture(request)->picture);
  }
  // Of 16 samples a pixel: four of each quarter.
  const std::pair<Rgba8Image, Image<std::uint32_t>>& truth(double now) {
    const auto found = true_frames.find(now);
    if (found != true_frames.end()) return found->second;
    Camera larger = camera(now);
    larger.width *= 2, larger.height *= 2;
    const Rgba8Image fine = srgb8_from_linear(drawn(larger).color);
    Rgba8Image color(sizes.width, sizes.height);
    for (int y = 0; y < sizes.height; ++y)
      for (int x = 0; x < sizes.width; ++x) {
        glm::ivec4 sum(2);
        for (int k = 0; k < 4; ++k) sum += glm::ivec4(fine(2 * x + k % 2, 2 * y + k / 2));
        color(x, y) = glm::u8vec4(sum / 4);
      }
    return true_frames.emplace(now, std::pair(std::move(color), drawn(camera(now)).object))
        .first->second;
  }
};

// How right frames are, and what they lack: means.
struct LiveRightness : Rightness {
  double holes = 0, wrong = 0;
  void finish() {
    Rightness::finish();
    for (double* sum : {&holes, &wrong}) *sum /= std::max(frames, 1);
  }
};

struct CaseFigures {
  LiveRightness live, video, plane, one;  // the last ones: of the last frame
  double mbit_s = 0, worst_mbit_s = 0, first_view = 0, first_fine = 0;
  double video_mbit_s = 0, video_age_s = 0;
  LiveWorldStats stats;
};

LiveScene shown_scene(LiveBenchScene& scene) {
  LiveScene shown;
  shown.name = scene.scene.name, shown.bounds = scene.source.bounds({});
  shown.start = scene.camera(0);
  return shown;
}

// The median of a few pictures along the walk.
void find_work(LiveBenchScene& scene) {
  for (const bool fine : {true, false}) {
    std::vector<double> took;
    for (int i = 0; i < 7; ++i) {
      LivePictureOrder order;
      const Camera frame = scene.camera(scene.sizes.seconds * i / 7);
      order.frame = frame_scale(frame), order.fine = fine, order.cell = 0.5;
      order.camera = keyframe_camera(frame, 1.25, fine ? 1 : 0.5);
      const BusyWatch busy;
      (void)make_live_picture(scene.source, order);
      took.push_back(0.5e-3 * busy.ms());
    }
    (fine ? scene.work_s : scene.coarse_work_s) = std::max(percentile(took, 0.5), 1e-6);
  }
}

LiveWorldOptions world_options(const LiveBenchScene& scene) {
  LiveWorldOptions options;
  options.work_s = scene.work_s, options.coarse_work_s = scene.coarse_work_s;
  return options;
}

Rgba8Image jpeg_and_back(const MadePicture& made, double z_far, Keyframe& keyframe) {
  const std::vector<std::byte> message = encode_picture(made, made.head);
  const Result<ServerMessage> read = parse_server_message(message);
  keyframe = *decode_live_picture(std::get<LivePicture>(*read), z_far);
  return opaque_colors(keyframe.color);
}

Rgba8Image warped_alone(const Keyframe& keyframe, const Camera& camera, double& holes) {
  const WarpedKeyframe one{&keyframe};
  WarpedFrame warped;
  warp_keyframes(std::span(&one, 1), camera, warped);
  Rgba8Image color = opaque_colors(warped.color);
  holes += double(warped.holes()) / double(color.texels().size());
  if (warped.holes() > 0) dilate_colors(color);
  return color;
}

// The server's last frame as it is when it is seen: its pose went there, it was drawn, it was sent,
// and it is shown until the next one.
void add_rivals(LiveBenchScene& scene, const NetworkCase& network, double now, CaseFigures& out) {
  const auto make = [&](double at, double& took) {
    LivePictureOrder order;
    order.camera = scene.camera(at), order.frame = frame_scale(order.camera);
    order.fine = true, order.cell = 0.5;
    const BusyWatch busy;
    MadePicture made = *make_live_picture(scene.source, order);
    took = 0.5e-3 * busy.ms();
    return made;
  };
  double took = 0;
  const MadePicture probe = make(now, took);
  const double sent_s = 8e-6 * double(probe.colors.size()) / network.network.mbit_s;
  const double each_s = std::max({took, sent_s, 1 / 60.0});
  const double age = 2e-3 * network.network.latency_ms + took + sent_s + 0.5 * each_s;
  const MadePicture made = make(now - age, took);
  Keyframe keyframe;
  const Camera camera = scene.camera(now);
  const Rgba8Image& truth = scene.truth(now).first;
  out.video.add(truth, jpeg_and_back(made, camera.z_far, keyframe));
  out.one.add(truth, warped_alone(keyframe, camera, out.one.holes));
  Keyframe plane = keyframe;
  for (float& w : plane.inverse_z.texels()) w = float(std::max(made.typical_inverse_z, 1e-6));
  find_ranges(plane, 0, plane.camera.width);
  out.plane.add(truth, warped_alone(plane, camera, out.plane.holes));
  out.video_mbit_s += 8e-6 * double(made.colors.size()) / each_s;
  out.video_age_s += age;
}

Result<CaseFigures> run_case(LiveBenchScene& scene, const NetworkCase& network, bool rivals) {
  CaseFigures out;
  LiveWorldOptions options = world_options(scene);
  options.keep_objects = true;
  LiveWorld world(scene.source, scene.source, shown_scene(scene), options);
  SimulatedClient client;
  client.camera = [&](double s) { return scene.camera(s); };
  client.network = network.network, client.cell = network.cell;
  SimulatedWalk walk;
  walk.seconds = scene.sizes.seconds, walk.frames_a_second = scene.sizes.frames_a_second;
  walk.objects = true;
  const auto traffic = simulate_walk(
      world, std::span(&client, 1), walk, [&](int, double now, const LiveClient& seen) {
        // The first seconds are those of the first view.
        if (now < 1.9) return;
        LiveFrame frame;
        seen.draw(scene.camera(now), frame, true);
        const auto& [color, objects] = scene.truth(now);
        out.live.add(color, frame.color);
        out.live.holes += double(frame.holes) / double(frame.color.texels().size());
        out.live.wrong += compare_visibility(objects, frame.objects).wrong_share();
        if (rivals) add_rivals(scene, network, now, out);
      });
  if (!traffic) return traffic.error();
  const SimulatedTraffic& one = traffic->front();
  for (std::size_t i = 1; i < one.bytes_a_second.size(); ++i) {
    const double mbit = 8e-6 * one.bytes_a_second[i];
    out.mbit_s += mbit / double(one.bytes_a_second.size() - 1);
    out.worst_mbit_s = std::max(out.worst_mbit_s, mbit);
  }
  out.video_mbit_s /= std::max(out.video.frames, 1),
      out.video_age_s /= std::max(out.video.frames, 1);
  out.first_view = one.first_view, out.first_fine = one.first_fine;
  for (LiveRightness* r : {&out.live, &out.video, &out.plane, &out.one}) r->finish();
  out.stats = world.stats();
  return {out};
}

void add_case(const std::string& scene, const NetworkCase& network, const CaseFigures& f,
              Table& table, BenchReport& report) {
  const FiguresOf figure(scene + " " + network.name, report);
  figure("mbit_s", f.mbit_s), figure("worst_second_mbit_s", f.worst_mbit_s);
  figure("psnr_db", f.live.psnr), figure("ssim", f.live.ssim), figure("flip", f.live.flip);
  figure("holes", f.live.holes), figure("wrong_share", f.live.wrong);
  figure("first_view_s", f.first_view), figure("first_fine_s", f.first_fine);
  table.rows.push_back({scene + ", " + network.name, fmt::format("{:.1f}", f.mbit_s),
                        fmt::format("{:.1f}", f.worst_mbit_s), fmt::format("{:.1f}", f.live.psnr),
                        fmt::format("{:.3f}", f.live.ssim), fmt::format("{:.3f}", f.live.flip),
                        fmt::format("{:.3f}", 100 * f.live.holes),
                        fmt::format("{:.3f}", 100 * f.live.wrong),
                        fmt::format("{:.2f}", f.first_view), fmt::format("{:.2f}", f.first_fine)});
  if (f.video.frames == 0) return;
  for (const auto& [name, r] :
       {std::pair("video", f.video), {"plane", f.plane}, {"one keyframe", f.one}}) {
    figure(fmt::format("{} psnr_db", name), r.psnr), figure(fmt::format("{} flip", name), r.flip);
    table.rows.push_back({fmt::format("    {}", name), fmt::format("{:.1f}", f.video_mbit_s), "",
                          fmt::format("{:.1f}", r.psnr), fmt::format("{:.3f}", r.ssim),
                          fmt::format("{:.3f}", r.flip), fmt::format("{:.3f}", 100 * r.holes), "",
                          "", ""});
  }
}

// ---- the depth codec

template <class Work>
double seconds_of(const Work& work) {
  const BusyWatch busy;
  for (int i = 0; i < 5; ++i) work();
  return 1e-3 * busy.ms() / 5;
}

void add_codec(const std::string& name, LiveBenchScene& scene, Table& table, BenchReport& report) {
  double pixels = 0, encode_s = 0, decode_s = 0, rvl_s = 0, worst = 0;
  std::map<std::string, double> bytes;
  std::mt19937 random(3);
  for (int i = 0; i < 4; ++i) {
    const Camera camera = scene.camera(scene.sizes.seconds * i / 4);
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

// ---- many clients

Result<> add_crowd(const std::string& name, LiveBenchScene& scene, int count, bool apart,
                   Table& table, BenchReport& report) {
  LiveWorld world(scene.source, scene.source, shown_scene(scene), world_options(scene));
  std::vector<SimulatedClient> clients;
  for (int i = 0; i < count; ++i) {
    SimulatedClient client;
    const double shift = apart ? 3.0 * i : 0.05 * i;
    client.camera = [&scene, shift](double s) { return scene.camera(s + shift); };
    client.network.latency_ms = 20, client.network.mbit_s = 100;
    client.joins = 0.05 * i;
    clients.push_back(std::move(client));
  }
  SimulatedWalk walk;
  walk.seconds = std::min(0.5 * scene.sizes.seconds, 8.0), walk.frames_a_second = 0.01;
  const auto traffic = simulate_walk(world, clients, walk, [](int, double, const LiveClient&) {});
  if (!traffic) return traffic.error();
  std::vector<double> sharp;
  double bytes = 0;
  for (const SimulatedTraffic& one : *traffic) {
    sharp.push_back(one.first_fine < 0 ? walk.seconds : one.first_fine);
    bytes += std::accumulate(one.bytes_a_second.begin(), one.bytes_a_second.end(), 0.0);
  }
  const double p50 = median_of(sharp), p95 = percentile(sharp, 0.95);
  const LiveWorldStats stats = world.stats();
  table.rows.push_back({fmt::format("{}, {} {}", name, count,
                                    count == 1 ? ""
                                    : apart    ? "apart"
                                               : "near"),
                        fmt::format("{:.2f}", p50), fmt::format("{:.2f}", p95),
                        std::to_string(stats.made), std::to_string(stats.shared),
                        fmt::format("{:.1f}", 8e-6 * bytes / walk.seconds)});
  const std::string key =
      key_of(fmt::format("{} clients {} {}", name, count, apart ? "apart" : "near"));
  report.figures.emplace_back(key + "_sharp_p50_s", p50);
  report.figures.emplace_back(key + "_sharp_p95_s", p95);
  return Done{};
}

}  // namespace

Result<BenchReport> serve(const BenchOptions& options) {
  Sizes sizes;
  if (options.full) sizes.seconds = 60;
  if (options.quick) sizes = {160, 96, 3, 1};
  if (options.width > 0) sizes.width = options.width, sizes.height = options.height;
  std::vector<RealScene> scenes = bench_scenes(options);
  if (!options.full && scenes.size() > 2) scenes.resize(2);
  BenchReport report;
  Table live{fmt::format("A walk of {:g} s, {} x {}, 16 samples a pixel of true frames",
                         sizes.seconds, sizes.width, sizes.height),
             {"walk", "Mbit/s", "worst s", "PSNR dB", "SSIM", "FLIP", "holes %", "wrong %",
              "first view s", "fine s"},
             {}};
  Table codec{"Depths at 0.25 px in a cell of 0.5 m or less",
              {"scene", "bits", "encode Mpx/s", "decode Mpx/s", "worst / bound", "plane16 bits",
               "PNG bits", "RVL bits (Mpx/s)", "deflate bits"},
              {}};
  Table crowd{
      "Clients of one server", {"clients", "sharp p50 s", "p95 s", "made", "shared", "Mbit/s"}, {}};
  int done = 0;
  bool first = true;
  for (const RealScene& real : scenes) {
    Result<Scene> scene = real.make();
    if (!scene) return scene.error();
    const std::vector<RealWalk> walks = real.walks(*scene);
    Result<RayScene> rays = RayScene::create(*scene);
    if (!rays) return rays.error();
    const RealWalk& walk = walks.front();
    // A path that ends would leave an eye that stands, which any baseline serves well.
    LiveBenchScene shown(*scene, there_and_back(walk.path, kLongestWalk), std::move(*rays), sizes);
    const std::string name = real.name + "-" + walk.name;
    add_codec(name, shown, codec, report);
    find_work(shown);
    report.figures.emplace_back(key_of(name) + "_work_s", shown.work_s);
    report.figures.emplace_back(key_of(name) + "_coarse_work_s", shown.coarse_work_s);
    for (const NetworkCase& network : network_cases(options.quick, options.full)) {
      if (!network.every_scene && !first) continue;
      const Result<CaseFigures> figures =
          run_case(shown, network, network.every_scene && network.cell == 0);
      if (!figures) return figures.error();
      add_case(name, network, *figures, live, report);
    }
    if (first)
      for (const auto& [count, apart] : {std::pair(1, false), {16, false}, {16, true}})
        if (Result<> added = add_crowd(name, shown, options.quick ? std::min(count, 3) : count,
                                       apart, crowd, report);
            !added)
          return added.error();
    first = false;
    if (options.progress) options.progress(++done, int(scenes.size()));
  }
  report.tables = {std::move(live), std::move(codec), std::move(crowd)};
  report.notes.push_back(
      "Time is simulated: the server's work is charged by its processor time over two cores. Video "
      "is the server's frame as JPEG, as old as its way takes; plane warps it as if all were as "
      "far "
      "as what is typical, one keyframe by its depths, holes filled from beside.");
  return {std::move(report)};
}

}  // namespace rilievo::bench
