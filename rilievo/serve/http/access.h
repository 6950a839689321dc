// Who may open the WebSocket of a live walk, and under which name the server answers.
//
// Two attacks come from pages of others in a browser of someone who may connect:
// - Such a page opens the socket itself. A browser sends the page's origin with the handshake, and
//   pages cannot change it: an origin other than the server's own is refused.
// - Such a page's host name is made to lead to this machine (DNS rebinding), so that origin and
// host
//   agree. Without a token only names of this machine are answered, and those that are told. With
//   a token any name is: the page of another does not know the token.
//
// A program that is no browser sends no origin. It is let in: on this machine it could read the
// scene anyway, and from elsewhere it needs the token.
//
// No header that a proxy adds (X-Forwarded-Host) is read: any client can send it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rilievo/core/result.h"

namespace rilievo {

// The shortest token that is accepted: 96 bits where characters are random.
inline constexpr int kLeastTokenLength = 16;

// Who may connect.
struct AccessRules {
  std::string token;                 // empty: none is asked for
  std::vector<std::string> origins;  // of pages besides the server's own: "https://walk.example"
};

// What a request says. Views of the request's own text.
struct AccessRequest {
  std::string_view host;                   // the header's value
  std::optional<std::string_view> origin;  // none: no header
  std::string_view target;                 // "/live?token=..."
};

// The name and the port of "name:port", lower case; port 0: none is named.
struct HostName {
  std::string name;
  int port = 0;
};

// Reads a Host header, or what follows "//" in an origin. Nothing: it is damaged.
[[nodiscard]] std::optional<HostName> parse_host(std::string_view text);

// Is it localhost, 127.*.*.* or [::1]?
[[nodiscard]] bool is_this_machine(std::string_view name);

// The target without what follows '?'.
[[nodiscard]] std::string_view target_path(std::string_view target);

// The value of `name` in what follows '?'; empty: there is none. It is not decoded.
[[nodiscard]] std::string_view target_value(std::string_view target, std::string_view name);

// Compares in a time that depends on the lengths alone.
[[nodiscard]] bool same_secret(std::string_view a, std::string_view b);

// Fails if the text could not be part of an address as it is, or is easily guessed by its length.
[[nodiscard]] Result<> check_token(std::string_view token);

// Fails if the text is no origin: "http://NAME" or "https://NAME", a port or none.
[[nodiscard]] Result<> check_origin(std::string_view origin);

// Does the server answer under this name?
[[nodiscard]] bool answers_to(const AccessRules& rules, std::string_view host);

// May it open the socket? Requires that answers_to() holds.
[[nodiscard]] bool may_connect(const AccessRules& rules, const AccessRequest& request);

}  // namespace rilievo
