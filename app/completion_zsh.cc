#include "app/completion_scripts.h"
#include "app/manual.h"

namespace planecast::app {
namespace {

/// Text inside single quotes, where _arguments takes [ ] : for itself.
std::string in_quotes(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\'') {
      result += "'\\''";
    } else {
      if (c == '[' || c == ']' || c == ':' || c == '\\') result += '\\';
      result += c;
    }
  }
  return result;
}

std::string function_of(const CLI::App& command) {
  return CLI::detail::find_and_replace("_" + full_name(command), " ", "_");
}

/// ":message:action" of a value.
std::string action_of(const OptionText& text) {
  const std::string words = CLI::detail::join(text.choices, " ");
  std::string action = " ";
  if (!words.empty()) action = "(" + words + ")";
  if (text.takes_file) action = words.empty() ? "_files" : " _planecast_or_files " + words;
  if (text.takes_folder) action = "_files -/";
  return ":" + in_quotes(text.value) + ":" + action;
}

std::string option_specs(const CLI::App& command) {
  std::string specs;
  for (const CLI::Option* option : options_of(command)) {
    const OptionText text = describe_option(*option);
    const std::string value = text.value.empty() ? "" : action_of(text);
    for (const std::string& name : text.names) {
      specs += " \\\n    '(" + CLI::detail::join(text.names, " ") + ")" + name + "[" +
               in_quotes(text.description) + "]" + value + "'";
    }
  }
  return specs;
}

std::string leaf_function(const CLI::App& command) {
  std::string text = function_of(command) + "() {\n  _arguments" + option_specs(command);
  for (const CLI::Option* positional : positionals_of(command)) {
    const OptionText about = describe_option(*positional);
    text += std::string(" \\\n    '") + (about.many ? "*" : "") + action_of(about) + "'";
  }
  return text + "\n}\n\n";
}

std::string branch_function(const CLI::App& command) {
  std::string described;
  std::string cases;
  for (const CLI::App* sub : commands_of(command)) {
    described += "\n        '" + sub->get_name() + ":" + in_quotes(sub->get_description()) + "'";
    cases += "        " + sub->get_name() + ") " + function_of(*sub) + " ;;\n";
  }
  return function_of(command) +
         "() {\n  local context state line\n  typeset -A opt_args\n  _arguments -C" +
         option_specs(command) +
         " \\\n    '1: :->command' '*:: :->rest'\n"
         "  case $state in\n    command)\n      local -a commands\n      commands=(" +
         described +
         "\n      )\n      _describe command commands\n      ;;\n    rest)\n"
         "      case $words[1] in\n" +
         cases + "      esac\n      ;;\n  esac\n}\n\n";
}

std::string functions(const CLI::App& command) {
  const auto below = commands_of(command);
  std::string text;
  for (const CLI::App* sub : below) text += functions(*sub);
  return text + (below.empty() ? leaf_function(command) : branch_function(command));
}

}  // namespace

std::string zsh_completion(const CLI::App& root) {
  return R"(#compdef planecast
# Zsh completion of planecast, written by `planecast completion zsh`.

_planecast_or_files() {
  compadd -- "$@"
  _files
}

)" + functions(root) +
         R"(if [ "$funcstack[1]" = "_planecast" ]; then
  _planecast "$@"
else
  compdef _planecast planecast
fi
)";
}

}  // namespace planecast::app
