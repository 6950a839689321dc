// What a connection of a live walk is to the server's core: messages come in, messages are pulled
// out.
//
// The sockets (serve/http) know no more than this of what is sent, and the core knows no sockets.
// Time is passed in, so that tests and benches simulate it: seconds since the server began. All
// calls come from one thread and must not wait for pictures.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "rilievo/core/result.h"

namespace rilievo {

// A message, whole. Clients may share one.
using LiveMessage = std::shared_ptr<const std::vector<std::byte>>;

// Why the server ends a client, as a last message may say it.
enum class LiveEnd { server_ends, bad_message, idle, too_slow };

// What a client gets; made when it connects, destroyed when it has gone.
class LiveSession {
 public:
  virtual ~LiveSession() = default;
  // A message of the client. An error ends this client.
  [[nodiscard]] virtual Result<> receive(std::span<const std::byte> message, double now) = 0;
  // What is to be sent next; null: nothing yet. Asked again after each message that was received or
  // written, when the core says that something is ready, and a few times a second.
  [[nodiscard]] virtual LiveMessage next(double now) = 0;
  // The last message; null: none.
  [[nodiscard]] virtual LiveMessage last(LiveEnd why) = 0;
};

}  // namespace rilievo
