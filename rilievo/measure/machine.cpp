#include "rilievo/measure/machine.h"

#include <sched.h>

#include <algorithm>
#include <fstream>
#include <thread>

namespace rilievo {
namespace {

std::string cpu_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("model name")) continue;
    const std::size_t colon = line.find(": ");
    if (colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

}  // namespace

Machine this_machine() {
  Machine machine;
  machine.cpu = cpu_name();
  // The processors that this process is bound to, which may be fewer than the machine has.
  cpu_set_t set;
  CPU_ZERO(&set);
  machine.threads = sched_getaffinity(0, sizeof set, &set) == 0
                        ? CPU_COUNT(&set)
                        : int(std::max(1u, std::thread::hardware_concurrency()));
  return machine;
}

}  // namespace rilievo
