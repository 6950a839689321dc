#include "rilievo/serve/http/live_server.h"

#include <boost/asio/post.hpp>
#include <csignal>
#include <nlohmann/json.hpp>
#include <utility>

#include "rilievo/serve/http/live_connection.h"

namespace rilievo {
namespace {

namespace net = boost::asio;
using Tcp = net::ip::tcp;
using Failed = boost::system::error_code;

// How often times are looked at.
constexpr auto kTick = std::chrono::milliseconds(250);
// A longer time between two looks is the server's own: it was stopped, or the machine is
// overloaded.
constexpr double kStall_s = 2;

std::string place_text(const Tcp::endpoint& place) {
  const std::string address = place.address().to_string();
  const std::string port = std::to_string(place.port());
  return place.address().is_v6() ? "[" + address + "]:" + port : address + ":" + port;
}

}  // namespace

void LiveServer::State::accept() {
  const std::size_t most = std::size_t(options.limits.clients + options.limits.other_connections);
  if (accepting || ending || alive.size() >= most) return;
  accepting = true;
  acceptor.async_accept([this](Failed failed, Tcp::socket socket) {
    accepting = false;
    if (ending) return;
    if (failed) {
      // No file numbers are left, or the client is gone already.
      pause.expires_after(kTick);
      return pause.async_wait([this](Failed) { accept(); });
    }
    const std::uint64_t number = ++connections;
    const auto connection = make_live_connection(std::move(socket), number, *this);
    alive[number] = connection;
    connection->read_request();
    accept();
  });
}

// Whatever ends meanwhile changes the map.
std::vector<std::shared_ptr<LiveConnection>> LiveServer::State::held() const {
  std::vector<std::shared_ptr<LiveConnection>> held;
  for (const auto& [number, connection] : alive)
    if (auto one = connection.lock()) held.push_back(std::move(one));
  return held;
}

void LiveServer::State::tick() {
  timer.expires_after(kTick);
  timer.async_wait([this](Failed failed) {
    if (failed) return;
    const double time = now();
    const double gap = time - std::exchange(ticked_at, time);
    const double stalled = gap > kStall_s ? gap : 0;
    for (const auto& connection : held()) connection->tick(stalled);
    if (now() >= figures_at + 1) {
      figures_at = all.seconds = now();
      if (clients > 0) observer->figures(clients, all);
    }
    if (ending && now() > ends_at) return io.stop();
    tick();
  });
}

void LiveServer::State::end() {
  if (std::exchange(ending, true)) return;
  Failed ignored;
  signals.clear(ignored);
  acceptor.close(ignored);
  ends_at = now() + kFarewell_s;
  if (alive.empty()) return io.stop();
  for (const auto& connection : held()) connection->end(LiveEnd::server_ends);
}

LiveServer::LiveServer(std::unique_ptr<State> state) : state_(std::move(state)) {}
LiveServer::LiveServer(LiveServer&&) noexcept = default;
LiveServer& LiveServer::operator=(LiveServer&&) noexcept = default;
LiveServer::~LiveServer() = default;

Result<LiveServer> LiveServer::create(const LiveServerOptions& options) {
  auto state = std::make_unique<State>(options);
  Failed failed;
  const std::string text = options.address == "localhost" ? "127.0.0.1" : options.address;
  const net::ip::address address = net::ip::make_address(text, failed);
  if (failed) return Error{options.address, "is no IPv4 or IPv6 address"};
  const Tcp::endpoint place(address, static_cast<unsigned short>(options.port));
  Tcp::acceptor& acceptor = state->acceptor;
  acceptor.open(place.protocol(), failed);
  if (!failed) acceptor.set_option(net::socket_base::reuse_address(true), failed);
  if (!failed) acceptor.bind(place, failed);
  if (failed) return Error{place_text(place), failed.message()};
  state->manifest =
      nlohmann::json{
          {"schema", "rilievo-walk-1"},
          {"name", options.name},
          {"live", {{"socket", "live"}, {"protocol", 1}, {"token", !options.access.token.empty()}}}}
          .dump(1, ' ', false, nlohmann::json::error_handler_t::replace) +
      "\n";
  return LiveServer(std::move(state));
}

int LiveServer::port() const { return state_->acceptor.local_endpoint().port(); }

std::string LiveServer::url() const {
  Tcp::endpoint place = state_->acceptor.local_endpoint();
  if (place.address().is_unspecified()) {
    if (place.address().is_v4())
      place.address(net::ip::address_v4::loopback());
    else
      place.address(net::ip::address_v6::loopback());
  }
  return "http://" + place_text(place) + "/";
}

Result<> LiveServer::listen() {
  Failed failed;
  state_->acceptor.listen(net::socket_base::max_listen_connections, failed);
  if (failed) return Error{place_text(state_->acceptor.local_endpoint()), failed.message()};
  return Done{};
}

void LiveServer::run(const std::function<std::unique_ptr<LiveSession>()>& join,
                     LiveObserver& observer) {
  State& state = *state_;
  state.join = &join;
  state.observer = &observer;
  if (state.options.ends_by_signal) {
    Failed ignored;
    state.signals.add(SIGINT, ignored);
    state.signals.add(SIGTERM, ignored);
    state.signals.async_wait([&state](Failed failed, int) {
      if (!failed) state.end();
    });
  }
  state.ticked_at = state.now();
  state.accept();
  state.tick();
  state.io.run();
  // Those that did not close in time. Every connection ends before this returns.
  for (const auto& connection : state.held()) connection->drop();
  state.timer.cancel();
  state.pause.cancel();
  state.io.restart();
  state.io.run();
}

double LiveServer::now() const { return state_->now(); }

void LiveServer::wake() {
  State& state = *state_;
  if (state.woken.exchange(true)) return;
  net::post(state.io, [&state] {
    state.woken = false;
    for (const auto& connection : state.held()) connection->pump();
  });
}

void LiveServer::stop() {
  State& state = *state_;
  net::post(state.io, [&state] { state.end(); });
}

}  // namespace rilievo
