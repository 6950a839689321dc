#include "apps/rilievo/methods.h"

#include "rilievo/draw/direct_frames.h"

namespace rilievo::app {

void add_method_options(CLI::App& command, MethodOptions& options) {
  command
      .add_option("--delta-bits", options.delta_bits,
                  "Bits of Delta, the pictures' depth (default 8)")
      ->check(CLI::IsMember({2, 4, 6, 8, 16}));
  command.add_option("--depth", options.depth, "How nailboards write depth (default exact)")
      ->check(CLI::IsMember({"exact", "linear"}));
  command.add_flag("--outlines", options.outlines, "Outline what is drawn from a picture");
}

const std::vector<std::string>& method_names() {
  static const std::vector<std::string> names{"direct"};
  return names;
}

Result<std::unique_ptr<FrameSource>> make_source(const std::string& method,
                                                 const MethodOptions& options,
                                                 SceneRenderer& renderer) {
  (void)options;
  if (method == "direct") return {std::make_unique<DirectFrames>(renderer)};
  return Error{"--method", "unknown method '" + method + "'"};
}

}  // namespace rilievo::app
