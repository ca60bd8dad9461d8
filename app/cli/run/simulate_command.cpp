#include "app/cli/subcommands.h"

#include <charconv>
#include <string>

#include <fmt/format.h>

#include "app/cli/usage/cell_file.h"
#include "app/cli/usage/usage.h"
#include "config/reading/load.h"
#include "session/process/exit_code.h"
#include "session/run/simulate.h"
#include "session/setup/engine_choice.h"

namespace osteon::app {
namespace {

// Parses "127.0.0.1:30300" into options.address and options.port. False if the text has another form.
bool ParseListen(const std::string& text, session::SimulateOptions& options) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos || colon == 0) return false;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data() + colon + 1, end, options.port);
  options.address = text.substr(0, colon);
  return rest == end && error == std::errc{};
}

class SimulateCommand final : public Subcommand {
 public:
  explicit SimulateCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  session::SimulateOptions options_;
  std::string cell_, listen_;
};

SimulateCommand::SimulateCommand(CLI::App& app)
    : Subcommand(
          app.add_subcommand("simulate", "runs the cutting engine in a process of its own, for runs")) {
  CLI::Option* cell =
      sub_->add_option("cell", cell_,
                       "a name under cells/, or a cell's YAML file: address, port and token of "
                       "its section simulation");
  cell->type_name("CELL");
  CLI::Option* listen =
      sub_->add_option("--listen", listen_,
                       "address and port (UDP) for runs; beyond the loopback with --token-file")
          ->type_name("WHERE")
          ->default_str(fmt::format("127.0.0.1:{}", session::kSimulatePort));
  sub_->add_option("--token-file", options_.token_file,
                   "file whose first line a run must know; the run's cell names a copy")
      ->type_name("FILE");
  sub_->add_option("--local", options_.local,
                   "the folder in shared memory of a run on this machine, which starts this by itself "
                   "(simulation: {process: local} in its cell)")
      ->type_name("FOLDER")
      ->excludes(listen)
      ->excludes(cell);
  AddEngineOption(*sub_, options_.engine, session::WallTimeEngineNames(), "the cutting engine",
                  "; cpu: one thread, no GPU");
  AddDeviceOption(*sub_, options_.device);
  sub_->add_option("--json", options_.json, "write a summary there at the end, as JSON")->type_name("FILE");
  sub_->footer(
      "A run sends bone, tool and poses, and gets contact models back. If this process ends, hangs or is "
      "late, the servo loop sees an old model and brings the arm to rest.\n\n"
      "Exit code 1: no engine could be made, or the file could not be written\n\n"
      "Examples:\n  osteon simulate\n  osteon simulate --listen 192.168.1.7:30300 --token-file token.txt\n"
      "  osteon simulate my_cell.yaml --engine cpu");
}

int SimulateCommand::Run(const Invocation& invocation) {
  const auto refuse = [](const std::string& what) { return session::Fail("simulate", what); };
  if (!cell_.empty()) {
    const auto found = FindCell(invocation.config_root, cell_);
    if (!found) return refuse(found.error());
    const auto process = config::LoadCell(*found).engine_process;
    if (!process || process->host.empty())
      return refuse(fmt::format("{}: found no simulation: {{process: HOST:PORT}}, accepted a cell with it",
                                found->string()));
    options_.address = process->host;
    options_.port = process->port;
    if (!process->token_file.empty() && options_.token_file.empty())
      options_.token_file = found->parent_path() / process->token_file;
  }
  if (!listen_.empty() && !ParseListen(listen_, options_))
    return refuse(fmt::format("--listen: found {}, accepted ADDRESS:PORT such as 127.0.0.1:{}", listen_,
                              session::kSimulatePort));
  return session::RunSimulate(options_);
}

}  // namespace

void AddSimulateCommand(CLI::App& app, Subcommands& all) {
  all.push_back(std::make_unique<SimulateCommand>(app));
}

}  // namespace osteon::app
