#include "app/man_page.h"

#include <sstream>

#include "app/manual.h"

namespace planecast::app {
namespace {

/// Text as man(7) prints it: backslashes and hyphens as they are, no line a request.
std::string roff(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else {
      const bool line_begins = result.empty() || result.back() == '\n';
      if (line_begins && (c == '.' || c == '\'')) result += "\\&";
      result += c;
    }
  }
  return result;
}

std::string option_entry(const CLI::Option& option) {
  const OptionText text = describe_option(option);
  std::string entry = ".TP\n";
  for (std::size_t i = 0; i < text.names.size(); ++i) {
    entry += (i == 0 ? "\\fB" : ", \\fB") + roff(text.names[i]) + "\\fR";
  }
  if (!text.value.empty()) {
    entry += std::string(text.names.empty() ? "" : " ") + "\\fI" + roff(text.value) + "\\fR";
  }
  return entry + (text.many ? "...\n" : "\n") + roff(text.description) + "\n";
}

/// The lines of examples, two columns further in and without filling.
std::string footer(const std::string& text) {
  if (text.empty()) return "";
  return ".PP\n.nf\n" + roff(text) + "\n.fi\n";
}

std::string command_section(const CLI::App& command) {
  std::string text = ".SS " + roff(full_name(command)) + "\n" + roff(command.get_description()) +
                     "\n.PP\n.B " + roff(usage_of(command)) + "\n";
  for (const CLI::Option* option : positionals_of(command)) text += option_entry(*option);
  for (const CLI::Option* option : options_of(command)) {
    if (option != command.get_help_ptr()) text += option_entry(*option);
  }
  text += footer(command.get_footer());
  for (const CLI::App* sub : commands_of(command)) text += command_section(*sub);
  return text;
}

}  // namespace

std::string man_page(const CLI::App& root, const std::string& version) {
  std::ostringstream page;
  page << ".TH PLANECAST 1 \"\" \"planecast " << version << "\" \"User Commands\"\n"
       << ".ad l\n"  // long names of options leave no room for even margins
       << ".SH NAME\nplanecast \\- put glTF objects on the planes of a recorded image sequence\n"
       << ".SH SYNOPSIS\n.B " << roff(usage_of(root)) << "\n"
       << ".SH DESCRIPTION\n"
       << roff(root.get_description()) << "\n"
       << ".SH OPTIONS\n";
  for (const CLI::Option* option : options_of(root)) page << option_entry(*option);
  page << ".SH COMMANDS\n";
  for (const CLI::App* command : commands_of(root)) page << command_section(*command);
  page << ".SH NOTES\n" << footer(root.get_footer());
  return page.str();
}

}  // namespace planecast::app
