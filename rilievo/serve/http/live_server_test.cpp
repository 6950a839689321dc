#include "rilievo/serve/http/live_server.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstring>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "rilievo/serve/http/live_client_test_helpers.h"
#include "rilievo/web_walk/page_files.h"

namespace rilievo {
namespace {

LiveMessage message_of(const std::string& text) {
  std::vector<std::byte> bytes(text.size());
  std::memcpy(bytes.data(), text.data(), text.size());
  return std::make_shared<const std::vector<std::byte>>(std::move(bytes));
}

// Says back what it is told. "bad" is a bad message; after "much" there is always more to send.
class Echo : public LiveSession {
 public:
  explicit Echo(std::atomic<int>& pulled) : pulled_(pulled) {}
  Result<> receive(std::span<const std::byte> message, double) override {
    const std::string text(reinterpret_cast<const char*>(message.data()), message.size());
    if (text == "bad") return Error{"message", "is bad"};
    if (text == "much") much_ = true;
    newest_ = message_of(text);
    return Done{};
  }
  LiveMessage next(double) override {
    if (much_) {
      ++pulled_;
      return message_of(std::string(100'000, 'x'));
    }
    return std::exchange(newest_, nullptr);
  }
  LiveMessage last(LiveEnd why) override { return message_of("bye " + std::to_string(int(why))); }

 private:
  std::atomic<int>& pulled_;
  LiveMessage newest_;
  bool much_ = false;
};

// Bytes are allowed a second in advance, from the begin of each second.
constexpr double kRateStep_s = 2;

class Watcher : public LiveObserver {
 public:
  void joined(std::uint64_t, int) override { ++joined_; }
  void left(const LiveClientFigures& client, std::string_view why, int) override {
    const std::lock_guard lock(mutex_);
    left_.emplace_back(why);
    most_bytes_a_second_ = std::max(most_bytes_a_second_,
                                    double(client.received_bytes) / (client.seconds + kRateStep_s));
  }
  [[nodiscard]] int joined_count() const { return joined_; }
  // Of the clients that left.
  [[nodiscard]] double most_bytes_a_second() {
    const std::lock_guard lock(mutex_);
    return most_bytes_a_second_;
  }
  [[nodiscard]] std::vector<std::string> left_because() {
    const std::lock_guard lock(mutex_);
    return left_;
  }

 private:
  std::atomic<int> joined_{0};
  std::mutex mutex_;
  std::vector<std::string> left_;
  double most_bytes_a_second_ = 0;
};

// A server on a thread of its own.
class Served {
 public:
  explicit Served(LiveServerOptions options = {}) : server_(*LiveServer::create(options)) {
    EXPECT_TRUE(server_.listen());
    thread_ = std::thread(
        [this] { server_.run([this] { return std::make_unique<Echo>(pulled); }, watcher); });
  }
  ~Served() { end(); }
  void end() {
    if (!thread_.joinable()) return;
    server_.stop();
    thread_.join();
  }
  [[nodiscard]] LiveTestClient client() const { return LiveTestClient(server_.port()); }
  [[nodiscard]] int port() const { return server_.port(); }

  std::atomic<int> pulled{0};
  Watcher watcher;

 private:
  LiveServer server_;
  std::thread thread_;
};

LiveServerOptions with_limits(const LiveLimits& limits) {
  LiveServerOptions options;
  options.limits = limits;
  return options;
}

// Is somebody who behaves served?
void expect_served(const Served& served) {
  LiveTestClient client = served.client();
  ASSERT_EQ(client.open(), 101);
  ASSERT_TRUE(client.say("hello"));
  const auto heard = client.hear();
  ASSERT_TRUE(heard);
  EXPECT_EQ(heard->payload, "hello");
}

TEST(LiveServer, TheFilesOfThePageAreServed) {
  const Served served;
  LiveTestClient client = served.client();
  for (const PageFile& file : page_files()) {
    client.send("GET /" + std::string(file.name) + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
    const std::string head = client.read_head();
    EXPECT_EQ(LiveTestClient::status_of(head), 200) << head;
    EXPECT_NE(head.find(file.type), head.npos) << head;
    EXPECT_EQ(client.read(file.content.size()), file.content);
  }
  LiveTestClient first = served.client();
  first.send("GET /?token=1 HTTP/1.0\r\nHost: 127.0.0.1\r\n\r\n");
  EXPECT_NE(first.read_all().find(page_files()[0].content), std::string::npos);
  LiveTestClient manifest = served.client();
  manifest.send("GET /walk.json HTTP/1.0\r\nHost: 127.0.0.1\r\n\r\n");
  EXPECT_NE(manifest.read_all().find("\"live\""), std::string::npos);
}

TEST(LiveServer, AHeadHasNoBody) {
  const Served served;
  LiveTestClient client = served.client();
  EXPECT_EQ(client.ask("HEAD /viewer.js"), 200);
  // The next answer follows at once.
  EXPECT_EQ(client.ask("HEAD /"), 200);
}

TEST(LiveServer, OnlyItsFilesAreServedAndOnlyRead) {
  const Served served;
  const std::string host = "Host: localhost\r\n";
  const struct {
    std::string line, headers;
    int status;
  } cases[] = {
      {"GET /etc/passwd", host, 404},
      {"GET /../viewer.js", host, 404},
      {"GET /%2e%2e/%2e%2e/etc/passwd", host, 404},
      {"GET //viewer.js", host, 404},
      {"GET /viewer.js/", host, 404},
      {"GET http://localhost/viewer.js", host, 404},
      {"POST /", host, 405},
      {"PUT /viewer.js", host, 405},
      {"DELETE /", host, 405},
      {"NONSENSE /", host, 405},
      {"GET /live", host, 426},
      {"GET /", "Host: evil.example\r\n", 421},
      {"GET /", "", 421},
      {"GET /", host + host, 400},
      {"GET /", host + "Content-Length: 5\r\n", 413},
      {"GET /", host + "Transfer-Encoding: chunked\r\n", 413},
      {"GET /", host + "X: " + std::string(9000, 'x') + "\r\n", 431},
      {"GET", host, 400},
      {"\x16\x03\x01", host, 400},
  };
  for (const auto& [line, headers, status] : cases)
    EXPECT_EQ(served.client().ask(line, headers), status) << line << headers.substr(0, 80);
}

TEST(LiveServer, NothingOfARequestIsRepeated) {
  const Served served;
  for (const std::string& line : {std::string("GET /QQQQ?QQQQ=QQQQ"), std::string("QQQQ /QQQQ"),
                                  std::string("GET /QQQQ\x01")}) {
    LiveTestClient client = served.client();
    client.send(line +
                " HTTP/1.1\r\nHost: localhost\r\nOrigin: QQQQ\r\nX-Forwarded-Host: QQQQ\r\n"
                "Connection: close\r\nQQQQ: QQQQ\r\n\r\n");
    const std::string answer = client.read_all();
    EXPECT_NE(LiveTestClient::status_of(answer), 0) << line;
    EXPECT_EQ(answer.find("QQQQ"), answer.npos) << answer;
  }
  LiveTestClient client = served.client();
  client.send(
      "GET /live HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
      "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
      "Sec-WebSocket-Protocol: QQQQ\r\nSec-WebSocket-Extensions: permessage-deflate\r\n\r\n");
  const std::string head = client.read_head();
  EXPECT_EQ(LiveTestClient::status_of(head), 101);
  EXPECT_EQ(head.find("QQQQ"), head.npos) << head;
  EXPECT_EQ(head.find("permessage"), head.npos) << head;
}

TEST(LiveServer, AWebSocketOpensForTheRightOriginAndToken) {
  LiveServerOptions options;
  options.access.token = "0123456789abcdef";
  const Served served(options);
  const std::string target = "/live?token=0123456789abcdef";
  EXPECT_EQ(served.client().open(target), 101);
  EXPECT_EQ(served.client().open(target, "Origin: http://localhost\r\n"), 101);
  EXPECT_EQ(served.client().open(target, "Origin: http://evil.example\r\n"), 403);
  EXPECT_EQ(served.client().open(target, "Origin: null\r\n"), 403);
  EXPECT_EQ(served.client().open("/live"), 403);
  EXPECT_EQ(served.client().open("/live?token=0123456789abcdeg"), 403);
  // The page itself tells nothing.
  EXPECT_EQ(served.client().ask("GET /"), 200);
}

TEST(LiveServer, TooManyClientsAreToldSo) {
  LiveLimits limits;
  limits.clients = 2;
  const Served served(with_limits(limits));
  LiveTestClient a = served.client();
  {
    LiveTestClient b = served.client();
    EXPECT_EQ(a.open(), 101);
    EXPECT_EQ(b.open(), 101);
    EXPECT_EQ(served.client().open(), 503);
    // Pages are served.
    EXPECT_EQ(served.client().ask("GET /"), 200);
  }
  // When one has gone there is room; the server learns of it some time after.
  int status = 503;
  for (int i = 0; i < 1000 && status == 503; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    status = served.client().open();
  }
  EXPECT_EQ(status, 101);
}

TEST(LiveServer, ABadMessageEndsItsClientAlone) {
  Served served;
  LiveTestClient good = served.client(), bad = served.client(), text = served.client(),
                 huge = served.client(), unmasked = served.client();
  for (LiveTestClient* client : {&good, &bad, &text, &huge, &unmasked})
    ASSERT_EQ(client->open(), 101);
  ASSERT_TRUE(bad.say("bad"));
  const auto bye = bad.hear();
  ASSERT_TRUE(bye);
  EXPECT_EQ(bye->payload, "bye 1");
  EXPECT_EQ(bad.hear_close(), 1008);
  ASSERT_TRUE(text.send(LiveTestClient::frame("hello", 1)));
  EXPECT_TRUE(text.hear());
  EXPECT_EQ(text.hear_close(), 1008);
  // 4 KiB are allowed, and no byte more.
  ASSERT_TRUE(huge.say(std::string(4096, 'x')));
  EXPECT_EQ(huge.hear()->payload.size(), 4096u);
  ASSERT_TRUE(huge.say(std::string(4097, 'x')));
  EXPECT_EQ(huge.hear_close(), 1009);
  ASSERT_TRUE(unmasked.send(std::string("\x82\x01x", 3)));
  EXPECT_EQ(unmasked.hear_close(), 1002);
  ASSERT_TRUE(good.say("hello"));
  EXPECT_EQ(good.hear()->payload, "hello");
}

TEST(LiveServer, AClientThatNeverReadsIsEndedAndPullsNothingMeanwhile) {
  LiveLimits limits;
  limits.write_s = 0.5;
  Served served(with_limits(limits));
  LiveTestClient client = served.client();
  ASSERT_EQ(client.open(), 101);
  ASSERT_TRUE(client.say("much"));
  for (int i = 0; i < 2000 && served.watcher.left_because().empty(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(served.watcher.left_because(), std::vector<std::string>{"too slow"});
  // The client's kernel takes at most 6 MB (tcp_rmem), this one keeps 64 KiB unsent.
  EXPECT_LT(served.pulled, 70);
  expect_served(served);
}

TEST(LiveServer, AnIdleClientIsEnded) {
  LiveLimits limits;
  limits.idle_s = 0.3;
  Served served(with_limits(limits));
  LiveTestClient client = served.client();
  ASSERT_EQ(client.open(), 101);
  EXPECT_EQ(client.hear()->payload, "bye 2");
  EXPECT_EQ(client.hear_close(), 1013);
}

TEST(LiveServer, ARequestThatNeverEndsIsDropped) {
  LiveLimits limits;
  limits.request_s = 0.3;
  const Served served(with_limits(limits));
  LiveTestClient client = served.client();
  ASSERT_TRUE(client.send("GET / HTTP/1.1\r\nHost: loc"));
  EXPECT_EQ(client.read_all(), "");
}

TEST(LiveServer, WhoFloodsIsReadSlowlyAndDisturbsNobody) {
  LiveLimits limits;
  limits.bytes_a_second = 16 << 10;
  Served served(with_limits(limits));
  std::atomic<bool> ends{false};
  std::thread flood([&] {
    LiveTestClient client = served.client();
    if (client.open() != 101) return;
    const std::string frame = LiveTestClient::frame(std::string(4000, 'x'));
    // Reads its answers, or it would be a client that never reads.
    std::thread reader([&] { client.read_all(); });
    while (!ends && client.send(frame)) {
    }
    client.shut();
    reader.join();
  });
  const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(1500);
  while (std::chrono::steady_clock::now() < until) expect_served(served);
  ends = true;
  served.end();
  flood.join();
  EXPECT_LE(served.watcher.most_bytes_a_second(), double(limits.bytes_a_second));
  EXPECT_GT(served.watcher.most_bytes_a_second(), 0);
}

TEST(LiveServer, AFloodOfPingsEndsItsClient) {
  Served served;
  LiveTestClient client = served.client();
  ASSERT_EQ(client.open(), 101);
  std::string pings;
  for (int i = 0; i < 5000; ++i) pings += LiveTestClient::frame("", 9);
  client.send(pings);
  client.read_all();
  for (int i = 0; i < 1000 && served.watcher.left_because().empty(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(served.watcher.left_because(), std::vector<std::string>{"too many pings"});
}

TEST(LiveServer, DamagedFramesDisturbNobody) {
  Served served;
  LiveTestClient good = served.client();
  ASSERT_EQ(good.open(), 101);
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    LiveTestClient bad = served.client();
    std::string bytes;
    const std::size_t length = random() % 300;
    for (std::size_t b = 0; b < length; ++b) bytes += char(random());
    if (i % 2 == 0) {
      ASSERT_EQ(bad.open(), 101);
    }
    bad.send(bytes);
    bad.close();
    ASSERT_TRUE(good.say(std::to_string(i)));
    const auto heard = good.hear();
    ASSERT_TRUE(heard);
    EXPECT_EQ(heard->payload, std::to_string(i));
  }
}

TEST(LiveServer, ClientsThatComeAndGoLeaveNothing) {
  Served served;
  for (int i = 0; i < 300; ++i) {
    LiveTestClient client = served.client();
    ASSERT_TRUE(client.connected());
    if (i % 3 == 0) continue;
    // Whose places are not free yet are refused.
    const int status = client.open();
    ASSERT_TRUE(status == 101 || status == 503) << status;
    if (status == 101 && i % 3 == 1) client.say("hello");
  }
  for (int i = 0; i < 1000; ++i) {
    if (int(served.watcher.left_because().size()) == served.watcher.joined_count()) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_EQ(int(served.watcher.left_because().size()), served.watcher.joined_count());
  EXPECT_GT(served.watcher.joined_count(), 16);
  expect_served(served);
}

TEST(LiveServer, ItsEndIsSaidToAllClients) {
  Served served;
  LiveTestClient client = served.client(), deaf = served.client(), half = served.client();
  ASSERT_EQ(client.open(), 101);
  ASSERT_EQ(deaf.open(), 101);
  ASSERT_TRUE(deaf.say("much"));
  ASSERT_TRUE(half.send("GET / HT"));
  served.end();
  EXPECT_EQ(client.hear()->payload, "bye 0");
  EXPECT_EQ(client.hear_close(), 1001);
  EXPECT_EQ(served.watcher.left_because().size(), 2u);
}

TEST(LiveServer, FaultsOfTheAddressAreNamed) {
  const Served served;
  LiveServerOptions taken;
  taken.port = served.port();
  const auto other = LiveServer::create(taken);
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().message(),
            "127.0.0.1:" + std::to_string(served.port()) + ": Address already in use");
  LiveServerOptions nowhere;
  nowhere.address = "walk.example";
  EXPECT_EQ(LiveServer::create(nowhere).error().message(),
            "walk.example: is no IPv4 or IPv6 address");
  nowhere.address = "192.0.2.1";
  EXPECT_FALSE(LiveServer::create(nowhere));
}

}  // namespace
}  // namespace rilievo
