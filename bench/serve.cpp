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

#include "bench/benches.h"
#include "bench/live_bench_scene.h"
#include "bench/real_scenes.h"
#include "bench/report.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/measure/stats.h"
#include "rilievo/measure/visibility.h"
#include "rilievo/serve/live_picture.h"
#include "rilievo/serve/live_simulation_test_helpers.h"
#include "rilievo/web_walk/dilate.h"

namespace rilievo::bench {
namespace {

struct NetworkCase {
  std::string name;
  SimulatedNetwork network;
  double cell = 0;
  bool every_scene = true;
};

std::vector<NetworkCase> network_cases(const BenchOptions& options) {
  const auto of = [](double latency, double jitter, double mbit_s, double loss = 0) {
    SimulatedNetwork network;
    network.latency_ms = latency, network.jitter_ms = jitter, network.mbit_s = mbit_s;
    network.loss = loss;
    return network;
  };
  const NetworkCase usual{"50 ms, 20 Mbit/s", of(50, 20, 20), 0, true};
  if (options.quick) return {usual};
  std::vector<NetworkCase> cases;
  for (const double latency : options.latencies_ms) {
    const double jitter = latency == 50 ? 20 : latency == 20 ? 10 : 0;
    cases.push_back({fmt::format("{:g} ms, 20 Mbit/s", latency), of(latency, jitter, 20), 0, true});
  }
  if (!cases.empty()) return cases;
  cases.push_back({"0 ms, 20 Mbit/s", of(0, 0, 20), 0, true});
  cases.push_back({"20 ms, 20 Mbit/s", of(20, 10, 20), 0, true});
  cases.push_back(usual);
  cases.push_back({"250 ms, 20 Mbit/s", of(250, 0, 20), 0, true});
  cases.push_back({"500 ms, 20 Mbit/s", of(500, 0, 20), 0, true});
  if (!options.full) return cases;
  cases.push_back({"50 ms, 5 Mbit/s", of(50, 20, 5), 0, false});
  cases.push_back({"50 ms, 100 Mbit/s", of(50, 20, 100), 0, false});
  cases.push_back({"50 ms, 20 Mbit/s, loss 0.1 %", of(50, 20, 20, 0.001), 0, false});
  for (const double cell : {0.25, 0.5, 1.0})
    cases.push_back(
        {fmt::format("50 ms, 20 Mbit/s, cell {:g} m", cell), of(50, 20, 20), cell, false});
  return cases;
}

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
  // The frame that is farthest from the true one, and that.
  double worst_db = HUGE_VAL;
  Rgba8Image worst, worst_truth;
};

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

// What a frame of the server costs a rival.
struct RivalCost {
  double took = 0, bytes = 0;
};

struct RivalPicture {
  MadePicture made;
  double took = 0;
};

RivalPicture rival_picture(LiveBenchScene& scene, double at, double margin) {
  LivePictureOrder order;
  const Camera frame = scene.camera(at);
  order.camera = margin > 1 ? keyframe_camera(frame, margin, 1) : frame;
  order.frame = frame_scale(frame), order.sky = scene.sky();
  order.fine = true, order.cell = 0.5;
  const BusyWatch busy;
  RivalPicture picture{*make_live_picture(scene.source(), order)};
  picture.took = 0.5e-3 * busy.ms();
  return picture;
}

// The server's last frame as it is when it is seen: its pose went there, it was drawn, it was sent,
// and it is shown until the next one. What is warped has a margin as our pictures have, and the
// age of video, though it has more bytes.
void add_rivals(LiveBenchScene& scene, const NetworkCase& network, double now,
                std::map<double, RivalCost>& costs, CaseFigures& out) {
  if (!costs.contains(now)) {
    const RivalPicture probe = rival_picture(scene, now, 1);
    costs[now] = {probe.took, double(probe.made.colors.size())};
  }
  const RivalCost cost = costs.at(now);
  const double sent_s = 8e-6 * cost.bytes / network.network.mbit_s;
  const double each_s = std::max({cost.took, sent_s, 1 / 60.0});
  const double age = 2e-3 * network.network.latency_ms + cost.took + sent_s + 0.5 * each_s;
  Keyframe keyframe;
  const Camera camera = scene.camera(now);
  const Rgba8Image& truth = scene.truth(now).first;
  const MadePicture seen = rival_picture(scene, now - age, 1).made;
  out.video.add(truth, jpeg_and_back(seen, camera.z_far, keyframe));
  const MadePicture wider = rival_picture(scene, now - age, LiveWorldOptions{}.margin).made;
  (void)jpeg_and_back(wider, camera.z_far, keyframe);
  out.one.add(truth, warped_alone(keyframe, camera, out.one.holes));
  Keyframe plane = keyframe;
  for (float& w : plane.inverse_z.texels()) w = float(std::max(wider.typical_inverse_z, 1e-6));
  find_ranges(plane, 0, plane.camera.width);
  out.plane.add(truth, warped_alone(plane, camera, out.plane.holes));
  out.video_mbit_s += 8e-6 * double(seen.colors.size()) / each_s;
  out.video_age_s += age;
}

Result<CaseFigures> run_case(LiveBenchScene& scene, const NetworkCase& network, bool rivals,
                             std::map<double, RivalCost>& costs) {
  CaseFigures out;
  LiveWorldOptions options = scene.world_options();
  options.keep_objects = true;
  LiveWorld world(scene.source(), scene.quick(), scene.shown(), options);
  SimulatedClient client;
  client.camera = [&](double s) { return scene.camera(s); };
  client.network = network.network, client.cell = network.cell;
  SimulatedWalk walk;
  walk.seconds = scene.sizes().seconds;
  walk.frames_a_second = scene.sizes().frames_a_second;
  walk.objects = true;
  const auto traffic = simulate_walk(
      world, std::span(&client, 1), walk, [&](int, double now, const LiveClient& seen) {
        // The first seconds are those of the first view.
        if (now < 1.9) return;
        LiveFrame frame;
        seen.draw(scene.camera(now), frame, true);
        const auto& [color, objects] = scene.truth(now);
        const double before = out.live.psnr;
        out.live.add(color, frame.color);
        if (const double db = out.live.psnr - before; db < out.worst_db)
          out.worst_db = db, out.worst = frame.color, out.worst_truth = color;
        out.live.holes += double(frame.holes) / double(frame.color.texels().size());
        out.live.wrong += compare_visibility(objects, frame.objects).wrong_share();
        if (rivals) add_rivals(scene, network, now, costs, out);
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
  const std::string of = scene + ", " + network.name;
  report.pictures.push_back(
      jpeg_picture(fmt::format("{}, the worst frame: {:.1f} dB", of, f.worst_db), f.worst));
  report.pictures.push_back(jpeg_picture(of + ", the true one", f.worst_truth));
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

// ---- many clients

Result<> add_crowd(const std::string& name, LiveBenchScene& scene, int count, bool apart,
                   Table& table, BenchReport& report) {
  LiveWorld world(scene.source(), scene.quick(), scene.shown(), scene.world_options());
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
  walk.seconds = std::min(0.5 * scene.sizes().seconds, 8.0), walk.frames_a_second = 0.01;
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
  if (!options.source.empty() && options.source != "raster" && options.source != "raytrace")
    return Error{"--source", "serve takes raster or raytrace"};
  LiveSizes sizes;
  if (options.full) sizes.seconds = 60, sizes.frames_a_second = 0.5;
  if (options.quick) sizes = {160, 96, 3, 1};
  if (options.seconds > 0) sizes.seconds = options.seconds;
  if (options.every_frame > 0) sizes.frames_a_second = 60.0 / options.every_frame;
  if (options.width > 0) sizes.width = options.width, sizes.height = options.height;
  std::vector<RealScene> scenes = bench_scenes(options);
  if (!options.full && options.scenes.empty() && scenes.size() > 2) scenes.resize(2);
  BenchReport report;
  Table live{fmt::format("A walk of {:g} s, {} x {}, 16 samples a pixel of true frames",
                         sizes.seconds, sizes.width, sizes.height),
             {"walk", "Mbit/s", "worst s", "PSNR dB", "SSIM", "FLIP", "holes %", "wrong %",
              "first view s", "fine s"},
             {}};
  Table codec = depth_codec_table();
  Table crowd{
      "Clients of one server", {"clients", "sharp p50 s", "p95 s", "made", "shared", "Mbit/s"}, {}};
  int done = 0;
  bool first = true;
  for (const RealScene& real : scenes) {
    Result<Scene> scene = real.make();
    if (!scene) return scene.error();
    const std::vector<RealWalk> walks = real.walks(*scene);
    const RealWalk& walk = walks.front();
    // A path that ends would leave an eye that stands, which any baseline serves well.
    const auto made = LiveBenchScene::create(*scene, there_and_back(walk.path, kLongestWalk), sizes,
                                             options.source == "raytrace");
    if (!made) return made.error();
    LiveBenchScene& shown = **made;
    const std::string name = real.name + "-" + walk.name;
    add_depth_codec(name, shown, codec, report);
    shown.find_work();
    report.figures.emplace_back(key_of(name) + "_work_s", shown.work_s);
    report.figures.emplace_back(key_of(name) + "_coarse_work_s", shown.coarse_work_s);
    std::map<double, RivalCost> costs;
    for (const NetworkCase& network : network_cases(options)) {
      if (!network.every_scene && !first) continue;
      const Result<CaseFigures> figures =
          run_case(shown, network, network.every_scene && network.cell == 0, costs);
      if (!figures) return figures.error();
      add_case(name, network, *figures, live, report);
    }
    if (first && options.latencies_ms.empty())
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
