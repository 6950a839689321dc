// How does one talk with a program, line by line, without ever waiting for longer than one wants?
//
// The program gets lines on its standard input and answers on its standard output; its standard
// error is ours. It is started without a shell, leads a process group of its own, and is killed
// with that group when the object goes, and by core/started_programs.h; the kernel kills it,
// without that group, when our process ends in any other way. No signal reaches the caller when the
// program dies. One thread at a time. Internal to capture.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "rilievo/core/descriptor.h"
#include "rilievo/core/result.h"
#include "rilievo/core/started_programs.h"

namespace rilievo {

// A running program.
class LineProcess {
 public:
  using Clock = std::chrono::steady_clock;
  // How waiting for a line ended.
  enum class Heard { line, stopped, late, ended, too_long };

  // `program`: a path, or a name without a slash, which is searched in PATH. `nice`: how far it
  // gives way to the caller, 0 to 19; its own children and threads do, too.
  [[nodiscard]] static Result<std::unique_ptr<LineProcess>> start(
      const std::string& program, std::span<const std::string> arguments, int nice = 0);
  ~LineProcess();
  LineProcess(const LineProcess&) = delete;
  LineProcess& operator=(const LineProcess&) = delete;

  // Sends a line; false if the program has ended or does not read.
  [[nodiscard]] bool send(std::string_view line);
  // Waits for a line (at most a megabyte), without its end.
  [[nodiscard]] Heard receive(std::string& line, Clock::time_point until,
                              const std::stop_token& stop);

  [[nodiscard]] pid_t id() const { return id_; }

 private:
  LineProcess(pid_t id, int to, int from, std::jthread parent)
      : parent_(std::move(parent)), id_(id), to_(to), from_(from), listed_(std::in_place, id) {}

  std::jthread parent_;  // forked the program, and lives as long as this
  pid_t id_;
  Descriptor to_, from_;
  std::optional<StartedProgram> listed_;
  std::string heard_;
};

}  // namespace rilievo
