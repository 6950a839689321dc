// A live walk in simulated time: one server, clients that walk, and the network between them.
//
// For tests and measures. The server's work is charged by its processor time, so that a machine
// that does other things disturbs little; the network is a queue with a rate and a delay each way,
// without a buffer: the server is asked for a message when the last one has left. What TCP sends
// again arrives a round trip later, and all that follows with it.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "rilievo/serve/live_client.h"
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

// Walks. `frame` is called for each frame of each client that shows anything, in order of time.
// Fails where a client cannot read what it got, or the server what a client sent.
[[nodiscard]] Result<std::vector<SimulatedTraffic>> simulate_walk(
    LiveWorld& world, std::span<const SimulatedClient> clients, const SimulatedWalk& walk,
    const std::function<void(int client, double now, const LiveClient&)>& frame);

}  // namespace rilievo
