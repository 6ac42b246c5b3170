#pragma once

#include <CLI/CLI.hpp>
#include <initializer_list>
#include <string>
#include <vector>

namespace planecast::app {

/// A command line as one would type it, and what it does.
struct Example {
  std::string line;
  std::string what;
};

/// Sets the examples at the end of a command's help; the man page has them too.
void set_examples(CLI::App& command, std::initializer_list<Example> examples);

/// The options added in its lifetime stand under a heading of their own.
class OptionGroup {
 public:
  OptionGroup(CLI::App& command, const std::string& heading) : command_(command) {
    command_.option_defaults()->group(heading);
  }
  ~OptionGroup() { command_.option_defaults()->group("Options"); }
  OptionGroup(const OptionGroup&) = delete;
  OptionGroup& operator=(const OptionGroup&) = delete;

 private:
  CLI::App& command_;
};

/// What help, man page and completions say of an option.
struct OptionText {
  std::vector<std::string> names;    ///< "-o", "--output"; empty for a positional
  std::string value;                 ///< "DIR", "mono|rgbd|auto"; empty for a flag
  std::vector<std::string> choices;  ///< values to choose from; empty: anything
  bool takes_file = false;
  bool takes_folder = false;
  bool many = false;        ///< takes any number of values
  std::string description;  ///< with range and default
};
OptionText describe_option(const CLI::Option& option);

/// Visible options without the positionals, the positionals, and the visible subcommands.
std::vector<const CLI::Option*> options_of(const CLI::App& command);
std::vector<const CLI::Option*> positionals_of(const CLI::App& command);
std::vector<const CLI::App*> commands_of(const CLI::App& command);

/// "planecast evaluate planes" of the innermost command.
std::string full_name(const CLI::App& command);
/// "planecast track [OPTIONS] SEQUENCE".
std::string usage_of(const CLI::App& command);

/// Gives a command and those added to it later the help that describe_option() speaks.
void use_plain_help(CLI::App& command);

}  // namespace planecast::app
