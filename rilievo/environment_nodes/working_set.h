// Which of many nodes are in memory, and which are loaded next? (S3.8)
//
// A thread loads nodes (reads and triangulates them, and computes their bounds), so that a frame
// waits only for nodes that it draws. The number of nodes in memory is limited: those that the
// owner holds, the one being loaded and those that wait to be taken. Call all functions from one
// thread.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "rilievo/environment_nodes/environment_nodes.h"
#include "rilievo/environment_nodes/error.h"

namespace rilievo {

// A node in memory.
struct LoadedNode {
  std::size_t node = 0;
  EnvironmentMap map;
  NodeMesh mesh;
  NodeErrorModel error;
};

// Reads and triangulates a node: the work of the thread.
[[nodiscard]] Result<LoadedNode> load_and_triangulate(const EnvironmentNodes& nodes,
                                                      std::size_t node);

// The nodes in memory.
class NodeWorkingSet {
 public:
  // `nodes` must outlive the object. Requires most >= 1.
  NodeWorkingSet(const EnvironmentNodes& nodes, std::size_t most);
  // Waits for what is being loaded.
  ~NodeWorkingSet();

  // Sets the wanted nodes, the best first; those beyond `most` are ignored. Calls `drop` for each
  // node that the owner must give up to make room.
  void want(std::span<const std::size_t> wanted, const std::function<void(std::size_t)>& drop);

  // A node that has been loaded, which the owner then holds; none if there is no such node. A node
  // that could not be loaded is not tried again: see error().
  [[nodiscard]] std::optional<LoadedNode> take();
  // Waits until `node` can be taken. Returns false if it cannot be loaded, is not wanted, or is
  // held.
  bool wait_for(std::size_t node);

  [[nodiscard]] std::optional<Error> error() const;
  // The number of nodes held, being loaded and waiting to be taken: now, and the largest so far.
  [[nodiscard]] std::size_t in_memory() const;
  [[nodiscard]] std::size_t most_in_memory() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rilievo
