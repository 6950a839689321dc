#include "rilievo/measure/html.h"

#include <algorithm>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

// Each included file is one raw string literal, made by cmake/embed.cmake.
constexpr std::string_view kReportPage =
#include "rilievo/measure/pages/report.html.inc"
    ;
constexpr std::string_view kReportScript =
#include "rilievo/measure/pages/report.js.inc"
    ;
constexpr std::string_view kBenchPage =
#include "rilievo/measure/pages/bench.html.inc"
    ;
constexpr std::string_view kPageStyle =
#include "rilievo/measure/pages/style.css.inc"
    ;

}  // namespace

std::string html_text(std::string_view text) {
  std::string out;
  for (char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string data_uri(const EncodedPicture& picture) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out = "data:" + picture.mime + ";base64,";
  const std::vector<std::uint8_t>& in = picture.bytes;
  out.reserve(out.size() + (in.size() + 2) / 3 * 4);
  // Three bytes are four digits of six bits; a last group of one or two bytes is padded.
  for (std::size_t i = 0; i < in.size(); i += 3) {
    const std::size_t bytes = std::min<std::size_t>(3, in.size() - i);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < bytes ? in[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out += k <= bytes ? kDigits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

std::string script_json(std::string_view json) {
  std::string out;
  out.reserve(json.size());
  // "<" occurs in JSON only inside strings, where it may be escaped.
  for (char c : json) {
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  }
  return out;
}

std::string fill_page(std::string_view page,
                      std::span<const std::pair<std::string_view, std::string>> texts) {
  std::string out;
  for (;;) {
    const std::size_t open = page.find("{{");
    out += page.substr(0, open);
    if (open == std::string_view::npos) return out;
    const std::size_t close = page.find("}}", open);
    RILIEVO_EXPECTS(close != std::string_view::npos);
    const std::string_view name = page.substr(open + 2, close - open - 2);
    const auto text =
        std::find_if(texts.begin(), texts.end(), [&](const auto& t) { return t.first == name; });
    RILIEVO_EXPECTS(text != texts.end());
    out += text->second;
    page.remove_prefix(close + 2);
  }
}

std::string_view report_page() { return kReportPage; }
std::string_view report_script() { return kReportScript; }
std::string_view bench_page() { return kBenchPage; }
std::string_view page_style() { return kPageStyle; }

}  // namespace rilievo
