#include "app/cli/usage/console_option.h"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/cli/usage/usage.h"

namespace osteon::app {

namespace {

// Adds an option whose value is the port or address at which something is served, or "off".
void AddServerOption(CLI::App& sub, const char* name, session::ConsoleChoice& choice,
                     const std::string& help) {
  sub.add_option_function<std::string>(
         name,
         [name, &choice](const std::string& text) {
           auto parsed = session::ConsoleChoice::Parse(text);
           if (!parsed) throw CLI::ValidationError(name, parsed.error());
           choice = *parsed;
         },
         help)
      ->type_name("PORT");
}

}  // namespace

void AddConsoleOption(CLI::App& sub, session::ConsoleChoice& choice) {
  AddServerOption(
      sub, "--console", choice,
      fmt::format("where the page that shows the cell is served: PORT, ADDRESS:PORT, or off; an address "
                  "other than the loopback asks for a token. Without it the first free port from {} on",
                  console::kDefaultPort));
}

void AddTuneOption(CLI::App& sub, std::filesystem::path& tune) {
  sub.add_option("--tune", tune,
                 fmt::format("tune.json of `osteon tune` for this cell and its gains: the page shows what it "
                             "recommends and the margin. Without it {}, where that is of this cell",
                             session::kTuneFile))
      ->type_name("FILE")
      ->check(CLI::ExistingFile);
}

void AddIdentifiedOption(CLI::App& sub, std::filesystem::path& identified) {
  sub.add_option(
         "--identified", identified,
         "a file of `osteon identify` for this cell, instead of the cell's own: the simulated arm, the "
         "dead zone and the vibration index have what was measured")
      ->check(CLI::ExistingFile)
      ->type_name("FILE");
}

void AddFoxgloveOption(CLI::App& sub, session::ConsoleChoice& foxglove) {
  AddServerOption(
      sub, "--foxglove", foxglove,
      fmt::format("where Foxglove and Lichtblick connect to, which show the cell and can do nothing to it: "
                  "PORT (they propose {}), ADDRESS:PORT, or off, which holds without it; an address other "
                  "than the loopback asks for a token",
                  console::kFoxglovePort));
}

void AddRecordBoneOption(CLI::App& sub, double& step_s) {
  sub.add_option("--record-bone", step_s,
                 "seconds from one state of the carved bone to the next in the recording, for Foxglove and "
                 "Lichtblick; 0: the recording is without the bone")
      ->check(NumberWithin(0.0, 3600.0))
      ->capture_default_str();
}

void AddAtFaultOption(CLI::App& sub, const std::string& otherwise, std::function<void(bool hold)> choose) {
  sub.add_option_function<std::string>(
         "--at-fault", [choose = std::move(choose)](const std::string& text) { choose(text == "hold"); },
         "after a fault that allows a recovery (`osteon faults`): hold: the arm stays at rest until `osteon "
         "recover`, Recover in the console, or a stop; end: the run ends. Without it " +
             otherwise)
      ->check(OneOf({"hold", "end"}));
}

}  // namespace osteon::app
