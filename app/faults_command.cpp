#include "app/faults_command.h"

#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/summary.h"
#include "safety/fault.h"

namespace osteon::app {
namespace {

constexpr int kFailed = 1;

template <class Each>
void ForEachFault(Each&& each) {
  for (int bit = 0; bit < safety::kFaultCount; ++bit)
    each(bit, safety::Describe(static_cast<safety::Fault>(1u << bit)));
}

std::string Json() {
  nlohmann::ordered_json faults = nlohmann::json::array();
  ForEachFault([&](int bit, const safety::FaultText& text) {
    faults.push_back({{"bit", bit},
                      {"name", text.name},
                      {"cause", text.cause},
                      {"reaction", text.reaction},
                      {"clearing", text.clearing}});
  });
  return nlohmann::ordered_json{{"schema", "osteon.faults/1"}, {"faults", faults}}.dump(2) + "\n";
}

}  // namespace

std::string FaultsPage() {
  std::string page =
      "# What can stop the cell\n\n"
      "Written by `osteon faults --markdown docs/faults.md` from `safety/fault.cpp`. A fault is latched: it "
      "stays until the\nsession is begun anew. The recording has the bits by tick (`faults`), `summary.json` "
      "the names, and each stop leaves\nits own page (docs/recording.md).\n\n"
      "| bit | fault | what was seen | what the cell does | how to go on |\n|---|---|---|---|---|\n";
  ForEachFault([&](int bit, const safety::FaultText& text) {
    page +=
        fmt::format("| {} | {} | {} | {} | {} |\n", bit, text.name, text.cause, text.reaction, text.clearing);
  });
  return page;
}

int RunFaults(const FaultsOptions& options) {
  ForEachFault([](int, const safety::FaultText& text) {
    fmt::print("{}\n  seen:  {}\n  does:  {}\n  go on: {}\n", text.name, text.cause, text.reaction,
               text.clearing);
  });
  for (const auto& [file, text] :
       {std::pair(options.markdown, FaultsPage()), std::pair(options.json, Json())}) {
    if (file.empty()) continue;
    if (const auto written = WriteText(file, text); !written) {
      fmt::print(stderr, "osteon faults: {}\n", written.error());
      return kFailed;
    }
  }
  return 0;
}

}  // namespace osteon::app
