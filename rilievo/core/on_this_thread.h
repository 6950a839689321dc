// On how many threads does work run? How does a background worker keep to one core, however its
// work would divide itself?
#pragma once

namespace rilievo {

// While one lives, the parallel_for calls of its thread run on this thread alone.
class OnThisThread {
 public:
  // Frames run on the threads of this thread's TBB arena.
  OnThisThread();
  // Frames run on `frame_threads` threads, which another thread knows.
  explicit OnThisThread(int frame_threads);
  ~OnThisThread();
  OnThisThread(const OnThisThread&) = delete;
  OnThisThread& operator=(const OnThisThread&) = delete;

 private:
  bool before_;
  int threads_before_;
};

// Does an OnThisThread live on this thread, so that it works beside those that draw frames?
[[nodiscard]] bool beside_frames();

// On how many threads the parallel_for calls of this thread run at the same time, at most: one
// while an OnThisThread lives, and no more than its TBB arena and a host's tbb::global_control
// allow.
[[nodiscard]] int threads_of_calls();
// The same as if no OnThisThread lived: the threads of frames, for a worker beside them.
[[nodiscard]] int threads_of_frames();

}  // namespace rilievo
