#include <fcntl.h>
#include <fmt/format.h>

#include <cerrno>
#include <exception>
#include <new>
#include <sstream>
#include <string>
#include <vector>

#include "apps/commit.h"
#include "apps/rilievo/checks.h"
#include "apps/rilievo/command.h"
#include "apps/rilievo/help.h"
#include "apps/rilievo/output.h"
#include "apps/rilievo/signals.h"

namespace {

int fail(const std::string& message, int code) {
  rilievo::app::complain(message);
  return code;
}

// If the caller closed a standard stream, the next file to be opened would take its number, and
// what is meant for the stream would go there. Opened the wrong way round, each use of it fails.
void occupy_standard_streams() {
  for (int fd = 0; fd <= 2; ++fd)
    if (::fcntl(fd, F_GETFD) < 0 && errno == EBADF)
      (void)::open("/dev/null", fd == 0 ? O_WRONLY : O_RDONLY);
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
      "Draws heavy 3D scenes as pictures with depth, and measures them against direct drawing."};
  app.set_help_all_flag("--help-all", "Show all options; of every command, if none is named");
  app.set_version_flag("--version",
                       fmt::format("rilievo {} ({})", RILIEVO_VERSION, rilievo::commit()),
                       "Print the version and the commit, and exit");
  app.require_subcommand(1);
  app.get_formatter()->column_width(36);
  app.footer(
      "Example: rilievo compare 'builtin:bridge?triangles=500000' --methods flat,nailboard -o "
      "report\nrilievo COMMAND --help shows the options of a command.");
  using namespace rilievo::app;
  const std::vector<Command> commands{
      info_command(app),   scene_command(app),   bake_command(app),
      export_command(app), web_command(app),     serve_command(app),
      render_command(app), compare_command(app), bench_command(app),
#ifdef RILIEVO_VIEWER
      view_command(app),
#endif
  };
  for (const Command& command : commands) {
    refuse_empty(*command.parser);
    group_options(*command.parser);
  }
  std::string shell;
  CLI::App* completion =
      app.add_subcommand("completion", "Print a script that completes what is typed in a shell");
  completion->add_option("SHELL", shell, "bash or zsh")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh"}));
  completion->footer("Example: source <(rilievo completion bash)");
  CLI::App* manual = app.add_subcommand("manual", "Print the manual page, in roff");
  manual->footer("Example: rilievo manual > rilievo.1 && man ./rilievo.1");
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp& wish) {
    show_usual_options(app);
    std::ostringstream help;
    const int code = app.exit(wish, help, help);
    print_text(help.str());
    return code;
  } catch (const CLI::Success& wish) {  // --help-all, --version
    std::ostringstream help;
    const int code = app.exit(wish, help, help);
    print_text(help.str());
    return code;
  } catch (const CLI::ParseError& error) {
    return fail(error.what(), 2);
  }
  if (*completion) print_text(completion_script(app, shell));
  if (*manual) print_text(manual_page(app, RILIEVO_VERSION));
  for (const Command& command : commands) {
    if (!*command.parser) continue;
    const rilievo::Result<> result = command.run(command_line(argc, argv));
    if (!result) return fail(result.error().message(), 2);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  occupy_standard_streams();
  rilievo::app::clean_up_on_signals();
  try {
    const int code = run(argc, argv);
    const rilievo::Result<> printed = rilievo::app::flush_output();
    return printed || code != 0 ? code : fail(printed.error().message(), 2);
  } catch (const std::bad_alloc&) {
    return fail("out of memory", 1);
  } catch (const std::exception& error) {
    return fail(error.what(), 1);
  }
}
