#include "apps/rilievo/output.h"

#include <fmt/format.h>

#include <cstdio>
#include <system_error>

#include "rilievo/core/file.h"

namespace rilievo::app {

void add_json_option(CLI::App& command, std::string& file) {
  command.add_option("--json", file, "Write the figures as JSON; - is the standard output")
      ->type_name("FILE");
}

Result<> make_folder(const std::filesystem::path& folder) {
  if (folder.empty()) return Done{};
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Error{folder.string(), "cannot make the folder: " + error.message()};
  return Done{};
}

Result<> write_text(const std::string& file, std::string_view text) {
  if (file == "-") {
    const bool written =
        std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
    if (!written) return Error{"standard output", "cannot be written"};
    return Done{};
  }
  if (Result<> made = make_folder(std::filesystem::path(file).parent_path()); !made) return made;
  return write_file(file, text);
}

bool is_picture_file(const std::string& file) {
  const std::string extension = std::filesystem::path(file).extension().string();
  return extension == ".exr" || extension == ".EXR";
}

}  // namespace rilievo::app
