#include "rilievo/core/processor_time.h"

#include <sys/resource.h>
#include <sys/types.h>
#include <unistd.h>

#include <ctime>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <system_error>
#include <vector>

namespace rilievo {
namespace {

double clock_seconds(clockid_t clock) {
  timespec at{};
  return ::clock_gettime(clock, &at) == 0 ? double(at.tv_sec) + 1e-9 * double(at.tv_nsec) : 0;
}

// Of a process, and of its children that it has waited for.
double seconds_of_process(pid_t process) {
  clockid_t clock{};
  double seconds = ::clock_getcpuclockid(process, &clock) == 0 ? clock_seconds(clock) : 0;
  // Fields 16 and 17, counted from 1; the second one is a name in parentheses, which may have any
  // letters.
  std::ifstream stat("/proc/" + std::to_string(process) + "/stat");
  stat.ignore(std::numeric_limits<std::streamsize>::max(), ')');
  std::string skipped;
  for (int field = 3; field < 16; ++field) stat >> skipped;
  long user = 0, system = 0;
  if (stat >> user >> system) seconds += double(user + system) / double(::sysconf(_SC_CLK_TCK));
  return seconds;
}

// The processes that any thread of a process started and that were not waited for.
std::vector<pid_t> children_of(const std::string& process) {
  std::vector<pid_t> children;
  std::error_code failed;
  const std::filesystem::path threads = "/proc/" + process + "/task";
  for (auto it = std::filesystem::directory_iterator(threads, failed);
       !failed && it != std::filesystem::directory_iterator(); it.increment(failed)) {
    std::ifstream list(it->path() / "children");
    for (pid_t child = 0; list >> child;) children.push_back(child);
  }
  return children;
}

}  // namespace

double processor_seconds() {
  rusage waited_for{};
  ::getrusage(RUSAGE_CHILDREN, &waited_for);
  double seconds = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
  for (const timeval& part : {waited_for.ru_utime, waited_for.ru_stime})
    seconds += double(part.tv_sec) + 1e-6 * double(part.tv_usec);
  std::vector<pid_t> open = children_of("self");
  while (!open.empty()) {
    const pid_t process = open.back();
    open.pop_back();
    seconds += seconds_of_process(process);
    for (const pid_t child : children_of(std::to_string(process))) open.push_back(child);
  }
  return seconds;
}

}  // namespace rilievo
