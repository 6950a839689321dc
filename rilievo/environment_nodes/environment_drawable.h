// How are environment nodes a drawable? The nodes that an eye needs are kept in memory.
//
// The nodes that are drawn depend only on the frame, so that frames are reproducible. A frame waits
// for a node that it draws; the nodes that are likely next are loaded meanwhile (working_set.h).
#pragma once

#include <functional>
#include <memory>

#include "rilievo/environment_nodes/environment_nodes.h"
#include "rilievo/environment_nodes/node_store.h"
#include "rilievo/kind/kind.h"

namespace rilievo {

// How nodes are drawn, and how many.
struct EnvironmentDrawOptions {
  NodeDrawOptions draw{.skin = true};
  std::size_t nodes = 2;     // drawn at a time
  bool fills = true;         // one more where these lack something of the view
  std::size_t resident = 4;  // in memory at a time
};
// Typed options from the values of the kind's draw_options.
[[nodiscard]] Result<EnvironmentDrawOptions> environment_draw_options(const OptionValues& values);

// Makes a store, which decides on the backend, for each drawable.
using MakeNodeStore = std::function<std::unique_ptr<NodeStore>()>;
[[nodiscard]] std::unique_ptr<DrawableFactory> make_environment_factory(MakeNodeStore make_store);

// Environment nodes, ready to be drawn.
class EnvironmentDrawable final : public Drawable {
 public:
  EnvironmentDrawable(EnvironmentNodes nodes, std::unique_ptr<NodeStore> store,
                      const EnvironmentDrawOptions& options);
  ~EnvironmentDrawable() override;

  [[nodiscard]] std::string_view kind() const override;
  void draw(const Camera& frame, std::span<const Instance> instances, Output output) override;
  // On the surfaces, where the six pictures of a node meet.
  void draw_outlines(const Camera& frame, std::span<const Instance> instances) override;
  void set_samples(int samples) override;
  [[nodiscard]] const TileDrawer* tiles() const override;
  [[nodiscard]] const TileDrawer* outline_tiles() const override;
  // Loads a node that it has not met before: the first bound near it takes tens of milliseconds.
  [[nodiscard]] ErrorModel error_model(std::uint32_t item) const override;
  [[nodiscard]] CostTerms cost_terms(std::uint32_t item) const override;
  [[nodiscard]] std::size_t bytes() const override;
  [[nodiscard]] const Sky* sky() const override;

  // The largest number of nodes that were in memory or being loaded at a time; and the first error,
  // if there was one.
  [[nodiscard]] std::size_t most_in_memory() const;
  [[nodiscard]] std::optional<Error> error() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rilievo
