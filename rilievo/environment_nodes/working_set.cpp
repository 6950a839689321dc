#include "rilievo/environment_nodes/working_set.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "rilievo/core/expects.h"

namespace rilievo {

Result<LoadedNode> load_and_triangulate(const EnvironmentNodes& nodes, std::size_t node) {
  Result<EnvironmentMap> map = load_node(nodes, node);
  if (!map) return map.error();
  LoadedNode loaded;
  loaded.node = node;
  loaded.map = *std::move(map);
  loaded.mesh = triangulate(loaded.map, nodes.mesh);
  loaded.error = make_error_model(loaded.map, loaded.mesh, nodes.strokes);
  return loaded;
}

struct NodeWorkingSet::State {
  enum class Where { away, loading, ready, held, broken };

  const EnvironmentNodes& nodes;
  const std::size_t most;
  mutable std::mutex mutex;
  std::condition_variable changed;
  std::vector<Where> where;
  std::vector<std::size_t> wanted;
  std::deque<LoadedNode> ready;
  std::optional<Error> error;
  std::size_t in_memory = 0, peak = 0;
  bool ends = false;
  std::thread thread;

  State(const EnvironmentNodes& of, std::size_t limit)
      : nodes(of), most(limit), where(of.nodes.size(), Where::away) {}

  [[nodiscard]] bool is_wanted(std::size_t node) const {
    return std::find(wanted.begin(), wanted.end(), node) != wanted.end();
  }
  // The next to load, if there is room for it.
  [[nodiscard]] std::optional<std::size_t> next() const {
    if (in_memory >= most) return std::nullopt;
    for (const std::size_t node : wanted)
      if (where[node] == Where::away) return node;
    return std::nullopt;
  }

  void run() {
    std::unique_lock lock(mutex);
    while (true) {
      changed.wait(lock, [&] { return ends || next(); });
      if (ends) return;
      const std::size_t node = *next();
      where[node] = Where::loading;
      peak = std::max(peak, ++in_memory);
      lock.unlock();
      Result<LoadedNode> loaded = load_and_triangulate(nodes, node);
      lock.lock();
      if (loaded && !is_wanted(node)) {
        // Its room is wanted for another one.
        where[node] = Where::away;
        --in_memory;
      } else if (loaded) {
        where[node] = Where::ready;
        ready.push_back(*std::move(loaded));
      } else {
        where[node] = Where::broken;
        --in_memory;
        if (!error) error = loaded.error();
      }
      changed.notify_all();
    }
  }
};

NodeWorkingSet::NodeWorkingSet(const EnvironmentNodes& nodes, std::size_t most)
    : state_(std::make_unique<State>(nodes, most)) {
  RILIEVO_EXPECTS(most >= 1);
  state_->thread = std::thread([state = state_.get()] { state->run(); });
}

NodeWorkingSet::~NodeWorkingSet() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->ends = true;
  }
  state_->changed.notify_all();
  state_->thread.join();
}

void NodeWorkingSet::want(std::span<const std::size_t> wanted,
                          const std::function<void(std::size_t)>& drop) {
  State& s = *state_;
  using Where = State::Where;
  {
    const std::lock_guard lock(s.mutex);
    wanted = wanted.first(std::min(wanted.size(), s.most));
    s.wanted.assign(wanted.begin(), wanted.end());
    const auto missing = std::size_t(std::count_if(
        wanted.begin(), wanted.end(), [&](std::size_t n) { return s.where[n] == Where::away; }));
    // What was loaded in vain goes first.
    for (auto it = s.ready.begin(); it != s.ready.end() && s.in_memory + missing > s.most;) {
      if (s.is_wanted(it->node)) {
        ++it;
        continue;
      }
      s.where[it->node] = Where::away;
      --s.in_memory;
      it = s.ready.erase(it);
    }
    for (std::size_t node = 0; node < s.where.size() && s.in_memory + missing > s.most; ++node) {
      if (s.where[node] != Where::held || s.is_wanted(node)) continue;
      drop(node);
      s.where[node] = Where::away;
      --s.in_memory;
    }
  }
  s.changed.notify_all();
}

std::optional<LoadedNode> NodeWorkingSet::take() {
  State& s = *state_;
  const std::lock_guard lock(s.mutex);
  if (s.ready.empty()) return std::nullopt;
  LoadedNode node = std::move(s.ready.front());
  s.ready.pop_front();
  s.where[node.node] = State::Where::held;
  return node;
}

bool NodeWorkingSet::wait_for(std::size_t node) {
  State& s = *state_;
  using Where = State::Where;
  std::unique_lock lock(s.mutex);
  if (!s.is_wanted(node)) return s.where[node] == Where::ready;
  // Something that is ready but not taken may take its room.
  s.changed.wait(lock, [&] {
    return s.where[node] == Where::ready || s.where[node] == Where::broken ||
           s.where[node] == Where::held;
  });
  return s.where[node] == Where::ready;
}

std::optional<Error> NodeWorkingSet::error() const {
  const std::lock_guard lock(state_->mutex);
  return state_->error;
}

std::size_t NodeWorkingSet::in_memory() const {
  const std::lock_guard lock(state_->mutex);
  return state_->in_memory;
}

std::size_t NodeWorkingSet::most_in_memory() const {
  const std::lock_guard lock(state_->mutex);
  return state_->peak;
}

}  // namespace rilievo
