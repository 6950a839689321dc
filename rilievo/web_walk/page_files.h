// The files of the page that shows a walk in a browser, as the program carries them.
#pragma once

#include <span>
#include <string_view>

namespace rilievo {

// A file of the page.
struct PageFile {
  std::string_view name;     // without a folder: "viewer.js"
  std::string_view type;     // its media type
  std::string_view content;  // UTF-8
};

// All of them, index.html first. They name each other, and "walk.json", by relative paths.
[[nodiscard]] std::span<const PageFile> page_files();

}  // namespace rilievo
