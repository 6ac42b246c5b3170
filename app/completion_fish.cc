#include "app/completion_scripts.h"
#include "app/manual.h"

namespace planecast::app {
namespace {

std::string in_quotes(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') result += '\\';
    result += c;
  }
  return result + "'";
}

/// The condition under which the completions of a command hold: its name was seen, none below it.
std::string condition_of(const CLI::App& command) {
  std::string below;
  for (const CLI::App* sub : commands_of(command)) below += " " + sub->get_name();
  if (command.get_parent() == nullptr) return "not __fish_seen_subcommand_from" + below;
  std::string condition = "__fish_seen_subcommand_from " + command.get_name();
  if (command.get_parent()->get_parent() != nullptr) {
    condition =
        "__fish_seen_subcommand_from " + command.get_parent()->get_name() + "; and " + condition;
  }
  return below.empty() ? condition : condition + "; and not __fish_seen_subcommand_from" + below;
}

std::string values_of(const OptionText& text) {
  std::string flags = text.takes_file ? " -r -F" : " -x";
  std::string words = CLI::detail::join(text.choices, " ");
  if (text.takes_folder) words = "(__fish_complete_directories)";
  if (!words.empty()) flags += " -a " + in_quotes(words);
  return flags;
}

std::string option_line(const std::string& start, const CLI::Option& option) {
  const OptionText text = describe_option(option);
  std::string line = start;
  for (const std::string& name : text.names) {
    line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  }
  if (!text.value.empty()) line += values_of(text);
  return line + " -d " + in_quotes(text.description) + "\n";
}

std::string positional_line(const std::string& start, const CLI::Option& positional) {
  const OptionText text = describe_option(positional);
  if (text.takes_file || text.takes_folder) return start + " -F\n";
  if (text.choices.empty()) return "";
  return start + " -a " + in_quotes(CLI::detail::join(text.choices, " ")) + "\n";
}

std::string lines_of(const CLI::App& command) {
  const std::string start = "complete -c planecast -n " + in_quotes(condition_of(command));
  std::string text;
  for (const CLI::App* sub : commands_of(command)) {
    text += start + " -a " + sub->get_name() + " -d " + in_quotes(sub->get_description()) + "\n";
  }
  for (const CLI::Option* option : options_of(command)) text += option_line(start, *option);
  for (const CLI::Option* positional : positionals_of(command)) {
    text += positional_line(start, *positional);
  }
  for (const CLI::App* sub : commands_of(command)) text += lines_of(*sub);
  return text;
}

}  // namespace

std::string fish_completion(const CLI::App& root) {
  return "# Fish completion of planecast, written by `planecast completion fish`.\n"
         "complete -c planecast -f\n" +
         lines_of(root);
}

}  // namespace planecast::app
