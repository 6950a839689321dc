// What pages that hold everything in one file are put together from.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rilievo {

// A picture as it lies in a file.
struct EncodedPicture {
  std::string mime;  // "image/png", "image/jpeg"
  std::vector<std::uint8_t> bytes;
};

// `text` with & < > " as entities: safe between tags and in quoted attributes.
[[nodiscard]] std::string html_text(std::string_view text);

// "data:image/png;base64,..."
[[nodiscard]] std::string data_uri(const EncodedPicture& picture);

// JSON that can stand inside a <script> element: no "</" and no "<!" in it.
[[nodiscard]] std::string script_json(std::string_view json);

// `page` with every {{NAME}} replaced by its text, which itself is not searched. Requires that
// every {{NAME}} of the page is given.
[[nodiscard]] std::string fill_page(
    std::string_view page, std::span<const std::pair<std::string_view, std::string>> texts);

// The files of rilievo/measure/pages, as they were at build time.
[[nodiscard]] std::string_view report_page();
[[nodiscard]] std::string_view report_script();
[[nodiscard]] std::string_view bench_page();
[[nodiscard]] std::string_view page_style();

}  // namespace rilievo
