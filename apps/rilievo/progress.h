// How is progress shown? In one line that is rewritten, on a terminal only, silent in a pipe; or,
// for programs, as lines of JSON.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace rilievo::app {

// "40 s", "3 min", "2 h 10 min".
[[nodiscard]] std::string duration_text(double seconds);

class Progress {
 public:
  // `json`: lines of JSON (rilievo-progress-1) on the error output, wherever it leads.
  explicit Progress(std::string what, bool json = false);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // `quick`: of those done, so many took no time. The time left follows from the others.
  void show(int done, int total, int quick = 0);
  // Before something else is printed.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  std::string what_;
  bool json_;
  bool on_terminal_ = false, shown_ = false;
  std::optional<Clock::time_point> start_;
  int done_at_start_ = 0;
};

// Shows in such a line, on a terminal, that a program is waited for; null elsewhere. Any thread may
// call it.
[[nodiscard]] std::function<void(std::string_view what, int seconds)> waiting_for(
    const std::string& program);

// That a file was written before the end: a line on a terminal, or of JSON.
void show_written(const std::string& file, const std::string& what, double seconds, bool json);

}  // namespace rilievo::app
