#include "apps/rilievo/help.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "apps/rilievo/kinds.h"

namespace rilievo::app {
namespace {

// A command with no more options shows them all.
constexpr std::size_t kFew = 24;

// What those with more show: what a user of a scene of one's own needs.
constexpr std::string_view kUsual[] = {
    "--help",  "--help-all", "--output",    "--method",    "--methods", "--scene", "--as",
    "--size",  "--frames",   "--path",      "--orbit",     "--walk",    "--time",  "--samples",
    "--draw",  "--error-px", "--memory-mb", "--outlines",  "--split",   "--set",   "--up",
    "--units", "--json",     "--psnr",      "--screenshot"};
// And where something is baked into a file:
constexpr std::string_view kUsualOfBakes[] = {"--at",       "--auto", "--views",
                                              "--textures", "--face", "--source"};

// The group of options that everybody sees.
constexpr const char* kOptions = "Options";

std::string flag_of(const CLI::Option& option) {
  return option.get_lnames().empty() ? "" : "--" + option.get_lnames().front();
}

bool is_usual(const CLI::Option& option, bool bakes) {
  const std::string flag = flag_of(option);
  return option.get_positional() || std::ranges::find(kUsual, flag) != std::end(kUsual) ||
         (bakes && std::ranges::find(kUsualOfBakes, flag) != std::end(kUsualOfBakes));
}

// "cache" of "cache: the kinds to bake".
std::string owner_of(const CLI::Option& option) {
  const std::string& text = option.get_description();
  const std::size_t colon = text.find(": ");
  const std::size_t blank = text.find(' ');
  const bool names = colon != text.npos && (blank == colon + 1 || text[blank - 1] == ',');
  return names ? text.substr(0, colon) : "";
}

std::vector<const CLI::Option*> options_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option*) { return true; });
}

// What an option takes, if that is one of some words: "{a,b,c}" of its type.
std::vector<std::string> words_of(const CLI::Option& option) {
  if (flag_of(option) == "--set") return set_names();
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{'), end = type.find('}');
  if (open == type.npos || end == type.npos) return {};
  std::vector<std::string> words;
  for (std::size_t at = open + 1; at < end;) {
    const std::size_t next = std::min(type.find(',', at), end);
    std::string word = type.substr(at, next - at);
    words.push_back(word.substr(0, word.find("->")));
    at = next + 1;
  }
  return words;
}

std::vector<std::string> flags_of(const CLI::App& command) {
  std::vector<std::string> flags;
  for (const CLI::Option* option : options_of(command))
    for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
  return flags;
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

std::string bash_script(const CLI::App& app) {
  std::vector<std::string> names;
  std::string cases, values;
  for (const CLI::App* command : commands_of(app)) {
    names.push_back(command->get_name());
    cases += fmt::format("    {}) words=\"{}\" ;;\n", command->get_name(),
                         fmt::join(flags_of(*command), " "));
    for (const CLI::Option* option : options_of(*command))
      if (const auto words = words_of(*option); !words.empty())
        values += fmt::format("    {}:{}) values=\"{}\" ;;\n", command->get_name(),
                              flag_of(*option), fmt::join(words, " "));
  }
  return fmt::format(R"(# Completes rilievo's commands, options and their values in bash.
_rilievo() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} words= values=
  if [ "$COMP_CWORD" -eq 1 ]; then
    COMPREPLY=($(compgen -W "{} --help --version" -- "$word"))
    return
  fi
  case ${{COMP_WORDS[1]}}:$before in
{}  esac
  if [ -n "$values" ]; then
    COMPREPLY=($(compgen -W "$values" -- "$word"))
    return
  fi
  case ${{COMP_WORDS[1]}} in
{}  esac
  case $word in
    -*) COMPREPLY=($(compgen -W "$words" -- "$word")) ;;
    *) COMPREPLY=($(compgen -f -- "$word")) ;;
  esac
}}
complete -o filenames -F _rilievo rilievo
)",
                     fmt::join(names, " "), values, cases);
}

// What roff would take for an order.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\' || c == '-') out += '\\';
    if (c == '.' && (out.empty() || out.back() == '\n')) out += "\\&";
    out += c;
  }
  return out;
}

std::string manual_of(const CLI::App& command) {
  std::string text =
      fmt::format(".SS rilievo {}\n{}\n", command.get_name(), roff(command.get_description()));
  for (const CLI::Option* option : options_of(command)) {
    if (option->get_name() == "--help-all") continue;
    text += fmt::format(
        ".TP\n.B {}\n{}\n",
        roff(option->get_positional() ? option->get_name(true) : option->get_name(false, true)),
        roff(option->get_description()));
  }
  if (!command.get_footer().empty())
    text += fmt::format(".PP\n.nf\n{}\n.fi\n", roff(command.get_footer()));
  return text;
}

}  // namespace

void group_options(CLI::App& command) {
  std::vector<CLI::Option*> options = command.get_options([](const CLI::Option*) { return true; });
  if (options.size() <= kFew) return;
  const bool bakes = command.get_option_no_throw("--as") != nullptr;
  std::size_t more = 0;
  for (CLI::Option* option : options) {
    if (is_usual(*option, bakes)) continue;
    const std::string owner = owner_of(*option);
    option->group(owner.empty() ? "More options" : "Of " + owner);
    ++more;
  }
  if (more > 0)
    command.footer(fmt::format("{}\n{} more options: rilievo {} --help-all", command.get_footer(),
                               more, command.get_name()));
}

void show_usual_options(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; }))
    for (CLI::Option* option : command->get_options([](const CLI::Option*) { return true; }))
      if (option->get_group() != kOptions) option->group("");
}

std::string completion_script(const CLI::App& app, const std::string& shell) {
  // zsh runs bash's by its own emulation.
  if (shell == "zsh")
    return "#compdef rilievo\nautoload -U +X bashcompinit && bashcompinit\n" + bash_script(app);
  return bash_script(app);
}

std::string manual_page(const CLI::App& app, const std::string& version) {
  std::string text = fmt::format(
      ".TH RILIEVO 1 \"\" \"rilievo {}\"\n.SH NAME\nrilievo \\- {}\n.SH SYNOPSIS\n.B rilievo\n"
      "COMMAND [OPTIONS]\n.SH DESCRIPTION\n{}\n.PP\nExit codes: 0 success; 2 bad usage, bad input "
      "or lost output, with one line on the error output; 1 an error of the program itself.\n"
      ".SH COMMANDS\n",
      version, "heavy 3D scenes as pictures with depth", roff(app.get_description()));
  for (const CLI::App* command : commands_of(app)) text += manual_of(*command);
  return text;
}

}  // namespace rilievo::app
