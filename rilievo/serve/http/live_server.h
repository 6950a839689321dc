// Serves a walk that is drawn while it is watched: the page by HTTP, and a WebSocket a client.
//
// The server pulls (session.h): a client's next message is asked for only when the last one has
// been written, so that newer pictures replace older ones by themselves, and one message is all
// that waits. What a kernel would keep unsent besides is limited, too.
//
// What a stranger can do is bounded: only the page's files and the socket are served, and read only
// (GET and HEAD); nothing of a request is repeated in an answer; headers, messages, bytes a second,
// pings, connections and times are limited (LiveLimits). access.h says who may connect.
//
// One thread, that of run(), does all of this; it calls the sessions, which must not wait.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "rilievo/core/result.h"
#include "rilievo/serve/http/access.h"
#include "rilievo/serve/session.h"

namespace rilievo {

// What a client may cost.
struct LiveLimits {
  int clients = 16;                        // that are connected by WebSocket
  int other_connections = 64;              // besides; more wait until others end
  std::size_t message_bytes = 4096;        // of one message from a client
  std::size_t bytes_a_second = 128 << 10;  // from a connection
  int pings_a_second = 100;
  double request_s = 10;  // to send a request, and to take its answer
  double idle_s = 60;     // without a message from the client
  double write_s = 30;    // to take one message
};

// What the server is told.
struct LiveServerOptions {
  std::string address = "127.0.0.1";  // IPv4, IPv6 or localhost
  int port = 0;                       // 0: any that is free
  AccessRules access;
  LiveLimits limits;
  std::string name = "live";    // of the walk, in its manifest
  bool ends_by_signal = false;  // SIGINT and SIGTERM end run(); a second one, the program
};

// What a client did, and what all did, in numbers: nothing that a client said.
struct LiveClientFigures {
  std::uint64_t client = 0;  // the number of its connection
  double seconds = 0;
  std::uint64_t sent_bytes = 0, sent_messages = 0, received_bytes = 0, received_messages = 0;
};

// Is told what happens; called on the thread of run().
class LiveObserver {
 public:
  virtual ~LiveObserver() = default;
  virtual void joined(std::uint64_t /*client*/, int /*clients*/) {}
  virtual void left(const LiveClientFigures& /*client*/, std::string_view /*why*/,
                    int /*clients*/) {}
  virtual void refused(std::string_view /*why*/) {}
  // Once a second, if anybody is connected.
  virtual void figures(int /*clients*/, const LiveClientFigures& /*all so far*/) {}
};

class LiveServer {
 public:
  // Takes the port, so that a fault of the address is found before a scene is read; nobody can
  // connect yet.
  [[nodiscard]] static Result<LiveServer> create(const LiveServerOptions& options);
  LiveServer(LiveServer&&) noexcept;
  LiveServer& operator=(LiveServer&&) noexcept;
  ~LiveServer();

  // The port that was taken.
  [[nodiscard]] int port() const;
  // "http://127.0.0.1:8080/". Of an address that means all of them: of this machine's.
  [[nodiscard]] std::string url() const;

  // Clients can connect from now on: they wait for run(). Fails if another program has taken the
  // port meanwhile.
  [[nodiscard]] Result<> listen();
  // Serves until stop() or a signal; then says so to all clients, and returns. `join` makes the
  // session of a client.
  void run(const std::function<std::unique_ptr<LiveSession>()>& join, LiveObserver& observer);

  // The time that sessions are told: seconds since create(). Any thread.
  [[nodiscard]] double now() const;
  // Any thread, before or during run(): sessions may have something to send.
  void wake();
  // Any thread: ends run().
  void stop();

  struct State;  // of its connections, too (live_connection.h)

 private:
  explicit LiveServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace rilievo
