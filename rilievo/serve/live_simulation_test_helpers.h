// A live walk in simulated time: one server, clients that walk, and the network between them.
//
// For tests and measures. The server's work is charged by its processor time, so that a machine
// that does other things disturbs little; the network is a queue with a rate and a delay each way,
// without a buffer: the server is asked for a message when the last one has left. What TCP sends
// again arrives a round trip later, and all that follows with it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "rilievo/serve/live_client.h"
#include "rilievo/serve/live_picture.h"
#include "rilievo/serve/live_world.h"

namespace rilievo {

// The network of a client.
struct SimulatedNetwork {
  double latency_ms = 0, jitter_ms = 0;  // one way: uniform within latency +- jitter, in order
  double mbit_s = 20;                    // from the server
  double loss = 0;                       // the share of packets of 1400 bytes
  double stalls_at = -1, stall_s = 0;    // nothing arrives for so long
};

// A client that walks.
struct SimulatedClient {
  std::function<Camera(double seconds)> camera;  // of its frames
  SimulatedNetwork network;
  double cell = 0;   // that it asks for
  double joins = 0;  // seconds
};

// What a client got.
struct SimulatedTraffic {
  std::vector<double> bytes_a_second;
  double first_view = -1, first_fine = -1;  // seconds after it joined; negative: never
  std::uint64_t pictures = 0, messages = 0;
};

struct SimulatedWalk {
  double seconds = 1;
  double poses_a_second = 30;
  double frames_a_second = 60;
  std::uint32_t seed = 1;
  bool objects = false;  // LiveClient::set_objects of what arrives
};

namespace live_simulation {

inline constexpr double kTick = 0.002;  // seconds
inline constexpr double kPacket = 1400;
// A velocity is taken over so many seconds.
inline constexpr double kStep = 0.02;
inline constexpr double kJump = 400;

struct OnTheWay {
  double at = 0;
  LiveMessage message;
};

struct Walker {
  const SimulatedClient* of = nullptr;
  std::unique_ptr<LiveSession> session;
  LiveClient client;
  std::deque<OnTheWay> up, down;
  double free_at = 0;  // when the last message has left
  std::uint32_t sequence = 0;
  SimulatedTraffic traffic;
};

inline double uniform(std::mt19937& random) { return double(random()) / 4294967296.0; }

// When something that leaves at `now` arrives, after all that left before.
inline double arrival(const SimulatedNetwork& network, double now, std::size_t bytes,
                      const std::deque<OnTheWay>& before, std::mt19937& random) {
  const double spread = 2 * uniform(random) - 1;
  double at = now + 1e-3 * std::max(0.0, network.latency_ms + spread * network.jitter_ms);
  const double whole = std::pow(1 - network.loss, std::ceil(double(bytes) / kPacket));
  if (uniform(random) > whole) at += 2e-3 * network.latency_ms;
  if (network.stalls_at >= 0 && at >= network.stalls_at && at < network.stalls_at + network.stall_s)
    at = network.stalls_at + network.stall_s;
  return before.empty() ? at : std::max(at, before.back().at);
}

inline LivePose pose_of(const Walker& walker, double now) {
  const Camera camera = walker.of->camera(now), before = walker.of->camera(now - kStep);
  LivePose pose;
  pose.client_ms = 1e3 * now;
  pose.eye = camera.position();
  pose.orientation = glm::normalize(glm::quat_cast(glm::dmat3(camera.world_from_eye)));
  pose.vertical_fov = 2 * std::atan(camera.window.top);
  pose.aspect = camera.width / double(camera.height);
  pose.velocity = (camera.position() - before.position()) / kStep;
  // A jump is no motion. Nobody walks so many near distances in a second, whatever the unit is.
  if (glm::length(pose.velocity) > kJump * camera.z_near) pose.velocity = glm::dvec3(0);
  const glm::dquat was = glm::normalize(glm::quat_cast(glm::dmat3(before.world_from_eye)));
  glm::dquat turn = pose.orientation * glm::conjugate(was);
  if (turn.w < 0) turn = -turn;
  const glm::dvec3 axis(turn.x, turn.y, turn.z);
  const double sine = glm::length(axis);
  if (sine > 1e-9 && sine < 0.3) pose.turn_rate = axis / sine * (2 * std::asin(sine) / kStep);
  pose.latency_ms = walker.of->network.latency_ms;
  pose.cell = walker.of->cell;
  return pose;
}

inline void send_up(Walker& walker, const ClientMessage& message, double now,
                    std::mt19937& random) {
  auto bytes = std::make_shared<const std::vector<std::byte>>(encode_message(message));
  const double at = arrival(walker.of->network, now, bytes->size(), walker.up, random);
  walker.up.push_back({at, std::move(bytes)});
}

inline void join(Walker& walker, LiveWorld& world, double now, std::mt19937& random) {
  const Camera camera = walker.of->camera(now);
  walker.session = world.connect();
  walker.free_at = now;
  send_up(walker, LiveHello{camera.width, camera.height, 8192, std::uint64_t(1) << 30}, now,
          random);
}

// What the server writes, if its last message has left.
inline void pull(Walker& walker, double now, std::mt19937& random) {
  while (walker.free_at <= now) {
    LiveMessage message = walker.session->next(now);
    if (!message) return;
    const double seconds = 8e-6 * double(message->size()) / walker.of->network.mbit_s;
    walker.free_at = std::max(walker.free_at, now - kTick) + seconds;
    const double at =
        arrival(walker.of->network, walker.free_at, message->size(), walker.down, random);
    walker.down.push_back({at, std::move(message)});
  }
}

inline Result<> take(Walker& walker, const LiveWorld& world, const SimulatedWalk& walk, double now,
                     std::mt19937& random) {
  SimulatedTraffic& traffic = walker.traffic;
  while (!walker.down.empty() && walker.down.front().at <= now) {
    const LiveMessage message = std::move(walker.down.front().message);
    walker.down.pop_front();
    if (Result<> read = walker.client.receive(*message); !read) return read;
    const std::size_t second = std::size_t(now - walker.of->joins);
    if (traffic.bytes_a_second.size() <= second) traffic.bytes_a_second.resize(second + 1);
    traffic.bytes_a_second[second] += double(message->size());
    ++traffic.messages;
    const LivePictureHead* newest = walker.client.newest();
    if (!newest) continue;
    ++traffic.pictures;
    if (traffic.first_view < 0) traffic.first_view = now - walker.of->joins;
    if (traffic.first_fine < 0 && newest->fine) traffic.first_fine = now - walker.of->joins;
    if (walk.objects)
      if (const auto picture = world.picture(newest->id))
        walker.client.set_objects(newest->id, picture->objects);
  }
  std::vector<std::uint64_t> dropped = walker.client.take_dropped();
  if (!dropped.empty()) send_up(walker, LiveDropped{std::move(dropped)}, now, random);
  return Done{};
}

}  // namespace live_simulation

// Walks. `frame` is called for each frame of each client that shows anything, in order of time.
// Fails where a client cannot read what it got, or the server what a client sent.
[[nodiscard]] inline Result<std::vector<SimulatedTraffic>> simulate_walk(
    LiveWorld& world, std::span<const SimulatedClient> clients, const SimulatedWalk& walk,
    const std::function<void(int client, double now, const LiveClient&)>& frame) {
  using namespace live_simulation;
  std::mt19937 random(walk.seed);
  std::vector<Walker> walkers(clients.size());
  for (std::size_t i = 0; i < clients.size(); ++i) walkers[i].of = &clients[i];
  double busy_until = 0;
  std::int64_t poses = 0, frames = 0;
  const std::int64_t ticks = std::int64_t(walk.seconds / kTick);
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    const double now = kTick * double(tick);
    const bool poses_now = now * walk.poses_a_second >= double(poses);
    const bool draws_now = now * walk.frames_a_second >= double(frames);
    poses += poses_now, frames += draws_now;
    for (Walker& walker : walkers) {
      if (now < walker.of->joins) continue;
      if (!walker.session) join(walker, world, now, random);
      if (poses_now) {
        LivePose pose = pose_of(walker, now);
        pose.sequence = ++walker.sequence;
        send_up(walker, pose, now, random);
      }
      while (!walker.up.empty() && walker.up.front().at <= now) {
        if (Result<> read = walker.session->receive(*walker.up.front().message, now); !read)
          return read.error();
        walker.up.pop_front();
      }
    }
    while (busy_until <= now) {
      const double took = world.work(now);
      if (!(took > 0)) break;
      busy_until = std::max(busy_until, now - kTick) + took;
    }
    for (std::size_t i = 0; i < walkers.size(); ++i) {
      Walker& walker = walkers[i];
      if (!walker.session) continue;
      pull(walker, now, random);
      if (Result<> taken = take(walker, world, walk, now, random); !taken) return taken.error();
      if (draws_now && walker.client.any()) frame(int(i), now, walker.client);
    }
  }
  std::vector<SimulatedTraffic> traffic;
  for (Walker& walker : walkers) traffic.push_back(std::move(walker.traffic));
  return {std::move(traffic)};
}

}  // namespace rilievo
