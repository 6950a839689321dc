// URIs of glTF 2.0, section 2.8: data: with base64, or a relative path with percent-encoding.
#include <array>

#include "rilievo/scene/gltf/document.h"

namespace rilievo::gltf {
namespace {

std::string decode_base64(std::string_view text) {
  static constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  static const std::array<std::int8_t, 256> value = [] {
    std::array<std::int8_t, 256> v;
    v.fill(-1);
    for (std::size_t i = 0; i < kDigits.size(); ++i) v[std::uint8_t(kDigits[i])] = std::int8_t(i);
    v['-'] = 62, v['_'] = 63;  // the URL-safe alphabet
    return v;
  }();

  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  if (text.size() % 4 == 1) refuse("has a data URI whose base64 is cut short");
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int held = 0;
  for (char c : text) {
    const int digit = value[std::uint8_t(c)];
    if (digit < 0) refuse("has a data URI that is not base64");
    bits = bits << 6 | std::uint32_t(digit);
    held += 6;
    if (held >= 8) {
      held -= 8;
      bytes.push_back(char(bits >> held & 0xFF));
    }
  }
  return bytes;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

// A '%' that starts no escape stands for itself: exporters write such names.
std::string decode_percent(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool escape = text[i] == '%' && i + 2 < text.size() && hex_digit(text[i + 1]) >= 0 &&
                        hex_digit(text[i + 2]) >= 0;
    out.push_back(escape ? char(hex_digit(text[i + 1]) * 16 + hex_digit(text[i + 2])) : text[i]);
    if (escape) i += 2;
  }
  return out;
}

// "http:" and the like; a scheme of one letter would be a drive, which read_neighbor refuses.
bool has_scheme(std::string_view uri) {
  const std::size_t end = uri.find_first_of(":/\\?#");
  return end != std::string_view::npos && end > 1 && uri[end] == ':';
}

}  // namespace

std::string identity_of(const std::string& uri, const LoadContext& context) {
  if (uri.starts_with("data:") || uri.empty() || has_scheme(uri)) return uri;
  return neighbor_path(context, decode_percent(uri)).string();
}

std::string read_uri(const std::string& uri, LoadContext& context) {
  if (uri.starts_with("data:")) {
    const std::size_t comma = uri.find(',');
    if (comma == std::string::npos) refuse("has a data URI without data");
    const std::string_view header = std::string_view(uri).substr(0, comma);
    const std::string_view body = std::string_view(uri).substr(comma + 1);
    context.budget.take(body.size());
    return header.ends_with(";base64") ? decode_base64(body) : decode_percent(body);
  }
  if (uri.empty()) refuse("has an empty URI");
  if (has_scheme(uri))
    refuse("refers to '" + uri.substr(0, 60) + "', which is not a relative path");
  return read_neighbor(context, decode_percent(uri));
}

}  // namespace rilievo::gltf
