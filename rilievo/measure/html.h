// The parts of a page that needs no other file.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rilievo {

// An encoded picture: the bytes of its file.
struct EncodedPicture {
  std::string mime;  // "image/png", "image/jpeg"
  std::vector<std::uint8_t> bytes;
};

// `text` with & < > " as entities, for use between tags and in quoted attributes.
[[nodiscard]] std::string html_text(std::string_view text);

// The picture as a URI: "data:image/png;base64,..."
[[nodiscard]] std::string data_uri(const EncodedPicture& picture);

// JSON that can stand inside a script element: it contains neither "</" nor "<!".
[[nodiscard]] std::string script_json(std::string_view json);

// `page` with every {{NAME}} replaced by its text. The inserted text is not searched again.
// Requires a text for every {{NAME}} of the page.
[[nodiscard]] std::string fill_page(
    std::string_view page, std::span<const std::pair<std::string_view, std::string>> texts);

// The files of rilievo/measure/pages, compiled into the library.
[[nodiscard]] std::string_view report_page();
[[nodiscard]] std::string_view report_script();
[[nodiscard]] std::string_view bench_page();
[[nodiscard]] std::string_view page_style();

}  // namespace rilievo
