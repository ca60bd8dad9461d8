#include "app/cli/subcommands.h"

#include "app/cli/usage/usage.h"
#include "session/view/view.h"

namespace osteon::app {
namespace {

class ViewCommand final : public Subcommand {
 public:
  explicit ViewCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation&) override { return session::RunView(options_); }

 private:
  session::ViewOptions options_;
};

ViewCommand::ViewCommand(CLI::App& app)
    : Subcommand(app.add_subcommand("view", "shows a recording in a browser, with a time line")) {
  sub_->add_option("recordings", options_.recordings,
                   "the .mcap file of a run; two are shown side by side, with their difference")
      ->type_name("FILE")
      ->required()
      ->expected(1, 2)
      ->check(CLI::ExistingFile);
  sub_->add_option_function<int>(
          "--port",
          [this](const int& port) {
            options_.console.port = port;
            options_.console.only_this_port = true;
          },
          "port of the page on this machine; 0: any free one. Without it the first free one from 8470 on")
      ->check(PortNumber());
  sub_->add_option("--at", options_.at_s, "shown at first, in seconds since the session's start")
      ->type_name("SECONDS")
      ->check(NumberWithin(0.0, 86'400.0));
  sub_->add_option("--json", options_.json, "write the page's address there, as JSON")->type_name("FILE");
  sub_->footer(
      "Prints the page's address and serves it until Ctrl-C.\n\n"
      "Exit code 1: the page could not be served\n\n"
      "Examples:\n  osteon view demo_out/recording.mcap\n  osteon view run.mcap --port 9000\n"
      "  osteon view before.mcap after.mcap");
}

}  // namespace

void AddViewCommand(CLI::App& app, Subcommands& all) { all.push_back(std::make_unique<ViewCommand>(app)); }

}  // namespace osteon::app
