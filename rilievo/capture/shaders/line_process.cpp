#include "rilievo/capture/shaders/line_process.h"

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <future>
#include <system_error>
#include <vector>

namespace rilievo {
namespace {

constexpr std::size_t kMaxLineBytes = 1 << 20;

// Handlers of ours must not run in a child that still is a copy of us.
void forget_signals() {
  for (int signal = 1; signal < NSIG; ++signal) {
    struct sigaction action {};
    if (::sigaction(signal, nullptr, &action) != 0) continue;
    if (action.sa_handler != SIG_IGN || signal == SIGPIPE) ::signal(signal, SIG_DFL);
  }
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
}

// What the child does between fork() and exec(): calls that are safe with other threads gone, and
// no allocation. Tells `told` what went wrong.
[[noreturn]] void become(char* const* argv, int in, int out, int told, pid_t parent, int nice) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  // Had the parent died before, nobody would tell.
  if (::getppid() != parent) ::_exit(127);
  errno = 0;
  const int own = ::getpriority(PRIO_PROCESS, 0);
  if (nice > 0 && errno == 0) (void)::setpriority(PRIO_PROCESS, 0, own + nice);
  if (::dup2(in, 0) >= 0 && ::dup2(out, 1) >= 0) {
    forget_signals();
    ::execvp(argv[0], argv);
  }
  const int failed = errno;
  (void)!::write(told, &failed, sizeof failed);
  ::_exit(127);
}

// Starts a program; gives errno, or 0 and its id. Signals are blocked meanwhile, so that the child
// has none until it has forgotten our handlers. fork() copies page tables, some 45 ms for each
// gigabyte in use, once a program. A child in our memory (CLONE_VM) would be quicker, but then the
// calls that it makes change what sanitizers note of our handlers.
int fork_program(char* const* argv, int in, int out, int nice, pid_t& id) {
  int report[2];
  if (::pipe2(report, O_CLOEXEC) != 0) return errno;
  Descriptor heard(report[0]), told(report[1]);
  sigset_t all, before;
  sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  const pid_t parent = ::getpid();
  id = ::fork();
  const int not_forked = errno;
  if (id == 0) become(argv, in, out, told.fd, parent, nice);
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (id < 0) return not_forked;
  told.close();
  // Ends, without a byte, once the program has taken the child's place.
  int failed = 0;
  ssize_t count = 0;
  while ((count = ::read(heard.fd, &failed, sizeof failed)) < 0 && errno == EINTR) {
  }
  if (count <= 0) return 0;
  while (::waitpid(id, nullptr, 0) < 0 && errno == EINTR) {
  }
  return failed;
}

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
  // The kernel sends PR_SET_PDEATHSIG when the thread ends that forked, not the process: a thread
  // forks that lives as long as the program is wanted.
  pid_t id = 0;
  std::promise<int> promise;
  std::future<int> started = promise.get_future();
  std::jthread parent;
  try {
    parent = std::jthread([&, told = std::move(promise)](const std::stop_token& stop) mutable {
      std::promise<void> unwanted;
      const std::stop_callback end(stop, [&] { unwanted.set_value(); });
      // After this nothing of start() may be there.
      told.set_value(fork_program(argv.data(), theirs.fd, answers.fd, nice, id));
      unwanted.get_future().wait();
    });
  } catch (const std::system_error& no_thread) {
    return error(no_thread.code().value());
  }
  if (const int failed = started.get()) return error(failed);
  return std::unique_ptr<LineProcess>(new LineProcess(
      id, std::exchange(ours.fd, -1), std::exchange(from.fd, -1), std::move(parent)));
}

LineProcess::~LineProcess() {
  to_.close();
  from_.close();
  ::kill(-id_, SIGKILL);
  ::kill(id_, SIGKILL);
  // Once it is waited for, its number may be another's.
  listed_.reset();
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
