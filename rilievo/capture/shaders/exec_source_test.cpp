#include "rilievo/capture/shaders/exec_source.h"

#include <gtest/gtest.h>
#include <pthread.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "rilievo/capture/ray_source.h"
#include "rilievo/capture/shaders/line_process.h"
#include "rilievo/capture/shaders/software_shader.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/relief_impostor/impostor_content.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

// A renderer: texels show where their rays cross the plane z = -1 of the eye, 4 metres before it;
// nothing where that is left of -0.5. The arguments say what goes wrong, and whether from the first
// request on (0) or with pictures only.
constexpr const char* kRenderer = R"(#!/usr/bin/python3 -SE
import json, os, struct, sys, time
fault, at = sys.argv[1], int(sys.argv[2])
def exr(camera, path):
    w, h = camera["width"], camera["height"]
    if fault == "size": w += 1
    left, right, bottom, top = camera["window"]
    s = lambda name, kind, data: name + b"\0" + kind + b"\0" + struct.pack("<i", len(data)) + data
    names = [b"A", b"B", b"G", b"R", b"Z"]
    if fault == "channel": names.pop()
    box = struct.pack("<4i", 0, 0, w - 1, h - 1)
    head = struct.pack("<ii", 20000630, 2)
    head += s(b"channels", b"chlist",
              b"".join(n + b"\0" + struct.pack("<iiii", 2, 0, 1, 1) for n in names) + b"\0")
    head += s(b"compression", b"compression", b"\0")
    head += s(b"dataWindow", b"box2i", box) + s(b"displayWindow", b"box2i", box)
    head += s(b"lineOrder", b"lineOrder", b"\0") + s(b"pixelAspectRatio", b"float", struct.pack("<f", 1))
    head += s(b"screenWindowCenter", b"v2f", struct.pack("<ff", 0, 0))
    head += s(b"screenWindowWidth", b"float", struct.pack("<f", 1)) + b"\0"
    size = 4 * len(names) * w
    table = b"".join(struct.pack("<Q", len(head) + 8 * h + y * (8 + size)) for y in range(h))
    rows = b""
    for y in range(h):
        ys = [top + (bottom - top) * (y + 0.5) / h] * w
        xs = [left + (right - left) * (x + 0.5) / w for x in range(w)]
        z = [float("nan") if fault == "nan" else 1e10 if x < -0.5 else 4.0 for x in xs]
        planes = {b"A": [1.0] * w, b"B": [float(camera["z_far"])] * w, b"G": ys, b"R": xs, b"Z": z}
        rows += struct.pack("<ii", y, size) + b"".join(struct.pack("<%df" % w, *planes[n]) for n in names)
    data = head + table + rows
    with open(path, "wb") as f: f.write(data[:len(data) // 2] if fault == "half" else data)
for line in sys.stdin:
    ask = json.loads(line)
    bad = at == 0 or ask["request"] == "picture"
    if bad and fault == "dies": os._exit(3)
    if bad and fault == "dies once" and not os.path.exists(sys.argv[3]):
        open(sys.argv[3], "w").close()
        os._exit(3)
    if bad and fault == "never": time.sleep(1000)
    if bad and fault == "rubbish": print("Fra:1 Mem:23M", flush=True); continue
    if bad and fault == "other id": print(json.dumps({"id": 77}), flush=True); continue
    if bad and fault == "endless": sys.stdout.write("x" * 3000000); sys.stdout.flush(); continue
    if bad and fault == "deaf": os.close(0); time.sleep(1000)
    if bad and fault == "says no": print(json.dumps({"id": ask["id"], "error": "out\nof paint"}), flush=True); continue
    if ask["request"] == "bounds":
        bounds = [[0, 0], 1] if fault == "no bounds" else [[-1, -2, -3], [1, 2, 3]]
        if fault == "far": bounds = [[1e6 - 1, -2, -3], [1e6 + 1, 2, 3]]
        print(json.dumps({"id": ask["id"], "bounds": bounds}), flush=True)
        continue
    if fault == "far" and ask["camera"]["world_from_eye"][12:15] != [1e6 + 1, 2, 3]:
        print(json.dumps({"id": ask["id"], "error": "another place"}), flush=True)
        continue
    if not (bad and fault == "no file"): exr(ask["camera"], ask["file"])
    print(json.dumps({"id": ask["id"], "done": True}), flush=True)
)";

class ExecSourceTest : public testing::Test {
 protected:
  ExecSourceTest() {
    std::ofstream(path_) << kRenderer;
    std::filesystem::permissions(path_, std::filesystem::perms::owner_all);
    options_.limit_s = 60;
    options_.warn = [this](const std::string& text) { warnings_.push_back(text); };
  }
  Result<std::unique_ptr<ExecSource>> start(const std::string& fault, int at) {
    options_.arguments = {fault, std::to_string(at), folder_ / "mark"};
    return ExecSource::create(path_, options_);
  }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "renderer";
  ExecOptions options_;
  std::vector<std::string> warnings_;
  Camera camera_ = look_at({1, 2, 3}, {0, 0, 0}, {0, 1, 0}, 1.2, 23, 17, 0.5, 40);
};

void expect_the_plane(const DepthImage& picture) {
  const ImageWindow& w = picture.camera.window;
  ASSERT_TRUE(validate(picture).ok());
  for (int y = 0; y < picture.camera.height; ++y)
    for (int x = 0; x < picture.camera.width; ++x) {
      const double u = w.left + (w.right - w.left) * (x + 0.5) / picture.camera.width;
      const double v = w.top + (w.bottom - w.top) * (y + 0.5) / picture.camera.height;
      EXPECT_EQ(picture.depth(x, y), u < -0.5 ? kNoDepth : 4.0f);
      if (u < -0.5) continue;
      // The windows of tiles are rounded anew.
      EXPECT_NEAR(double(picture.color(x, y).r), u, 1e-6);
      EXPECT_NEAR(double(picture.color(x, y).g), v, 1e-6);
    }
}

TEST_F(ExecSourceTest, a_program_renders_whole_pictures_and_tiles) {
  for (const int tile : {0, 5, 17, 100}) {
    options_.tile = tile;
    const auto source = start("none", 0);
    ASSERT_TRUE(source.ok()) << source.error().message();
    EXPECT_EQ((*source)->bounds({}).min, glm::vec3(-1, -2, -3));
    for (int i = 0; i < 2; ++i) {
      const Result<CapturedPicture> captured = (*source)->capture({.camera = camera_});
      ASSERT_TRUE(captured.ok()) << captured.error().message();
      expect_the_plane(captured->picture);
    }
  }
  EXPECT_TRUE(warnings_.empty());
}

TEST_F(ExecSourceTest, programs_see_the_world_and_callers_the_scenes_space) {
  options_.world.origin = {1e6, 0, 0};
  const auto source = start("far", 0);
  ASSERT_TRUE(source.ok()) << source.error().message();
  EXPECT_EQ((*source)->bounds({}).min, glm::vec3(-1, -2, -3));
  EXPECT_EQ((*source)->bounds({}).max, glm::vec3(1, 2, 3));
  EXPECT_EQ((*source)->world().origin, glm::dvec3(1e6, 0, 0));
  const Result<CapturedPicture> captured = (*source)->capture({.camera = camera_});
  ASSERT_TRUE(captured.ok()) << captured.error().message();
  EXPECT_EQ(captured->picture.camera.position(), camera_.position());
}

TEST_F(ExecSourceTest, a_program_that_dies_is_started_again) {
  const auto source = start("dies once", 1);
  ASSERT_TRUE(source.ok()) << source.error().message();
  for (int i = 0; i < 3; ++i) {
    const Result<CapturedPicture> captured = (*source)->capture({.camera = camera_});
    ASSERT_TRUE(captured.ok()) << captured.error().message();
    expect_the_plane(captured->picture);
  }
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_NE(warnings_[0].find("has ended without an answer; it is started again"),
            std::string::npos);
}

TEST_F(ExecSourceTest, faulty_programs_give_one_warning_and_errors_until_they_are_given_up) {
  const std::pair<const char*, const char*> faults[] = {
      {"dies", "has ended"},
      {"rubbish", "answers with something else"},
      {"other id", "answers with something else"},
      {"endless", "a line that does not end"},
      {"no file", "has not made the picture"},
      {"half", "has not made the picture"},
      {"channel", "has no channel Z"},
      {"size", "is not of the size"},
      {"nan", "has a depth that is not a distance"}};
  options_.max_failures = 2;
  for (const auto& [fault, reason] : faults) {
    warnings_.clear();
    const auto source = start(fault, 1);
    ASSERT_TRUE(source.ok()) << fault << source.error().message();
    for (int i = 0; i < 3; ++i) {
      const Result<CapturedPicture> captured = (*source)->capture({.camera = camera_});
      ASSERT_FALSE(captured.ok()) << fault;
      if (i == 0) {
        EXPECT_NE(captured.error().reason.find(reason), std::string::npos)
            << fault << ": " << captured.error().message();
      }
      if (i == 2) {
        EXPECT_EQ(captured.error().reason, "has failed too often in a row and is given up");
      }
    }
    ASSERT_EQ(warnings_.size(), 2u) << fault;
    EXPECT_NE(warnings_[1].find("it is given up"), std::string::npos);
  }
}

TEST_F(ExecSourceTest, a_program_that_never_answers_is_late_and_killed) {
  options_.start_limit_s = 0.05;
  const auto source = start("never", 0);
  ASSERT_FALSE(source.ok());
  EXPECT_EQ(source.error().reason, "has not answered within 0.05 s, asked for its scene's bounds");
  options_.start_limit_s = 60, options_.limit_s = 0.05;
  const auto slow = start("never", 1);
  ASSERT_TRUE(slow.ok()) << slow.error().message();
  EXPECT_EQ((*slow)->capture({.camera = camera_}).error().reason,
            "has not answered within 0.05 s, asked for a picture");
}

TEST_F(ExecSourceTest, without_room_for_a_thread_it_is_not_started) {
  pthread_attr_t before, huge;
  ASSERT_EQ(pthread_getattr_default_np(&before), 0);
  ASSERT_EQ(pthread_getattr_default_np(&huge), 0);
  ASSERT_EQ(pthread_attr_setstacksize(&huge, std::size_t(1) << 47), 0);
  ASSERT_EQ(pthread_setattr_default_np(&huge), 0);
  const auto process = LineProcess::start("/bin/cat", {});
  ASSERT_EQ(pthread_setattr_default_np(&before), 0);
  pthread_attr_destroy(&before);
  pthread_attr_destroy(&huge);
  ASSERT_FALSE(process.ok());
  EXPECT_EQ(process.error().reason.find("cannot be started: "), 0u) << process.error().reason;
}

TEST_F(ExecSourceTest, it_says_each_second_what_it_waits_for_and_when_it_has_it) {
  std::vector<std::pair<std::string, int>> waits;
  options_.waits = [&](std::string_view what, int seconds) { waits.emplace_back(what, seconds); };
  options_.start_limit_s = 2.1;
  EXPECT_FALSE(start("never", 0).ok());
  const std::vector<std::pair<std::string, int>> expected{
      {"bounds", 1}, {"bounds", 2}, {"bounds", 0}};
  EXPECT_EQ(waits, expected);
}

TEST_F(ExecSourceTest, what_a_program_cannot_do_it_says_without_being_restarted) {
  const auto source = start("says no", 1);
  ASSERT_TRUE(source.ok());
  const Result<CapturedPicture> captured = (*source)->capture({.camera = camera_});
  ASSERT_FALSE(captured.ok());
  EXPECT_EQ(captured.error().reason, "says \"out of paint\"");
  EXPECT_TRUE(warnings_.empty());
}

TEST_F(ExecSourceTest, programs_that_cannot_be_used_are_refused_at_the_start) {
  EXPECT_FALSE(start("no bounds", 0).ok());
  EXPECT_FALSE(start("dies", 0).ok());
  path_ = folder_ / "nothing";
  const auto missing = start("none", 0);
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().reason, "cannot be started: No such file or directory");
  EXPECT_TRUE(warnings_.empty());
}

// The answer to the stopped request comes before that to the next one.
TEST_F(ExecSourceTest, a_stopped_capture_fails_at_once_and_the_next_one_gets_its_own_picture) {
  const auto source = start("none", 0);
  ASSERT_TRUE(source.ok());
  std::stop_source stop;
  stop.request_stop();
  const CaptureControl control{stop.get_token(), {}};
  Camera other = camera_;
  other.width = 5;
  for (int i = 0; i < 2; ++i) {
    const Result<CapturedPicture> stopped =
        (*source)->capture({.camera = other, .control = &control});
    ASSERT_FALSE(stopped.ok());
    EXPECT_EQ(stopped.error().reason, kCaptureStopped);
  }
  const Result<CapturedPicture> captured = (*source)->capture({.camera = camera_});
  ASSERT_TRUE(captured.ok()) << captured.error().message();
  expect_the_plane(captured->picture);
  EXPECT_TRUE(warnings_.empty());
}

TEST_F(ExecSourceTest, a_program_that_does_not_read_harms_nobody) {
  options_.limit_s = 20;
  const auto source = start("deaf", 1);
  ASSERT_TRUE(source.ok());
  std::stop_source stop;
  stop.request_stop();
  const CaptureControl control{stop.get_token(), {}};
  // It closes its input, perhaps after a request has been sent: SIGPIPE would end this test.
  for (int i = 0; i < 3; ++i)
    EXPECT_FALSE((*source)->capture({.camera = camera_, .control = &control}).ok());
}

TEST_F(ExecSourceTest, cameras_are_described_by_their_matrices) {
  const auto json = nlohmann::json::parse(camera_json(camera_));
  EXPECT_EQ(json["width"], 23);
  EXPECT_EQ(json["window"][0].get<double>(), camera_.window.left);
  EXPECT_EQ(json["world_from_eye"][12].get<double>(), 1);
  const glm::dmat4 clip = clip_from_eye(camera_);
  EXPECT_EQ(json["clip_from_eye"][5].get<double>(), clip[1][1]);
  EXPECT_EQ(json["projection"], "perspective");
}

TEST_F(ExecSourceTest, shaders_have_names) {
  EXPECT_TRUE(check_shader("raytrace").ok());
  EXPECT_TRUE(check_shader("sdf:gyroid").ok());
  EXPECT_TRUE(check_shader("exec:/bin/cat").ok());
  for (const char* text : {"", "sdf:", "sdf:cube", "exec:", "raytrace2"}) {
    const Result<> unknown = check_shader(text);
    ASSERT_FALSE(unknown.ok()) << text;
    EXPECT_NE(unknown.error().reason.find("sdf:torus"), std::string::npos);
  }
  EXPECT_FALSE(make_shader("raytrace", {}).ok());
  const auto field = make_shader("sdf:torus", {});
  ASSERT_TRUE(field.ok());
  EXPECT_EQ((*field)->name(), "torus");
  options_.arguments = {"none", "0"};
  EXPECT_TRUE(make_shader("exec:" + path_, {.exec = options_}).ok());
}

// The program's depths, a plane, would be those of no box.
TEST_F(ExecSourceTest, a_slow_source_has_the_depths_of_rays_and_a_programs_light) {
  const BuiltinScene boxes = *make_builtin("builtin:stonehenge?triangles=20000");
  const RayScene rays = *RayScene::create(boxes.scene);
  options_.arguments = {"none", "0"};
  const auto source = make_slow_source("exec:" + path_, {.rays = &rays, .exec = options_});
  ASSERT_TRUE(source.ok());
  const Camera camera = look_at({0, 1.7, 12}, {0, 1.7, 0}, {0, 1, 0}, 0.7, 40, 30, 0.1,
                                200);  // within x = -0.5 ... 0.5
  const auto seen = (*source)->capture({.camera = camera, .samples = 1, .with_sky = true});
  ASSERT_TRUE(seen.ok()) << seen.error().message();
  const auto by_rays = RaySource(rays).capture({.camera = camera, .samples = 1});
  EXPECT_EQ(seen->picture.depth.texels().size(), by_rays->picture.depth.texels().size());
  EXPECT_TRUE(std::ranges::equal(seen->picture.depth.texels(), by_rays->picture.depth.texels()));
  // Its blue is the far plane's distance: no light of ours.
  int covered = 0;
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) {
      if (!seen->picture.covered(x, y)) continue;
      ++covered;
      EXPECT_EQ(seen->picture.color(x, y).b, 200 * seen->picture.color(x, y).a);
    }
  EXPECT_GT(covered, 100);
  EXPECT_FALSE(make_slow_source("exec:" + path_, {.exec = options_}).ok());
}

TEST(LineProcess, a_program_gives_way_as_far_as_it_is_told) {
  // nice(1) without arguments says how far.
  const auto nice_of = [](int nice) {
    const std::string arguments[] = {"-c", "read line; nice"};
    auto process = LineProcess::start("sh", arguments, nice);
    EXPECT_TRUE(process.ok());
    EXPECT_TRUE((*process)->send("go"));
    std::string line;
    EXPECT_EQ((*process)->receive(line, LineProcess::Clock::now() + std::chrono::seconds(60), {}),
              LineProcess::Heard::line);
    return std::stoi(line);
  };
  // Nobody gives way farther than 19.
  const int own = nice_of(0);
  EXPECT_EQ(nice_of(7), std::min(19, own + 7));
}

TEST(SoftwareShader, sources_have_names) {
  for (const char* text : {"raster", "rays", "raytrace", "exec:/bin/cat"})
    EXPECT_TRUE(check_source(text).ok()) << text;
  for (const char* text : {"", "sdf:torus", "exec:", "rays2"})
    EXPECT_FALSE(check_source(text).ok()) << text;
  for (const char* text : {"raytrace", "exec:/bin/cat"}) EXPECT_TRUE(is_slow_source(text)) << text;
  for (const char* text : {"raster", "rays", "exec:"}) EXPECT_FALSE(is_slow_source(text)) << text;
}

LineProcess::Heard hear_within_a_minute(LineProcess& process, std::string& line) {
  return process.receive(line, LineProcess::Clock::now() + std::chrono::seconds(60), {});
}

// It dies with our process, and not with the thread that started it.
TEST(LineProcess, a_program_outlives_the_thread_that_starts_it) {
  const std::string arguments[] = {"-c", "read line; echo $line"};
  std::unique_ptr<LineProcess> process;
  std::thread([&] { process = *LineProcess::start("sh", arguments); }).join();
  ASSERT_TRUE(process->send("still there"));
  std::string line;
  ASSERT_EQ(hear_within_a_minute(*process, line), LineProcess::Heard::line);
  EXPECT_EQ(line, "still there");
}

TEST(LineProcess, programs_that_are_listed_are_killed_with_their_children) {
  const std::string arguments[] = {"-c", "sleep 1000 & echo $!; wait"};
  const auto process = LineProcess::start("sh", arguments);
  ASSERT_TRUE(process.ok());
  std::string line;
  ASSERT_EQ(hear_within_a_minute(**process, line), LineProcess::Heard::line);
  kill_started_programs();
  // Once nobody has its output open.
  EXPECT_EQ(hear_within_a_minute(**process, line), LineProcess::Heard::ended);
}

TEST_F(ExecSourceTest, its_pictures_are_kept_until_it_or_a_file_that_it_is_given_changes) {
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", ("/nowhere:" + folder_.path().string() + ':' + path).c_str(), 1);
  const Scene scene;
  ImpostorContentOptions content;
  content.shader = "exec:renderer";
  content.store = folder_ / "kept.db";
  content.exec = options_;
  content.exec.arguments = {"none", "0", folder_ / "mark"};
  std::ofstream(folder_ / "mark") << "one";
  const auto rendered = [&] {
    const auto made = make_impostor_content(scene, 0, content);
    EXPECT_TRUE(made.ok()) << made.error().message();
    if (!made.ok()) return std::uint64_t(99);
    EXPECT_TRUE(made->sources[0]->capture({.camera = camera_, .identifiers = false}).ok());
    return made->rendered();
  };
  EXPECT_EQ(rendered(), 1u);
  EXPECT_EQ(rendered(), 0u);
  std::ofstream(folder_ / "mark") << "two";
  EXPECT_EQ(rendered(), 1u);
  std::ofstream(path_, std::ios::app) << "# Another version.\n";
  EXPECT_EQ(rendered(), 1u);
  content.shader = "exec:no-such-renderer";
  EXPECT_NE(make_impostor_content(scene, 0, content).error().message().find("PATH"),
            std::string::npos);
  ::setenv("PATH", path.c_str(), 1);
}

}  // namespace
}  // namespace rilievo
