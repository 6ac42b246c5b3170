#include <cstdio>
#include <memory>
#include <string>

#include "app/commands.h"
#include "app/completion_scripts.h"
#include "app/manual.h"
#include "app/options.h"

namespace planecast::app {

void add_completion(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("completion", "Print a script that completes planecast's command line");
  auto shell = std::make_shared<std::string>();
  command->add_option("shell", *shell, "Shell to complete for")
      ->required()
      ->type_name("SHELL")
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  set_examples(*command, {{"source <(planecast completion bash)", "Complete in this shell"},
                          {"planecast completion fish > ~/.config/fish/completions/planecast.fish",
                           "Complete in every shell to come"}});
  command->callback([&app, shell, &action] {
    action = [&app, shell] {
      const std::string script = *shell == "bash"  ? bash_completion(app)
                                 : *shell == "zsh" ? zsh_completion(app)
                                                   : fish_completion(app);
      std::fputs(script.c_str(), stdout);
      return kDone;
    };
  });
}

}  // namespace planecast::app
