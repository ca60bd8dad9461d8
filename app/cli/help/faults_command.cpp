#include "app/cli/help/faults_command.h"

#include <bit>
#include <cstdint>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "base/write_text.h"
#include "session/process/exit_code.h"
#include "session/summary/each_fault.h"

namespace osteon::app {
namespace {

// Position of a fault's bit in the fault word, from 0.
int BitOf(safety::Fault fault) { return std::countr_zero(static_cast<std::uint32_t>(fault)); }

// Content of the file of `osteon faults --json`.
std::string FaultsJson() {
  nlohmann::ordered_json faults = nlohmann::json::array();
  session::ForEachFault([&](safety::Fault fault, const safety::FaultText& text) {
    faults.push_back({{"bit", BitOf(fault)},
                      {"name", text.name},
                      {"cause", text.cause},
                      {"reaction", text.reaction},
                      {"stop", static_cast<int>(safety::StopOf(fault))},
                      {"recovery", safety::AllowsRecovery(fault)},
                      {"clearing", text.clearing}});
  });
  return nlohmann::ordered_json{{"schema", "osteon.faults/1"}, {"faults", faults}}.dump(2) + "\n";
}

}  // namespace

std::string FaultsPage() {
  std::string page = "# What can stop the cell\n\n" +
                     base::WrapMarkdown(
                         "Written by `osteon faults --markdown docs/faults.md` from `safety/fault.cpp`. A "
                         "fault is latched: it stays until a new run. The recording has the bits by tick "
                         "(`faults`), `summary.json` the names and what was seen, and each stop leaves its "
                         "own page ([recording.md](recording.md)). What stop 0 and 1 are: "
                         "[states.md](states.md). Recovery: `osteon recover`, or `--recover`, may clear it "
                         "within the run.") +
                     "\n\n"
                     "| bit | fault | what was seen | stop | what the cell does | recovery | how to go on |\n"
                     "|---|---|---|---|---|---|---|\n";
  session::ForEachFault([&](safety::Fault fault, const safety::FaultText& text) {
    page += fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", BitOf(fault), text.name, text.cause,
                        static_cast<int>(safety::StopOf(fault)), text.reaction,
                        safety::AllowsRecovery(fault) ? "yes" : "", text.clearing);
  });
  return page;
}

int RunFaults(const FaultsOptions& options) {
  session::ForEachFault([](safety::Fault fault, const safety::FaultText& text) {
    fmt::print("{}\n  seen:  {}\n  does:  {}\n  stop:  {}{}\n  go on: {}\n", text.name, text.cause,
               text.reaction, static_cast<int>(safety::StopOf(fault)),
               safety::AllowsRecovery(fault) ? ", a recovery may clear it (osteon recover, --recover)" : "",
               text.clearing);
  });
  for (const auto& [file, text] :
       {std::pair(options.markdown, FaultsPage()), std::pair(options.json, FaultsJson())}) {
    if (file.empty()) continue;
    if (const auto written = base::WriteText(file, text); !written)
      return session::Fail("faults", written.error(), session::kFailed);
  }
  return 0;
}

}  // namespace osteon::app
