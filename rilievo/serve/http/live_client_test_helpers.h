// A client of live walks for tests: a plain socket, which can say anything, well or badly.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace rilievo {

class LiveTestClient {
 public:
  explicit LiveTestClient(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_port = htons(static_cast<std::uint16_t>(port));
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    // A server that hangs fails the test, and does not hang it.
    const timeval patience{20, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    ::setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    connected_ = ::connect(socket_, reinterpret_cast<const sockaddr*>(&place), sizeof place) == 0;
  }
  LiveTestClient(LiveTestClient&& other) noexcept
      : socket_(std::exchange(other.socket_, -1)),
        connected_(other.connected_),
        unread_(std::move(other.unread_)) {}
  ~LiveTestClient() { close(); }

  [[nodiscard]] bool connected() const { return connected_; }
  void close() {
    if (socket_ >= 0) ::close(std::exchange(socket_, -1));
  }

  // Another thread's reads and writes end.
  void shut() { ::shutdown(socket_, SHUT_RDWR); }

  // Whether all of it could be sent.
  bool send(const std::string& bytes) {
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t sent = ::send(socket_, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
      if (sent <= 0) return false;
      done += std::size_t(sent);
    }
    return true;
  }

  // `count` bytes; fewer: the server has closed.
  std::string read(std::size_t count) {
    while (unread_.size() < count && more()) {
    }
    const std::string bytes = unread_.substr(0, count);
    unread_.erase(0, count);
    return bytes;
  }
  // Everything until the server closes.
  std::string read_all() {
    while (more()) {
    }
    return std::exchange(unread_, {});
  }
  // A line and headers, with the blank line.
  std::string read_head() {
    while (unread_.find("\r\n\r\n") == unread_.npos && more()) {
    }
    return read(std::min(unread_.size(), unread_.find("\r\n\r\n") + 4));
  }

  // The status of an answer to a request; 0: none came.
  int ask(const std::string& line, const std::string& headers = "Host: localhost\r\n") {
    send(line + " HTTP/1.1\r\n" + headers + "\r\n");
    return status_of(read_head());
  }
  static int status_of(const std::string& head) {
    return head.starts_with("HTTP/1.1 ") ? std::stoi(head.substr(9, 3)) : 0;
  }

  // Opens the WebSocket; the status, 101 if it is open.
  int open(const std::string& target = "/live", const std::string& more_headers = {}) {
    return ask("GET " + target,
               "Host: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
               "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n" +
                   more_headers);
  }

  // A frame as a client sends it, masked with zeros.
  static std::string frame(const std::string& payload, int opcode = 2, bool ends = true) {
    std::string bytes;
    bytes += char(opcode | (ends ? 0x80 : 0));
    if (payload.size() < 126) {
      bytes += char(0x80 | int(payload.size()));
    } else {
      bytes += char(0x80 | 126);
      bytes += char(payload.size() >> 8 & 255);
      bytes += char(payload.size() & 255);
    }
    return bytes + std::string(4, '\0') + payload;
  }
  bool say(const std::string& payload) { return send(frame(payload)); }

  struct Heard {
    int opcode = 0;
    std::string payload;
  };
  // The next frame; nothing: the server has closed.
  std::optional<Heard> hear() {
    const std::string head = read(2);
    if (head.size() < 2) return {};
    std::uint64_t length = std::uint64_t(head[1]) & 127;
    if (length >= 126) {
      const std::size_t bytes = length == 126 ? 2 : 8;
      length = 0;
      for (const char c : read(bytes)) length = length << 8 | static_cast<unsigned char>(c);
    }
    return Heard{head[0] & 15, read(length)};
  }
  // The code of the close that comes next; 0: another frame or none came.
  int hear_close() {
    const std::optional<Heard> heard = hear();
    if (!heard || heard->opcode != 8 || heard->payload.size() < 2) return 0;
    return int(static_cast<unsigned char>(heard->payload[0])) << 8 |
           int(static_cast<unsigned char>(heard->payload[1]));
  }

 private:
  bool more() {
    char bytes[16384];
    const ssize_t got = ::recv(socket_, bytes, sizeof bytes, 0);
    if (got <= 0) return false;
    unread_.append(bytes, std::size_t(got));
    return true;
  }

  int socket_;
  bool connected_ = false;
  std::string unread_;
};

}  // namespace rilievo
