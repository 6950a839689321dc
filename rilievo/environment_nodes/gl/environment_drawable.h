// Environment nodes as a drawable: those that an eye needs, kept in memory while it needs them.
//
// Which nodes are drawn follows from the eye alone, so that frames repeat: a node that is drawn and
// not in memory is waited for; the next ones are loaded meanwhile (working_set.h). Needs a current
// OpenGL context.
#pragma once

#include <memory>

#include "rilievo/environment_nodes/environment_nodes.h"
#include "rilievo/environment_nodes/gl/node_drawer.h"
#include "rilievo/kind/kind.h"

namespace rilievo {

struct EnvironmentDrawOptions {
  NodeDrawOptions draw{.skin = true};
  std::size_t nodes = 2;     // drawn at a time
  std::size_t resident = 4;  // in memory at a time
};
[[nodiscard]] Result<EnvironmentDrawOptions> environment_draw_options(const OptionValues& values);

[[nodiscard]] Result<std::unique_ptr<DrawableFactory>> make_environment_drawable_factory();

class EnvironmentDrawable final : public Drawable {
 public:
  // `drawer` must outlive it.
  EnvironmentDrawable(EnvironmentNodes nodes, NodeDrawer& drawer,
                      const EnvironmentDrawOptions& options);
  ~EnvironmentDrawable() override;

  [[nodiscard]] std::string_view kind() const override;
  void draw(const Camera& frame, std::span<const Instance> instances, Output output) override;
  // There is nothing around surroundings.
  void draw_outlines(const Camera& frame, std::span<const Instance> instances) override;
  // Of the nodes that an eye needs: the first time, measuring one takes as long as loading it.
  [[nodiscard]] ErrorModel error_model(std::uint32_t item) const override;
  [[nodiscard]] CostTerms cost_terms(std::uint32_t item) const override;
  [[nodiscard]] std::size_t bytes() const override;

  // Nodes held and being loaded, at most ever; and what went wrong, if anything did.
  [[nodiscard]] std::size_t most_in_memory() const;
  [[nodiscard]] std::optional<Error> error() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rilievo
