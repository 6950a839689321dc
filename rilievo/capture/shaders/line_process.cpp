#include "rilievo/capture/shaders/line_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <vector>

extern char** environ;

namespace rilievo {
namespace {

constexpr std::size_t kMaxLineBytes = 1 << 20;

// What is to be done in the child, and with which signals it begins.
struct SpawnPlan {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;

  SpawnPlan(int in, int out) {
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, in, 0);
    posix_spawn_file_actions_adddup2(&actions, out, 1);
    posix_spawnattr_init(&attributes);
    sigset_t signals;
    sigemptyset(&signals);
    posix_spawnattr_setsigmask(&attributes, &signals);
    sigaddset(&signals, SIGPIPE);
    posix_spawnattr_setsigdefault(&attributes, &signals);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(
        &attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  }
  ~SpawnPlan() {
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
  }
  SpawnPlan(const SpawnPlan&) = delete;
  SpawnPlan& operator=(const SpawnPlan&) = delete;
};

}  // namespace

Result<std::unique_ptr<LineProcess>> LineProcess::start(const std::string& program,
                                                        std::span<const std::string> arguments,
                                                        int nice) {
  const auto error = [&](int number) {
    return Error{program, std::string("cannot be started: ") + std::strerror(number)};
  };
  // A socket, because writing into one can be told not to send SIGPIPE.
  int in[2], out[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, in) != 0) return error(errno);
  Descriptor ours(in[0]), theirs(in[1]);
  if (::pipe2(out, O_CLOEXEC) != 0) return error(errno);
  Descriptor from(out[0]), answers(out[1]);
  std::vector<std::string> words{program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  SpawnPlan plan(theirs.fd, answers.fd);
  pid_t id = 0;
  if (const int failed = ::posix_spawnp(&id, program.c_str(), &plan.actions, &plan.attributes,
                                        argv.data(), environ))
    return error(failed);
  // It has one thread yet; what it starts later inherits this.
  errno = 0;
  const int own = ::getpriority(PRIO_PROCESS, 0);
  if (nice > 0 && errno == 0) (void)::setpriority(PRIO_PROCESS, id_t(id), own + nice);
  return std::unique_ptr<LineProcess>(
      new LineProcess(id, std::exchange(ours.fd, -1), std::exchange(from.fd, -1)));
}

LineProcess::~LineProcess() {
  to_.close();
  from_.close();
  ::kill(-id_, SIGKILL);
  ::kill(id_, SIGKILL);
  while (::waitpid(id_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

bool LineProcess::send(std::string_view line) {
  std::string bytes(line);
  bytes += '\n';
  for (std::size_t done = 0; done < bytes.size();) {
    // A program that has not read several earlier lines will not read this one.
    const ssize_t sent =
        ::send(to_.fd, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    done += std::size_t(sent);
  }
  return true;
}

LineProcess::Heard LineProcess::receive(std::string& line, Clock::time_point until,
                                        const std::stop_token& stop) {
  const Descriptor woken(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  const std::stop_callback wake(stop, [&] {
    const std::uint64_t one = 1;
    (void)!::write(woken.fd, &one, sizeof one);
  });
  while (true) {
    if (const std::size_t end = heard_.find('\n'); end != std::string::npos) {
      line = heard_.substr(0, end);
      heard_.erase(0, end + 1);
      return Heard::line;
    }
    if (heard_.size() > kMaxLineBytes) return Heard::too_long;
    if (stop.stop_requested()) return Heard::stopped;
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count();
    if (left <= 0) return Heard::late;
    pollfd wait[2] = {{from_.fd, POLLIN, 0}, {woken.fd, POLLIN, 0}};
    const int ready = ::poll(wait, woken.fd < 0 ? 1 : 2, int(std::min<long long>(left, 60'000)));
    if (ready <= 0 || !wait[0].revents) continue;
    char bytes[4096];
    const ssize_t count = ::read(from_.fd, bytes, sizeof bytes);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return Heard::ended;
    heard_.append(bytes, std::size_t(count));
  }
}

}  // namespace rilievo
