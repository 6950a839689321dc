// rilievo serve SCENE: pictures of a scene that stays here, for browsers that walk through it.

#include <fmt/format.h>
#include <sys/random.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/rilievo/bake_source.h"
#include "apps/rilievo/checks.h"
#include "apps/rilievo/command.h"
#include "apps/rilievo/output.h"
#include "apps/rilievo/progress.h"
#include "rilievo/capture/shaders/software_shader.h"
#include "rilievo/core/camera_path.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/scene/scene.h"
#include "rilievo/serve/http/live_server.h"
#include "rilievo/serve/live_world.h"
#include "rilievo/serve/standing_place.h"

namespace rilievo::app {
namespace {

struct ServeCommand {
  std::string scene, path_file;
  SourceOptions source{.source = "raster", .waited_for = true};
  FileLimits limits;
  LiveServerOptions server{.port = 8080, .ends_by_signal = true};
  int kept_mb = 256;
  bool json = false;
};

// 128 bits.
Result<std::string> random_token() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != ssize_t(bytes.size()))
    return Error{"--token", "random numbers cannot be had from this system"};
  std::string text;
  for (const unsigned char byte : bytes) text += fmt::format("{:02x}", byte);
  return text;
}

// Only this machine reaches the server by that address.
bool is_of_this_machine(const std::string& address) {
  return is_this_machine(address) || address == "::1";
}

Result<> check_access(ServeCommand& options) {
  AccessRules& access = options.server.access;
  if (access.token == "random") {
    Result<std::string> token = random_token();
    if (!token) return token.error();
    access.token = *token;
  }
  if (!access.token.empty())
    if (Result<> good = check_token(access.token); !good) return good;
  for (const std::string& origin : access.origins)
    if (Result<> good = check_origin(origin); !good) return good;
  if (access.token.empty() && !is_of_this_machine(options.server.address))
    return Error{"--listen", options.server.address +
                                 " is open to other machines: it needs --token, 16 characters or "
                                 "more, or the word random"};
  return Done{};
}

// What happens, for people or for programs.
class ServeObserver : public LiveObserver {
 public:
  explicit ServeObserver(bool json) : json_(json), on_terminal_(isatty(STDERR_FILENO) == 1) {}
  ~ServeObserver() override { clear(); }

  // A line of JSON on the standard output.
  void say(const char* event, nlohmann::json facts) {
    if (!json_) return;
    facts["schema"] = "rilievo-serve-1";
    facts["event"] = event;
    print_text(facts.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
    std::fflush(stdout);
  }
  void joined(std::uint64_t client, int clients) override {
    say("joined", {{"client", client}, {"clients", clients}});
  }
  void left(const LiveClientFigures& client, std::string_view why, int clients) override {
    nlohmann::json facts = json_of(client);
    facts["client"] = client.client;
    facts["why"] = why;
    facts["clients"] = clients;
    say("left", std::move(facts));
    if (clients == 0) clear();
  }
  void refused(std::string_view why) override { say("refused", {{"why", why}}); }
  // Whose figures are said, too; must outlive what is observed.
  void watch(const LiveWorld& world) { world_ = &world; }
  void figures(int clients, const LiveClientFigures& all) override {
    nlohmann::json facts = json_of(all);
    facts["clients"] = clients;
    if (world_) {
      const LiveWorldStats stats = world_->stats();
      facts["made"] = stats.made;
      facts["shared"] = stats.shared;
      facts["replaced"] = stats.replaced;
      facts["failed"] = stats.failed;
      facts["kept_bytes"] = stats.kept_bytes;
      facts["busy_s"] = stats.busy_s;
    }
    say("figures", std::move(facts));
    if (json_ || !on_terminal_) return;
    shown_ = true;
    const double bits = 8.0 * double(all.sent_bytes - sent_bytes_);
    std::fputs(
        fmt::format("\r{} {}, {:.1f} Mbit/s\033[K", clients, clients == 1 ? "client" : "clients",
                    1e-6 * bits / std::max(all.seconds - seconds_, 0.1))
            .c_str(),
        stderr);
    std::fflush(stderr);
    sent_bytes_ = all.sent_bytes;
    seconds_ = all.seconds;
  }

 private:
  static nlohmann::json json_of(const LiveClientFigures& figures) {
    return {{"seconds", figures.seconds},
            {"sent_bytes", figures.sent_bytes},
            {"sent_messages", figures.sent_messages},
            {"received_bytes", figures.received_bytes},
            {"received_messages", figures.received_messages}};
  }
  void clear() {
    if (shown_) std::fputs("\r\033[K", stderr);
    shown_ = false;
  }

  const LiveWorld* world_ = nullptr;
  bool json_, on_terminal_, shown_ = false;
  std::uint64_t sent_bytes_ = 0;
  double seconds_ = 0;
};

// What is walked through, from where a path begins, or a built-in scene's walk, or where somebody
// can stand, or before the whole of a scene.
LiveScene live_scene(const std::string& name, BakeSource& source,
                     const std::optional<CameraPath>& path) {
  LiveScene scene;
  scene.name = name;
  scene.bounds = source.source().bounds({});
  const auto begin_of = [](const CameraPath& walk) {
    return camera_at(walk, walk.keys.front().time, 1280, 720);
  };
  CaptureSource& surfaces = source.geometry() ? *source.geometry() : source.source();
  if (path)
    scene.start = begin_of(relative_to(source.source().world().origin, *path));
  else if (source.walk())
    scene.start = begin_of(*source.walk());
  else if (const std::optional<Camera> place = standing_place(surfaces))
    scene.start = *place;
  else
    scene.start = begin_of(walk_path(scene.bounds, 2));
  // Slow sources draw none.
  static const Sky kSky;
  if (CaptureSource* geometry = source.geometry())
    scene.sky = geometry->scene() ? &geometry->scene()->sky : &kSky;
  else if (source.light())
    scene.sky = &kSky;
  return scene;
}

// What to type into a browser.
std::string page_address(const LiveServer& server, const ServeCommand& options) {
  std::string address = server.url();
  const std::string& listen = options.server.address;
  std::array<char, 256> host{};
  if ((listen == "0.0.0.0" || listen == "::") && ::gethostname(host.data(), host.size() - 1) == 0)
    address = fmt::format("http://{}:{}/", host.data(), server.port());
  const std::string& token = options.server.access.token;
  return token.empty() ? address : address + "?token=" + token;
}

Result<> run_serve(ServeCommand options) {
  if (Result<> good = check_source(options.source.source); !good) return good;
  if (options.source.samples > 0 && !is_slow_source(options.source.source))
    return Error{"--samples", "is for --source raytrace and exec:PROGRAM"};
  if (Result<> good = check_access(options); !good) return good;
  options.server.name = options.scene.starts_with("builtin:")
                            ? options.scene.substr(8, options.scene.find('?') - 8)
                            : std::filesystem::path(options.scene).stem().string();
  std::optional<CameraPath> path;
  if (!options.path_file.empty()) {
    Result<CameraPath> loaded = load_path(options.path_file);
    if (!loaded) return loaded.error();
    path = std::move(*loaded);
  }
  // A port that is taken is told before the scene is read.
  Result<LiveServer> server = LiveServer::create(options.server);
  if (!server) return server.error();
  ServeObserver observer(options.json);
  observer.say("loading", {{"scene", options.scene}});
  const Stopwatch watch;
  Result<BakeSource> source = [&] {
    Progress progress("loading");
    progress.show(0, 1);
    return BakeSource::open(options.scene, options.limits, options.source);
  }();
  if (!source) return source.error();

  LiveWorldOptions world_options;
  world_options.kept_bytes = std::size_t(options.kept_mb) << 20;
  CaptureSource* quick = source->geometry();
  LiveWorld world(source->source(), quick ? *quick : source->source(),
                  live_scene(options.server.name, *source, path), world_options);
  if (Result<> good = server->listen(); !good) return good;
  const std::string address = page_address(*server, options);
  observer.say("listening",
               {{"address", address}, {"port", server->port()}, {"seconds", 1e-3 * watch.ms()}});
  complain(fmt::format("open {} in a browser; Ctrl-C ends", address));
  observer.watch(world);
  world.start([&] { return server->now(); }, [&] { server->wake(); });
  server->run([&] { return world.connect(); }, observer);
  observer.say("ended", nlohmann::json::object());
  return Done{};
}

}  // namespace

Command serve_command(CLI::App& app) {
  auto options = std::make_shared<ServeCommand>();
  CLI::App* command = app.add_subcommand(
      "serve", "Serve a scene that stays on this machine to browsers that walk through it");
  command
      ->add_option(
          "SCENE", options->scene,
          fmt::format("{}; or, with --source exec:PROGRAM, what the program opens", kSceneHelp))
      ->required();
  command
      ->add_option(
          "--source", options->source.source,
          "Who makes the pictures: raster (default), rays, raytrace (path-traced light) or "
          "exec:PROGRAM")
      ->type_name("SOURCE");
  command
      ->add_option("--samples", options->source.samples,
                   "Samples a texel of raytrace or a program (default: the source's)")
      ->check(in_range(1, 65536))
      ->type_name("N");
  command
      ->add_option("--path", options->path_file,
                   "A camera path, JSON (rilievo-path-1): the walk begins where it does, with its "
                   "clipping planes (default: where somebody can stand, or before the scene)")
      ->type_name("FILE");
  LiveServerOptions& server = options->server;
  command->add_option("--port", server.port, "The port (default 8080); 0: any that is free")
      ->check(in_range(0, 65535))
      ->type_name("PORT");
  command
      ->add_option("--listen", server.address,
                   "The address to listen on (default 127.0.0.1, this machine alone; 0.0.0.0 or :: "
                   "for all); others than this machine's need --token")
      ->type_name("ADDRESS");
  command
      ->add_option("--token", server.access.token,
                   "What the page's address must hold (?token=...): 16 or more letters, digits and "
                   "-._~; or random: made anew and printed. Also from RILIEVO_TOKEN")
      ->envname("RILIEVO_TOKEN")
      ->type_name("TOKEN");
  command
      ->add_option("--origin", server.access.origins,
                   "Besides the server's own, an address that a proxy serves it under "
                   "(https://walk.example)")
      ->type_name("ORIGIN");
  command->add_option("--clients", server.limits.clients, "The most clients at once (default 16)")
      ->check(in_range(1, 1000))
      ->type_name("N");
  command
      ->add_option("--memory-mb", options->kept_mb,
                   "Limit on the memory for pictures that clients share (default 256)")
      ->check(in_range(1, 65536))
      ->type_name("MB");
  command->add_flag("--json", options->json,
                    "Write what happens as lines of JSON (rilievo-serve-1) to the standard output");
  add_file_limits(*command, options->limits);
  command->footer(
      "Example: rilievo serve builtin:stonehenge\n"
      "         rilievo serve town.glb --listen 0.0.0.0 --token random");
  return {command, [options](const std::string&) { return run_serve(*options); }};
}

}  // namespace rilievo::app
