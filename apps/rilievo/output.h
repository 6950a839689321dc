// Where results go: files that are there whole or not at all, folders made when they are missing.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <string_view>

#include "rilievo/core/color.h"
#include "rilievo/core/result.h"

namespace rilievo::app {

void add_json_option(CLI::App& command, std::string& file);

// "-" is the standard output.
[[nodiscard]] Result<> write_text(const std::string& file, std::string_view text);

// Makes `folder` and those above it.
[[nodiscard]] Result<> make_folder(const std::filesystem::path& folder);

// Does the name end in .exr?
[[nodiscard]] bool is_picture_file(const std::string& file);

}  // namespace rilievo::app
