// Where do results go? To the standard output, whose errors are reported at the end, and to files
// that are complete or absent, in folders that are created if they are missing.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <glm/glm.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "rilievo/core/color.h"
#include "rilievo/core/result.h"

namespace rilievo::app {

// To the standard output. Never throws; flush_output() says whether all of it has arrived.
void print_text(std::string_view text);
template <class... Values>
void print(fmt::format_string<Values...> format, Values&&... values) {
  print_text(fmt::format(format, std::forward<Values>(values)...));
}
[[nodiscard]] Result<> flush_output();

// "rilievo: MESSAGE" on the error output, in one line; what a terminal would obey is spelt out.
void complain(std::string message);

void add_json_option(CLI::App& command, std::string& file);

// The three numbers.
[[nodiscard]] nlohmann::json list_of(const glm::dvec3& v);

// "-" is the standard output.
[[nodiscard]] Result<> write_text(const std::string& file, std::string_view text);
// Text that is not UTF-8 (a file's name) is written with U+FFFD for each byte that is not.
[[nodiscard]] Result<> write_json(const std::string& file, const nlohmann::json& json);

// Before the work: could these be written after it? Empty names and "-" always can.
[[nodiscard]] Result<> expect_outputs(std::initializer_list<std::filesystem::path> files);

// Makes `folder` and those above it.
[[nodiscard]] Result<> make_folder(const std::filesystem::path& folder);

// Does the name end in .exr?
[[nodiscard]] bool is_picture_file(const std::string& file);
// Does it, or does the file begin as OpenEXR?
[[nodiscard]] bool holds_pictures(const std::string& file);

}  // namespace rilievo::app
