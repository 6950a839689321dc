#include "apps/rilievo/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <utility>

#include "apps/rilievo/output.h"
#include "apps/rilievo/printable.h"

namespace rilievo::app {
namespace {

// A time left that is shorter is not shown.
constexpr double kWorthSaying_s = 5;

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
  std::fputs(fmt::format("\r{} {}/{}{}\033[K", what_, done, total, rest).c_str(), stderr);
  std::fflush(stderr);
}

std::function<void(std::string_view, int)> waiting_for(const std::string& program) {
  if (isatty(STDERR_FILENO) != 1) return {};
  return [name = printable(program)](std::string_view what, int seconds) {
    const std::string line =
        seconds > 0 ? fmt::format("{}: waiting for its {}, {} s", name, what, seconds) : "";
    std::fputs(("\r" + line + "\033[K").c_str(), stderr);
    std::fflush(stderr);
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
  if (shown_) std::fputs("\r\033[K", stderr);
  shown_ = false;
}

Progress::~Progress() { clear(); }

}  // namespace rilievo::app
