#include <functional>

#include "app/completion_scripts.h"
#include "app/manual.h"

namespace planecast::app {
namespace {

/// "evaluate planes" of planecast's sub-subcommand; empty for planecast itself.
std::string path_of(const CLI::App& command) {
  if (command.get_parent() == nullptr) return "";
  const std::string above = path_of(*command.get_parent());
  return (above.empty() ? "" : above + " ") + command.get_name();
}

void for_each_command(const CLI::App& command, const std::function<void(const CLI::App&)>& visit) {
  visit(command);
  for (const CLI::App* sub : commands_of(command)) for_each_command(*sub, visit);
}

/// The shell's line that offers the values of an option or positional.
std::string offer(const OptionText& text) {
  const std::string words = CLI::detail::join(text.choices, " ");
  std::string line;
  if (!words.empty()) line += "_planecast_words \"" + words + "\"";
  if (text.takes_file) line += (line.empty() ? "" : "; ") + std::string("_planecast_paths -f");
  if (text.takes_folder) line += (line.empty() ? "" : "; ") + std::string("_planecast_paths -d");
  return line.empty() ? ":" : line;
}

std::string option_names(const CLI::App& command) {
  std::string names;
  for (const CLI::Option* option : options_of(command)) {
    for (const std::string& name : describe_option(*option).names) {
      names += (names.empty() ? "" : " ") + name;
    }
  }
  return names;
}

/// Cases of `command word`: the words that go one command further down.
std::string descent_cases(const CLI::App& root) {
  std::string text;
  for_each_command(root, [&text](const CLI::App& command) {
    for (const CLI::App* sub : commands_of(command)) {
      text += "      \"" + path_of(command) + "/" + sub->get_name() + "\") command=\"" +
              path_of(*sub) + "\" ;;\n";
    }
  });
  return text;
}

/// Cases of `command/option`: what follows an option with a value.
std::string value_cases(const CLI::App& root) {
  std::string text;
  for_each_command(root, [&text](const CLI::App& command) {
    for (const CLI::Option* option : options_of(command)) {
      const OptionText about = describe_option(*option);
      if (about.value.empty()) continue;
      std::string pattern;
      for (const std::string& name : about.names) {
        pattern += (pattern.empty() ? "\"" : " | \"") + path_of(command) + "/" + name + "\"";
      }
      text += "    " + pattern + ") " + offer(about) + "; return ;;\n";
    }
  });
  return text;
}

/// Cases of `command`: what can stand where no value is waited for.
std::string word_cases(const CLI::App& root) {
  std::string text;
  for_each_command(root, [&text](const CLI::App& command) {
    std::string words;
    for (const CLI::App* sub : commands_of(command)) words += sub->get_name() + " ";
    std::string line = words.empty() ? "" : "_planecast_words \"" + words + "\"";
    for (const CLI::Option* positional : positionals_of(command)) {
      line += (line.empty() ? "" : "; ") + offer(describe_option(*positional));
    }
    text += "    \"" + path_of(command) + "\")\n      options=\"" + option_names(command) +
            "\"\n      [[ $current == -* ]] || { " + (line.empty() ? ":" : line) +
            "; }\n      ;;\n";
  });
  return text;
}

}  // namespace

std::string bash_completion(const CLI::App& root) {
  return R"(# Bash completion of planecast, written by `planecast completion bash`.
_planecast_words() {
  local word
  while IFS= read -r word; do COMPREPLY+=("$word"); done < <(compgen -W "$1" -- "$current")
}

_planecast_paths() {
  local path
  compopt -o filenames 2>/dev/null
  while IFS= read -r path; do COMPREPLY+=("$path"); done < <(compgen "$1" -- "$current")
}

_planecast() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}
  local command="" options="" i
  COMPREPLY=()
  # Bash takes the = of --option=value for a word of its own.
  if [[ $current == "=" ]]; then
    current=""
  elif [[ $previous == "=" ]]; then
    previous=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "$command/${COMP_WORDS[i]}" in
)" + descent_cases(root) +
         R"(    esac
  done
  case "$command/$previous" in
)" + value_cases(root) +
         R"(  esac
  case "$command" in
)" + word_cases(root) +
         R"(  esac
  if [[ $current == -* ]]; then _planecast_words "$options"; fi
}
complete -F _planecast planecast
)";
}

}  // namespace planecast::app
