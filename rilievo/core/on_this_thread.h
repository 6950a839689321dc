// How does a background worker keep to one core, however its work would divide itself?
#pragma once

namespace rilievo {

// While one lives, the parallel_for calls of its thread run on this thread alone.
class OnThisThread {
 public:
  OnThisThread();
  ~OnThisThread();
  OnThisThread(const OnThisThread&) = delete;
  OnThisThread& operator=(const OnThisThread&) = delete;

 private:
  bool before_;
};

}  // namespace rilievo
