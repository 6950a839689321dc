// Which programs has this process started that must not outlive it?
//
// The list has a fixed size, so that a signal handler can read it and kill them.
#pragma once

namespace rilievo {

// Lists a process group for as long as the object lives. Groups beyond the 64th are not listed. Any
// thread.
class StartedProgram {
 public:
  explicit StartedProgram(int group) noexcept;
  ~StartedProgram();
  StartedProgram(const StartedProgram&) = delete;
  StartedProgram& operator=(const StartedProgram&) = delete;

 private:
  int slot_ = -1;
};

// Kills the groups that are listed. Safe in a signal handler: only reads the list and calls kill().
// For a program that is about to end: one that another thread starts at the same time can remain.
void kill_started_programs() noexcept;

}  // namespace rilievo
