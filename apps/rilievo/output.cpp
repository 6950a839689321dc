#include "apps/rilievo/output.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "apps/rilievo/printable.h"
#include "rilievo/core/file.h"

namespace rilievo::app {
namespace {

// Why the standard output lost something; 0: it did not.
int output_error = 0;

}  // namespace

void print_text(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() && !output_error)
    output_error = errno;
}

Result<> flush_output() {
  if (std::fflush(stdout) != 0 && !output_error) output_error = errno;
  // A file over a network may fail when it is closed, and only then.
  const int copy = ::dup(STDOUT_FILENO);
  if (copy >= 0 && ::close(copy) != 0 && !output_error) output_error = errno;
  if (!output_error) return Done{};
  return Error{"standard output", std::string("cannot be written: ") + std::strerror(output_error)};
}

void complain(std::string message) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  // Nobody is left to tell if this fails.
  std::fputs(("rilievo: " + printable(message) + "\n").c_str(), stderr);
}

void add_json_option(CLI::App& command, std::string& file) {
  command.add_option("--json", file, "Write the results as JSON; - is the standard output")
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
    print_text(text);
    return flush_output();
  }
  if (Result<> made = make_folder(std::filesystem::path(file).parent_path()); !made) return made;
  // `file` may be the standard output by another name.
  if (Result<> flushed = flush_output(); !flushed) return flushed;
  return write_file(file, text);
}

nlohmann::json list_of(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

Result<> write_json(const std::string& file, const nlohmann::json& json) {
  return write_text(file,
                    json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

Result<> expect_outputs(std::initializer_list<std::filesystem::path> files) {
  for (const std::filesystem::path& file : files)
    if (!file.empty() && file != "-")
      if (Result<> writable = expect_writable(file); !writable) return writable;
  return Done{};
}

bool is_picture_file(const std::string& file) {
  const std::string extension = std::filesystem::path(file).extension().string();
  return extension == ".exr" || extension == ".EXR";
}

bool holds_pictures(const std::string& file) {
  if (is_picture_file(file)) return true;
  std::error_code none;
  if (!std::filesystem::is_regular_file(file, none)) return false;
  char head[4] = {};
  std::ifstream(file, std::ios::binary).read(head, sizeof head);
  return std::memcmp(head, "\x76\x2F\x31\x01", sizeof head) == 0;
}

}  // namespace rilievo::app
