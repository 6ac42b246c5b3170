#include "app/manual.h"

#include <algorithm>
#include <memory>
#include <sstream>

#include "engine/sequence/camera_file.h"
#include "engine/sequence/synth.h"

namespace planecast::app {
namespace {

constexpr int kColumn = 30;
constexpr int kWidth = 96;
/// Choices that are longer together stand in the description.
constexpr std::size_t kLongestValue = 40;

std::string join(const std::vector<std::string>& words, const std::string& between) {
  return CLI::detail::join(words, between);
}

/// Choices that a value's name stands for.
std::vector<std::string> choices_named(const std::string& value) {
  if (value == "SCENE") return engine::synthetic_scene_names();
  if (value == "PRESET|FILE") return engine::camera_preset_names();
  return {};
}

/// Breaks a text into lines of at most `width` and puts `indent` spaces before all but the first.
std::string wrap(const std::string& text, int width, int indent) {
  std::istringstream words(text);
  std::string result;
  int column = 0;
  for (std::string word; words >> word;) {
    const int length = static_cast<int>(word.size());
    if (column > 0 && column + 1 + length > width) {
      result += "\n" + std::string(static_cast<std::size_t>(indent), ' ');
      column = 0;
    }
    if (column > 0) result += ' ';
    result += word;
    column += length + (column > 0 ? 1 : 0);
  }
  return result;
}

std::string two_columns(const std::string& left, const std::string& right) {
  std::string line = "  " + left;
  if (line.size() + 2 > kColumn) {
    line += "\n" + std::string(kColumn, ' ');
  } else {
    line.resize(kColumn, ' ');
  }
  return line + wrap(right, kWidth - kColumn, kColumn) + "\n";
}

class PlainHelp : public CLI::Formatter {
 public:
  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    const OptionText text = describe_option(*option);
    std::string left = is_positional ? text.value : join(text.names, ", ");
    if (!is_positional && !text.value.empty()) left += " " + text.value;
    return two_columns(left + (text.many ? "..." : ""), text.description);
  }
  std::string make_subcommand(const CLI::App* command) const override {
    return two_columns(command->get_name(), command->get_description());
  }
  std::string make_description(const CLI::App* command) const override {
    return wrap(command->get_description(), kWidth, 0) + "\n\n";
  }
  std::string make_usage(const CLI::App* command, std::string) const override {
    return "Usage: " + usage_of(*command) + "\n";
  }
  std::string make_positionals(const CLI::App* command) const override {
    const auto positionals = positionals_of(*command);
    return positionals.empty() ? "" : make_group("Arguments", true, positionals);
  }
};

}  // namespace

void set_examples(CLI::App& command, std::initializer_list<Example> examples) {
  std::string text = "Examples:\n";
  for (const Example& example : examples) {
    text += "  " + example.line + "\n      " + wrap(example.what, kWidth - 6, 6) + "\n";
  }
  text.pop_back();
  command.footer(text);
}

OptionText describe_option(const CLI::Option& option) {
  OptionText text;
  for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
  text.description = option.get_description();
  if (option.get_type_size() == 0) return text;

  // "MODE:{mono,rgbd}", "N:INT in [1 - 256]", "A:B": CLI11 appends what the checks say.
  const std::string type = option.get_type_name();
  text.value = type;
  if (const std::size_t list = type.find(":{"); list != std::string::npos) {
    text.value = type.substr(0, list);
    text.choices = CLI::detail::split(type.substr(list + 2, type.size() - list - 3), ',');
    const std::string words = join(text.choices, "|");
    if (words.size() > kLongestValue) {
      text.description += ": " + join(text.choices, ", ");
    } else if (option.nonpositional()) {
      text.value = words;
    }
  } else if (const std::size_t range = type.find(" in ["); range != std::string::npos) {
    text.value = type.substr(0, type.find(':'));
    const std::string limits = type.substr(range + 5, type.find(']', range) - range - 5);
    const std::size_t dash = limits.find(" - ");
    text.description += " (" + limits.substr(0, dash) + " to " + limits.substr(dash + 3) + ")";
  } else if (type.ends_with(":NONNEGATIVE") || type.ends_with(":POSITIVE")) {
    text.value = type.substr(0, type.rfind(':'));
  }
  for (const std::string& word : choices_named(text.value)) text.choices.push_back(word);
  text.takes_file = text.value.find("FILE") != std::string::npos || text.value == "SEQUENCE";
  text.takes_folder = text.value == "DIR";
  text.many = option.get_expected_max() == CLI::detail::expected_max_vector_size;
  if (!option.get_default_str().empty()) {
    text.description += " (default: " + option.get_default_str() + ")";
  }
  return text;
}

std::vector<const CLI::Option*> options_of(const CLI::App& command) {
  return command.get_options([](const CLI::Option* option) {
    return option->nonpositional() && !option->get_group().empty();
  });
}

std::vector<const CLI::Option*> positionals_of(const CLI::App& command) {
  return command.get_options([](const CLI::Option* option) { return option->get_positional(); });
}

std::vector<const CLI::App*> commands_of(const CLI::App& command) {
  return command.get_subcommands(
      [](const CLI::App* sub) { return !sub->get_name().empty() && !sub->get_group().empty(); });
}

std::string full_name(const CLI::App& command) {
  const std::string own = command.get_name();
  return command.get_parent() == nullptr ? own : full_name(*command.get_parent()) + " " + own;
}

std::string usage_of(const CLI::App& command) {
  std::string usage = full_name(command);
  if (!commands_of(command).empty()) return usage + " COMMAND [OPTIONS]";
  usage += " [OPTIONS]";
  for (const CLI::Option* positional : positionals_of(command)) {
    const OptionText text = describe_option(*positional);
    const std::string name = text.value + (text.many ? "..." : "");
    usage += positional->get_required() ? " " + name : " [" + name + "]";
  }
  for (const CLI::Option* option : options_of(command)) {
    if (!option->get_required()) continue;
    const OptionText text = describe_option(*option);
    usage += " " + text.names.front() + " " + text.value;
  }
  return usage;
}

void use_plain_help(CLI::App& command) { command.formatter(std::make_shared<PlainHelp>()); }

}  // namespace planecast::app
