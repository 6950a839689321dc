// How does one thread hand its newest result to another, without either waiting?
//
// Three values: one that is written, one that is read, and one between, which both exchange for
// theirs. One thread writes, one reads (or several in turn, ordered by other means). Nothing is
// copied, locked or allocated; results that were not read in time are overwritten.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace rilievo {

// Hands values from a writer to a reader.
template <class Value>
class TripleBuffer {
 public:
  // The writer's value; keeps what was in it two or three results ago.
  [[nodiscard]] Value& back() { return values_[back_]; }
  // Hands it out; back() is another one then.
  void publish() {
    back_ = std::uint8_t(between_.exchange(std::uint8_t(back_ | kNew), std::memory_order_acq_rel) &
                         kIndex);
  }

  // The reader: would update() take one?
  [[nodiscard]] bool has_news() const { return between_.load(std::memory_order_relaxed) & kNew; }
  // The reader: takes the newest result, if there is one since the last call.
  bool update() {
    if (!(between_.load(std::memory_order_relaxed) & kNew)) return false;
    front_ = std::uint8_t(between_.exchange(front_, std::memory_order_acq_rel) & kIndex);
    return true;
  }
  // The reader's value: as it was at the last update().
  [[nodiscard]] Value& front() { return values_[front_]; }
  [[nodiscard]] const Value& front() const { return values_[front_]; }

 private:
  static constexpr std::uint8_t kIndex = 3, kNew = 4;
  std::array<Value, 3> values_{};
  std::uint8_t back_ = 0, front_ = 2;
  std::atomic<std::uint8_t> between_{1};
};

}  // namespace rilievo
