// How is progress shown? In one line that is rewritten, on a terminal only; silent in a pipe.
#pragma once

#include <string>

namespace rilievo::app {

class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(int done, int total);
  // Before something else is printed.
  void clear();

 private:
  std::string what_;
  bool on_terminal_ = false, shown_ = false;
};

}  // namespace rilievo::app
