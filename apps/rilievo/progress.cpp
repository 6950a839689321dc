#include "apps/rilievo/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>
#include <mutex>
#include <nlohmann/json.hpp>
#include <utility>

#include "apps/rilievo/output.h"
#include "apps/rilievo/printable.h"
#include "apps/rilievo/waiting_text.h"

namespace rilievo::app {
namespace {

// A time left that is shorter is not shown.
constexpr double kWorthSaying_s = 5;

// The line of the terminal, of all threads.
struct Line {
  std::mutex mutex;
  std::string progress;  // is shown again when something else no longer is
};

Line& the_line() {
  static Line line;
  return line;
}

// With the mutex held.
void rewrite_line(const std::string& text) {
  std::fputs(("\r" + text + "\033[K").c_str(), stderr);
  std::fflush(stderr);
}

// 0: unknown.
std::size_t terminal_columns() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

}  // namespace

std::string duration_text(double seconds) {
  const auto whole = (long long)(seconds + 0.5);
  if (whole < 100) return fmt::format("{} s", whole);
  const long long minutes = (whole + 30) / 60;
  if (minutes < 100) return fmt::format("{} min", minutes);
  return fmt::format("{} h {} min", minutes / 60, minutes % 60);
}

Progress::Progress(std::string what, bool json)
    : what_(std::move(what)), json_(json), on_terminal_(isatty(STDERR_FILENO) == 1) {}

void Progress::show(int done, int total, int quick) {
  if (!on_terminal_ && !json_) return;
  const Clock::time_point now = Clock::now();
  if (!start_) start_ = now, done_at_start_ = done - quick;
  const double seconds = std::chrono::duration<double>(now - *start_).count();
  const int slow = done - quick - done_at_start_;
  std::optional<double> left;
  if (done >= total)
    left = 0;
  else if (slow > 0)
    left = seconds / slow * (total - done);
  if (json_) {
    nlohmann::json line{{"schema", "rilievo-progress-1"},
                        {"what", what_},
                        {"done", done},
                        {"total", total},
                        {"kept", quick},
                        {"seconds", seconds}};
    line["left_s"] = left ? nlohmann::json(*left) : nlohmann::json();
    std::fputs((line.dump() + "\n").c_str(), stderr);
    return;
  }
  shown_ = true;
  const std::string rest =
      left && *left >= kWorthSaying_s ? ", " + duration_text(*left) + " left" : "";
  Line& line = the_line();
  const std::lock_guard lock(line.mutex);
  line.progress = fmt::format("{} {}/{}{}", what_, done, total, rest);
  rewrite_line(line.progress);
}

std::function<void(std::string_view, int)> waiting_for(const std::string& program) {
  if (isatty(STDERR_FILENO) != 1) return {};
  return [name = printable(program)](std::string_view what, int seconds) {
    Line& line = the_line();
    const std::lock_guard lock(line.mutex);
    rewrite_line(seconds > 0 ? waiting_text(name, what, seconds, terminal_columns())
                             : line.progress);
  };
}

void show_written(const std::string& file, const std::string& what, double seconds, bool json) {
  if (json) {
    const nlohmann::json line{
        {"schema", "rilievo-progress-1"}, {"written", file}, {"what", what}, {"seconds", seconds}};
    std::fputs((line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n").c_str(),
               stderr);
  } else if (isatty(STDERR_FILENO) == 1) {
    complain(fmt::format("{}: {}, after {}", file, what, duration_text(seconds)));
  }
}

void Progress::clear() {
  if (!shown_) return;
  shown_ = false;
  Line& line = the_line();
  const std::lock_guard lock(line.mutex);
  line.progress.clear();
  rewrite_line("");
}

Progress::~Progress() { clear(); }

}  // namespace rilievo::app
