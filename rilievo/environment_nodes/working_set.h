// Which of many nodes are in memory, and which are loaded next? (S3.8)
//
// Nodes are loaded (read, triangulated, their bounds measured) by a thread of its own, so that a
// frame never waits for a node that it does not draw. At most so many are in memory at a time:
// those that the owner holds, the one being loaded and those that wait to be taken. All calls from
// one thread.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "rilievo/environment_nodes/environment_nodes.h"
#include "rilievo/environment_nodes/error.h"

namespace rilievo {

struct LoadedNode {
  std::size_t node = 0;
  EnvironmentMap map;
  NodeMesh mesh;
  NodeErrorModel error;
};

// Reads and triangulates; what the thread does for each node.
[[nodiscard]] Result<LoadedNode> load_and_triangulate(const EnvironmentNodes& nodes,
                                                      std::size_t node);

class NodeWorkingSet {
 public:
  // `nodes` must outlive it. Requires most >= 1.
  NodeWorkingSet(const EnvironmentNodes& nodes, std::size_t most);
  // Waits for what is being loaded.
  ~NodeWorkingSet();

  // Says which nodes are wanted, the best first; more than `most` are ignored. Calls `drop` for
  // nodes that the owner holds and must give up, to make room.
  void want(std::span<const std::size_t> wanted, const std::function<void(std::size_t)>& drop);

  // A node that has been loaded; from now on the owner holds it. A node that could not be loaded is
  // not tried again: error() says why.
  [[nodiscard]] std::optional<LoadedNode> take();
  // Waits until `node` can be taken. False if it cannot be loaded, is not wanted, or is held.
  bool wait_for(std::size_t node);

  [[nodiscard]] std::optional<Error> error() const;
  // Held, being loaded, and waiting to be taken: now, and at most ever.
  [[nodiscard]] std::size_t in_memory() const;
  [[nodiscard]] std::size_t most_in_memory() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rilievo
