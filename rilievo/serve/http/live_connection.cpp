#include "rilievo/serve/http/live_connection.h"

#include <netinet/in.h>
#include <netinet/tcp.h>

#include <algorithm>
#include <array>
#include <boost/asio/post.hpp>
#include <boost/beast/core/basic_stream.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/rate_policy.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <optional>
#include <string_view>

#include "rilievo/web_walk/page_files.h"

namespace rilievo {
namespace {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Tcp = net::ip::tcp;
using Failed = boost::system::error_code;

// Of a request's line and headers.
constexpr std::size_t kHeaderBytes = 8 << 10;
// What may lie unsent in the kernel: at 5 Mbit/s a tenth of a second.
constexpr int kUnsentBytes = 64 << 10;

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

std::chrono::milliseconds duration_of(double seconds) {
  return std::chrono::milliseconds((long long)(1000 * seconds));
}

class Connection final : public LiveConnection, public std::enable_shared_from_this<Connection> {
 public:
  using Server = LiveServer::State;

  Connection(Tcp::socket socket, std::uint64_t number, Server& server)
      : server_(server), socket_(std::move(socket)), buffer_(kHeaderBytes) {
    figures_.client = number;
  }
  ~Connection() override {
    if (counted_) --server_.clients;
    if (session_) {
      session_.reset();
      figures_.seconds = server_.now() - joined_at_;
      server_.observer->left(figures_, why_, server_.clients);
    }
    server_.alive.erase(figures_.client);
    server_.accept();
    if (server_.ending && server_.alive.empty()) server_.io.stop();
  }

  void read_request() override {
    stream().expires_after(duration_of(server_.options.limits.request_s));
    request_.emplace();
    request_->header_limit(kHeaderBytes);
    request_->body_limit(0);
    http::async_read_header(stream(), buffer_, *request_,
                            [self = shared_from_this()](Failed failed, std::size_t) {
                              failed ? self->answer_damaged(failed) : self->answer();
                            });
  }

  void pump() override {
    if (!session_ || writing_ || closing_) return;
    message_ = session_->next(server_.now());
    if (!message_) return;
    write([self = shared_from_this()] { self->pump(); });
  }

  void tick(double stalled) override {
    if (!session_) return;
    const double now = server_.now();
    heard_at_ += stalled;
    writing_since_ += stalled;
    const LiveLimits& limits = server_.options.limits;
    pings_ = 0;
    if (closing_) {
      if (now > closing_since_ + kFarewell_s) drop();
      return;
    }
    if (writing_ && now > writing_since_ + limits.write_s) {
      why_ = "too slow";
      return drop();
    }
    if (now > heard_at_ + limits.idle_s) return end(LiveEnd::idle);
    pump();
  }

  void end(LiveEnd why) override {
    if (closing_) return;
    if (!session_) return drop();
    static constexpr std::array kWhy{"server ends", "bad message", "idle", "too slow"};
    static constexpr std::array kCodes{
        websocket::close_code::going_away, websocket::close_code::policy_error,
        websocket::close_code::try_again_later, websocket::close_code::try_again_later};
    why_ = kWhy[std::size_t(why)];
    closing_ = true;
    closing_since_ = server_.now();
    close_code_ = kCodes[std::size_t(why)];
    farewell_ = session_->last(why);
    if (!writing_) say_farewell();
  }

  void drop() override {
    closing_ = true;
    stream().close();
  }

 private:
  using Stream = beast::basic_stream<Tcp, net::any_io_executor, beast::simple_rate_policy>;

  Stream& stream() { return socket_.next_layer(); }

  // An answer of one's own words.
  void refuse(http::status status, std::string_view reason = {}) {
    if (!reason.empty()) server_.observer->refused(reason);
    respond(status, "text/plain; charset=utf-8",
            std::string(view(http::obsolete_reason(status))) +
                (reason.empty() ? "\n" : ": " + std::string(reason) + "\n"));
  }

  void respond(http::status status, std::string_view type, std::string body) {
    // Whoever is refused sends what is not read: the connection ends with the answer.
    const bool keeps = status == http::status::ok && request_->is_header_done() &&
                       request_->get().keep_alive() && !server_.ending;
    response_ = {};
    response_.version(11);
    response_.result(status);
    response_.set(http::field::content_type, beast::string_view(type.data(), type.size()));
    response_.set(http::field::cache_control, "no-cache");
    response_.set("X-Content-Type-Options", "nosniff");
    // The page's address may hold the token.
    response_.set("Referrer-Policy", "no-referrer");
    if (status == http::status::method_not_allowed) response_.set(http::field::allow, "GET, HEAD");
    if (status == http::status::service_unavailable) response_.set(http::field::retry_after, "5");
    response_.keep_alive(keeps);
    response_.content_length(body.size());
    if (!request_->is_header_done() || request_->get().method() != http::verb::head)
      response_.body() = std::move(body);
    stream().expires_after(duration_of(server_.options.limits.write_s));
    http::async_write(stream(), response_,
                      [self = shared_from_this(), keeps](Failed failed, std::size_t) {
                        if (failed) return;
                        if (keeps) return self->read_request();
                        Failed ignored;
                        self->stream().socket().shutdown(Tcp::socket::shutdown_send, ignored);
                        self->read_rest();
                      });
  }

  // Closed while something is unread, a connection is reset, and the answer may be lost.
  void read_rest() {
    stream().expires_after(std::chrono::seconds(1));
    rest_left_ -= std::min(rest_left_, rest_.size());
    if (rest_left_ == 0) return;
    stream().async_read_some(net::buffer(rest_),
                             [self = shared_from_this()](Failed failed, std::size_t) {
                               if (!failed) self->read_rest();
                             });
  }

  // A request that could not be read.
  void answer_damaged(Failed failed) {
    if (failed == http::error::header_limit || failed == http::error::buffer_overflow)
      return refuse(http::status::request_header_fields_too_large);
    if (failed == http::error::body_limit) return refuse(http::status::payload_too_large);
    const bool ended =
        failed == http::error::end_of_stream || failed == http::error::partial_message;
    if (!ended && failed.category() == http::make_error_code(http::error::bad_method).category())
      refuse(http::status::bad_request);
  }

  void answer() {
    const auto& request = request_->get();
    const AccessRules& access = server_.options.access;
    if (request.count(http::field::host) > 1 || request.count(http::field::origin) > 1)
      return refuse(http::status::bad_request);
    const std::string_view host = view(request[http::field::host]);
    if (!answers_to(access, host))
      return refuse(http::status::misdirected_request, "this host name is not served");
    if (request.method() != http::verb::get && request.method() != http::verb::head)
      return refuse(http::status::method_not_allowed);
    if (request_->chunked() || request_->content_length().value_or(0) > 0)
      return refuse(http::status::payload_too_large);
    const std::string_view target = view(request.target());
    const std::string_view path = target_path(target);
    if (path == "/live") return answer_live(host, target);
    if (path == "/walk.json")
      return respond(http::status::ok, "application/json", server_.manifest);
    for (const PageFile& file : page_files())
      if (path.substr(std::min<std::size_t>(path.size(), 1)) == file.name ||
          (path == "/" && file.name == "index.html"))
        return respond(http::status::ok, file.type, std::string(file.content));
    refuse(http::status::not_found);
  }

  void answer_live(std::string_view host, std::string_view target) {
    const auto& request = request_->get();
    if (!websocket::is_upgrade(request)) return refuse(http::status::upgrade_required);
    AccessRequest asked{.host = host, .origin = {}, .target = target};
    if (request.count(http::field::origin) > 0) asked.origin = view(request[http::field::origin]);
    if (!may_connect(server_.options.access, asked))
      return refuse(http::status::forbidden, "wrong origin or token");
    if (server_.clients >= server_.options.limits.clients)
      return refuse(http::status::service_unavailable, "too many clients");
    if (server_.ending) return refuse(http::status::service_unavailable);
    open_socket();
  }

  void open_socket() {
    const LiveLimits& limits = server_.options.limits;
    stream().expires_never();
    stream().rate_policy().read_limit(limits.bytes_a_second);
    Failed ignored;
    stream().socket().set_option(Tcp::no_delay(true), ignored);
    using Unsent = net::detail::socket_option::integer<IPPROTO_TCP, TCP_NOTSENT_LOWAT>;
    stream().socket().set_option(Unsent(kUnsentBytes), ignored);
    websocket::stream_base::timeout times{};
    times.handshake_timeout = duration_of(limits.request_s);
    times.idle_timeout = websocket::stream_base::none();
    times.keep_alive_pings = false;
    socket_.set_option(times);
    socket_.read_message_max(limits.message_bytes);
    socket_.auto_fragment(false);
    socket_.binary(true);
    socket_.control_callback([this](websocket::frame_type kind, beast::string_view) {
      if (kind != websocket::frame_type::ping) return;
      if (++pings_ * 4 > server_.options.limits.pings_a_second && !closing_) {
        why_ = "too many pings";
        closing_ = true;
        net::post(server_.io, [self = shared_from_this()] { self->drop(); });
      }
    });
    counted_ = true;
    ++server_.clients;
    socket_.async_accept(request_->get(), [self = shared_from_this()](Failed failed) {
      // Beast has said why.
      if (!failed) self->join();
    });
  }

  void join() {
    request_.reset();
    buffer_ = beast::flat_buffer(server_.options.limits.message_bytes);
    heard_at_ = joined_at_ = server_.now();
    session_ = (*server_.join)();
    server_.observer->joined(figures_.client, server_.clients);
    if (server_.ending) return end(LiveEnd::server_ends);
    pump();
    read_message();
  }

  void read_message() {
    socket_.async_read(buffer_, [self = shared_from_this()](Failed failed, std::size_t) {
      self->take_message(failed);
    });
  }

  void take_message(Failed failed) {
    if (closing_) return;
    if (failed) {
      // Beast has closed what broke the protocol of WebSockets.
      if (failed == websocket::error::message_too_big ||
          failed == websocket::error::buffer_overflow)
        why_ = "message too long";
      else if (failed != websocket::error::closed && failed != net::error::eof &&
               failed != net::error::connection_reset)
        why_ = "broken connection";
      return drop();
    }
    heard_at_ = server_.now();
    const auto bytes = buffer_.cdata();
    for (LiveClientFigures* figures : {&figures_, &server_.all}) {
      ++figures->received_messages;
      figures->received_bytes += bytes.size();
    }
    const bool good =
        socket_.got_binary() &&
        session_->receive({static_cast<const std::byte*>(bytes.data()), bytes.size()}, heard_at_);
    if (!good) return end(LiveEnd::bad_message);
    buffer_.consume(buffer_.size());
    pump();
    read_message();
  }

  template <class Then>
  void write(Then then) {
    writing_ = true;
    writing_since_ = server_.now();
    socket_.async_write(
        net::buffer(message_->data(), message_->size()),
        [self = shared_from_this(), then = std::move(then)](Failed failed, std::size_t bytes) {
          self->writing_ = false;
          if (failed) return self->drop();
          for (LiveClientFigures* figures : {&self->figures_, &self->server_.all}) {
            ++figures->sent_messages;
            figures->sent_bytes += bytes;
          }
          self->message_ = nullptr;
          if (self->closing_) return self->say_farewell();
          then();
        });
  }

  // A last message if there is one, and the WebSocket's close.
  void say_farewell() {
    if (farewell_) {
      message_ = std::exchange(farewell_, nullptr);
      return write([] {});
    }
    if (std::exchange(said_, true)) return;
    socket_.async_close({close_code_}, [self = shared_from_this()](Failed) { self->drop(); });
  }

  Server& server_;
  websocket::stream<Stream, false> socket_;
  beast::flat_buffer buffer_;
  // Of requests.
  std::optional<http::request_parser<http::empty_body>> request_;
  http::response<http::string_body> response_;
  std::array<char, 4096> rest_;
  std::size_t rest_left_ = 64 << 10;
  // Of a client.
  std::unique_ptr<LiveSession> session_;
  LiveMessage message_, farewell_;
  websocket::close_code close_code_ = websocket::close_code::normal;
  bool counted_ = false, writing_ = false, closing_ = false, said_ = false;
  double joined_at_ = 0, heard_at_ = 0, writing_since_ = 0, closing_since_ = 0;
  int pings_ = 0;
  LiveClientFigures figures_;
  std::string_view why_ = "closed";
};

}  // namespace

std::shared_ptr<LiveConnection> make_live_connection(Tcp::socket socket, std::uint64_t number,
                                                     LiveServer::State& server) {
  return std::make_shared<Connection>(std::move(socket), number, server);
}

}  // namespace rilievo
