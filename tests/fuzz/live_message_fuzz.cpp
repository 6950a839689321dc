// Any bytes as a message of a live walk, from a client and from a server: read within the limits of
// docs/protocol.md, or a refusal with a reason. tools/fuzz runs it.
#include <cmath>
#include <cstdlib>

#include "rilievo/serve/message.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rilievo;
  const std::span<const std::byte> bytes(reinterpret_cast<const std::byte*>(data), size);
  if (const Result<ClientMessage> read = parse_client_message(bytes)) {
    if (const auto* pose = std::get_if<LivePose>(&*read))
      if (!std::isfinite(pose->eye.x) || !(std::abs(glm::length(pose->orientation) - 1) < 1e-9))
        std::abort();
    // What was read can be written, and read again.
    if (!parse_client_message(encode_message(*read))) std::abort();
  } else if (read.error().reason.empty()) {
    std::abort();
  }
  if (const Result<ServerMessage> read = parse_server_message(bytes)) {
    if (const auto* picture = std::get_if<LivePicture>(&*read))
      if (picture->depths.size() + picture->colors.size() + 160 != size) std::abort();
  } else if (read.error().reason.empty()) {
    std::abort();
  }
  return 0;
}
