#include "rilievo/serve/http/access.h"

#include <algorithm>
#include <charconv>
#include <cstddef>

namespace rilievo {
namespace {

// Longer names are no names of hosts.
constexpr std::size_t kMostNameLength = 253;

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

// What an address may hold as it is (RFC 3986: unreserved).
bool is_plain(char c) {
  return is_letter(c) || is_digit(c) || c == '-' || c == '.' || c == '_' || c == '~';
}

// A page's origin, taken apart.
struct Origin {
  HostName host;  // with the scheme's port where none is named
  int scheme_port = 0;
};

std::optional<Origin> parse_origin(std::string_view text) {
  Origin origin;
  if (text.starts_with("http://"))
    origin.scheme_port = 80, text.remove_prefix(7);
  else if (text.starts_with("https://"))
    origin.scheme_port = 443, text.remove_prefix(8);
  else
    return {};
  const std::optional<HostName> host = parse_host(text);
  if (!host) return {};
  origin.host = *host;
  if (origin.host.port == 0) origin.host.port = origin.scheme_port;
  return origin;
}

// A host that names no port has that of the page's scheme: a proxy may have added TLS.
bool same_place(const Origin& origin, const HostName& host) {
  return origin.host.name == host.name &&
         origin.host.port == (host.port == 0 ? origin.scheme_port : host.port);
}

bool same_origin(const Origin& a, const Origin& b) {
  return a.scheme_port == b.scheme_port && same_place(a, b.host);
}

}  // namespace

std::optional<HostName> parse_host(std::string_view text) {
  std::string_view name = text, port;
  if (text.starts_with('[')) {
    const std::size_t end = text.find(']');
    if (end == text.npos) return {};
    name = text.substr(0, end + 1);
    port = text.substr(end + 1);
    for (const char c : name.substr(1, name.size() - 2))
      if (!is_digit(c) && !is_letter(c) && c != ':' && c != '.') return {};
    if (name.size() < 4) return {};
  } else {
    const std::size_t colon = std::min(text.find(':'), text.size());
    name = text.substr(0, colon);
    port = text.substr(colon);
    if (!std::ranges::all_of(name, is_plain)) return {};
  }
  if (name.empty() || name.size() > kMostNameLength) return {};
  HostName host;
  for (const char c : name) host.name += c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
  if (port.empty()) return host;
  port.remove_prefix(1);
  const auto [end, failed] = std::from_chars(port.data(), port.data() + port.size(), host.port);
  if (failed != std::errc() || end != port.data() + port.size()) return {};
  if (host.port < 1 || host.port > 65535) return {};
  return host;
}

bool is_this_machine(std::string_view name) {
  if (name == "localhost" || name == "[::1]") return true;
  if (!name.starts_with("127.")) return false;
  // A host of a name server may begin so, too: four numbers.
  int numbers = 1;
  std::size_t digits = 0;
  for (const char c : name) {
    if (c == '.') {
      if (digits == 0) return false;
      ++numbers, digits = 0;
    } else if (!is_digit(c) || ++digits > 3) {
      return false;
    }
  }
  return numbers == 4 && digits > 0;
}

std::string_view target_path(std::string_view target) { return target.substr(0, target.find('?')); }

std::string_view target_value(std::string_view target, std::string_view name) {
  const std::size_t query = target.find('?');
  if (query == target.npos) return {};
  std::string_view rest = target.substr(query + 1);
  while (!rest.empty()) {
    const std::string_view pair = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(pair.size() + 1, rest.size()));
    if (pair.size() > name.size() && pair.starts_with(name) && pair[name.size()] == '=')
      return pair.substr(name.size() + 1);
  }
  return {};
}

bool same_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned differs = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    differs |= unsigned(static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]));
  return differs == 0;
}

Result<> check_token(std::string_view token) {
  if (token.size() < std::size_t(kLeastTokenLength))
    return Error{"--token", "is too short: 16 characters or more, or the word random"};
  if (token.size() > 256) return Error{"--token", "is longer than 256 characters"};
  if (!std::ranges::all_of(token, is_plain))
    return Error{"--token", "may hold letters, digits and -._~ alone"};
  return Done{};
}

Result<> check_origin(std::string_view origin) {
  if (parse_origin(origin)) return Done{};
  return Error{"--origin",
               "'" + std::string(origin) + "' is no origin such as https://walk.example"};
}

bool answers_to(const AccessRules& rules, std::string_view host) {
  const std::optional<HostName> named = parse_host(host);
  if (!named) return false;
  if (!rules.token.empty() || is_this_machine(named->name)) return true;
  return std::ranges::any_of(rules.origins, [&](const std::string& text) {
    const std::optional<Origin> origin = parse_origin(text);
    return origin && same_place(*origin, *named);
  });
}

bool may_connect(const AccessRules& rules, const AccessRequest& request) {
  if (!rules.token.empty() && !same_secret(target_value(request.target, "token"), rules.token))
    return false;
  if (!request.origin) return true;
  const std::optional<Origin> origin = parse_origin(*request.origin);
  const std::optional<HostName> host = parse_host(request.host);
  if (!origin || !host) return false;
  // Under a name that is told, TLS counts, too: a page of the same name without it may be
  // anybody's.
  bool told_name = false;
  for (const std::string& text : rules.origins) {
    const std::optional<Origin> told = parse_origin(text);
    if (!told) continue;
    if (same_origin(*origin, *told)) return true;
    told_name = told_name || same_place(*told, *host);
  }
  return !told_name && same_place(*origin, *host);
}

}  // namespace rilievo
