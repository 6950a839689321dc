#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "apps/rilievo/command.h"

namespace {

// One line, whatever was in the message.
int fail(std::string message, int code) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  fmt::print(stderr, "rilievo: {}\n", message);
  return code;
}

// As a shell would take it.
std::string command_line(int argc, char** argv) {
  std::string line = "rilievo";
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool plain =
        !word.empty() && word.find_first_of(" \t\n'\"\\?&*;|<>()[]{}$`!#~") == word.npos;
    line += plain ? " " + word : " '" + word + "'";
  }
  return line;
}

int run(int argc, char** argv) {
  CLI::App app{
      "Draws heavy 3D scenes as pictures with depth, and measures them against the truth."};
  app.set_help_all_flag("--help-all", "Show the options of every command");
  app.require_subcommand(1);
  app.get_formatter()->column_width(36);
  app.footer(
      "Example: rilievo compare 'builtin:bridge?triangles=500000' --methods flat,nailboard -o "
      "report\nEvery command says more with --help.");
  using namespace rilievo::app;
  const std::vector<Command> commands{
      info_command(app),   scene_command(app),   bake_command(app),
      render_command(app), compare_command(app), bench_command(app),
#ifdef RILIEVO_VIEWER
      view_command(app),
#endif
  };
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& wish) {  // --help
    return app.exit(wish);
  } catch (const CLI::ParseError& error) {
    return fail(error.what(), 2);
  }
  for (const Command& command : commands) {
    if (!*command.parser) continue;
    const rilievo::Result<> result = command.run(command_line(argc, argv));
    if (!result) return fail(result.error().where + ": " + result.error().reason, 2);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::bad_alloc&) {
    return fail("out of memory", 1);
  } catch (const std::exception& error) {
    return fail(error.what(), 1);
  }
}
