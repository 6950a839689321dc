// What the connections of a LiveServer share, and one of them.
#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "rilievo/serve/http/live_server.h"

namespace rilievo {

// How long clients have to close when the server ends, or one of them is ended.
inline constexpr double kFarewell_s = 1;

// One connection: requests of files one after the other, or a WebSocket. The operation that is
// under way keeps it.
class LiveConnection {
 public:
  virtual ~LiveConnection() = default;
  virtual void read_request() = 0;
  // Sends what there is to send, if nothing is being sent.
  virtual void pump() = 0;
  // Looks at times. `stalled`: for so many seconds the server itself did not run; what clients did
  // then is not read yet.
  virtual void tick(double stalled) = 0;
  // Says why, and closes.
  virtual void end(LiveEnd why) = 0;
  virtual void drop() = 0;
};

[[nodiscard]] std::shared_ptr<LiveConnection> make_live_connection(
    boost::asio::ip::tcp::socket socket, std::uint64_t number, LiveServer::State& server);

struct LiveServer::State {
  explicit State(LiveServerOptions wanted) : options(std::move(wanted)) {}

  void accept();
  void tick();
  void end();
  [[nodiscard]] double now() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  }
  [[nodiscard]] std::vector<std::shared_ptr<LiveConnection>> held() const;

  LiveServerOptions options;
  std::string manifest;
  boost::asio::io_context io{1};
  boost::asio::ip::tcp::acceptor acceptor{io};
  boost::asio::signal_set signals{io};
  boost::asio::steady_timer timer{io}, pause{io};
  std::chrono::steady_clock::time_point began = std::chrono::steady_clock::now();
  std::atomic<bool> woken{false};
  bool accepting = false, ending = false;
  double ends_at = 0, figures_at = 0, ticked_at = 0;
  std::uint64_t connections = 0;
  std::map<std::uint64_t, std::weak_ptr<LiveConnection>> alive;
  int clients = 0;
  LiveClientFigures all;
  const std::function<std::unique_ptr<LiveSession>()>* join = nullptr;
  LiveObserver* observer = nullptr;
};

}  // namespace rilievo
