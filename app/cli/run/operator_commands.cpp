#include "app/cli/subcommands.h"

#include <array>

#include "app/cli/usage/usage.h"
#include "session/run/ask_running_cell.h"

namespace osteon::app {
namespace {

// A subcommand that sends a request to the running cell: its name, its line of help, and its footer.
struct Request {
  const char *name, *help, *footer;
};
constexpr double kMaxPid = 4194304;  // Linux's PID_MAX_LIMIT

constexpr std::array<Request, 5> kRequests{
    Request{"pause", "pauses the running cell: it brakes to rest and stays under power",
            "Exit code 1: no cell runs, or nothing moves that could be paused\n\nExamples:\n  osteon pause"},
    Request{"resume", "ends the pause of the running cell",
            "Exit code 1: no cell runs, or it is not paused\n\nExamples:\n  osteon resume"},
    Request{"recover", "clears the faults of a cell that is held at them, and lets it begin anew",
            "The state machine checks each condition of motion again; rendering then begins where the arm "
            "stands.\n\n"
            "Exit code 1: no cell runs, or its fault asks for a new run (the reason is said)\n\n"
            "Examples:\n  osteon recover"},
    Request{"stop", "ends the running cell in order, as at the end of its time",
            "Exit code 1: no cell runs\n\nExamples:\n  osteon stop"},
    Request{"status", "tells what the running cell does, and what is missing for motion",
            "Exit code 1: no cell runs\n\nExamples:\n  osteon status\n  osteon status --json status.json"}};

class OperatorCommand final : public Subcommand {
 public:
  OperatorCommand(CLI::App& app, const Request& request)
      : Subcommand(app.add_subcommand(request.name, request.help)) {
    options_.request = request.name;
    sub_->add_option("--pid", options_.pid, "process number of the run, where several run")
        ->check(NumberWithin(1.0, kMaxPid));
    sub_->add_option("--json", options_.json, "also write the answer there, as JSON")->type_name("FILE");
    sub_->footer(request.footer);
  }
  [[nodiscard]] int Run(const Invocation&) override { return session::RunAsk(options_); }

 private:
  session::AskOptions options_;
};

}  // namespace

void AddOperatorCommands(CLI::App& app, Subcommands& all) {
  for (const Request& request : kRequests) all.push_back(std::make_unique<OperatorCommand>(app, request));
}

}  // namespace osteon::app
