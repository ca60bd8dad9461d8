#include "studies/bench/bench_console.h"

#include <csignal>

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <regex>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/child_process.h"
#include "base/interrupt.h"
#include "base/json_text.h"
#include "base/read_text.h"
#include "base/work_folder.h"
#include "base/write_text.h"
#include "console/server/page_client.h"
#include "session/process/exit_code.h"
#include "session/setup/build_name.h"

namespace osteon::studies {
namespace {

constexpr int kPages = 8;
constexpr std::chrono::seconds kPatience{60};
constexpr std::chrono::milliseconds kLooks{50};

enum class Leg : std::uint8_t { kOff, kIdle, kEight, kBrowser };
constexpr std::array<const char*, 4> kLegs{"off", "on, no page", "eight pages, one stuck",
                                           "one page in a browser"};

struct Figure {
  const char *key, *part, *name;
};
constexpr std::array<Figure, 4> kFigures{
    Figure{"compute_us", "p50", "tick compute p50"}, Figure{"compute_us", "p99", "tick compute p99"},
    Figure{"wakeup_us", "p99", "tick wake-up p99"}, Figure{"frame_us", "p50", "frame p50"}};

// Waits for the console's port in a demo's output. 0: the demo has ended.
int AwaitPort(base::ChildProcess& demo, const std::filesystem::path& err) {
  static const std::regex kAddress("console: http://127\\.0\\.0\\.1:([0-9]+)/");
  for (const auto end = std::chrono::steady_clock::now() + kPatience;
       std::chrono::steady_clock::now() < end;) {
    std::smatch found;
    const std::string text = base::ReadText(err);
    if (std::regex_search(text, found, kAddress)) return std::stoi(found[1]);
    if (demo.Ended() || base::Interrupted().load()) return 0;
    std::this_thread::sleep_for(kLooks);
  }
  return 0;
}

// Runs one demo. @returns its summary; null if it failed
nlohmann::json RunDemoWith(Leg leg, const BenchConsoleOptions& options, const std::filesystem::path& folder) {
  std::error_code error;
  const std::filesystem::path json = folder / "summary.json", err = folder / "err.txt";
  std::filesystem::remove(json, error);
  auto demo =
      base::ChildProcess::Start({.words = {"demo", "--seconds", fmt::format("{:g}", options.seconds), "--out",
                                           (folder / "out").string(), "--overwrite", "--port", "0", "--json",
                                           json.string(), "--console", leg == Leg::kOff ? "off" : "0"},
                                 .program = base::ProgramBeside("osteon"),
                                 .out = folder / "out.txt",
                                 .err = err});
  if (!demo) return nullptr;
  std::vector<std::unique_ptr<console::PageClient>> pages;
  std::unique_ptr<base::ChildProcess> browser;
  if (const int port = leg == Leg::kOff ? 0 : AwaitPort(**demo, err); port > 0) {
    if (leg == Leg::kEight)
      for (int i = 0; i < kPages; ++i)
        if (auto page = console::PageClient::Open("127.0.0.1", port, i > 0))
          pages.push_back(std::move(*page));
    if (leg == Leg::kBrowser)
      if (auto started = base::ChildProcess::Start(
              {.words = {"--headless", "--no-sandbox", "--remote-debugging-port=0", "--use-gl=angle",
                         "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--window-size=1280,720",
                         "--user-data-dir=" + (folder / "browser").string(),
                         fmt::format("http://127.0.0.1:{}/", port)},
               .program = options.chromium,
               .out = folder / "browser.txt",
               .err = folder / "browser_err.txt"}))
        browser = std::move(*started);
  }
  while (!(*demo)->Ended() && !base::Interrupted().load()) std::this_thread::sleep_for(kLooks);
  if (browser) browser->Send(SIGTERM);
  pages.clear();
  if (base::Interrupted().load()) return nullptr;
  return nlohmann::json::parse(base::ReadText(json), nullptr, false);
}

double MedianOf(std::vector<double> values) {
  std::ranges::sort(values);
  return values.empty() ? 0.0 : values[values.size() / 2];
}

}  // namespace

int RunBenchConsole(const BenchConsoleOptions& options) {
  base::InstallInterrupt();
  const base::WorkFolder folder("bench_console");
  std::vector<Leg> legs{Leg::kOff, Leg::kIdle, Leg::kEight};
  if (!options.chromium.empty()) legs.push_back(Leg::kBrowser);
  std::array<std::array<std::vector<double>, kFigures.size()>, kLegs.size()> seen;
  for (int round = 0; round < options.rounds; ++round)
    for (const Leg leg : legs) {
      const nlohmann::json summary = RunDemoWith(leg, options, folder.path());
      if (base::Interrupted().load()) return base::InterruptExitCode();
      if (!summary.is_object())
        return session::Fail("bench console", "a demo failed:\n" + base::ReadText(folder.path() / "err.txt"),
                             session::kFailed);
      for (std::size_t i = 0; i < kFigures.size(); ++i)
        seen[static_cast<std::size_t>(leg)][i].push_back(
            summary[kFigures[i].key].value(kFigures[i].part, 0.0));
      fmt::print(stderr, "osteon bench console: round {} of {}: {}\n", round + 1, options.rounds,
                 kLegs[static_cast<std::size_t>(leg)]);
    }

  nlohmann::ordered_json json{
      {"schema", "osteon.bench.console/1"}, {"rounds", options.rounds},
      {"seconds", options.seconds},         {"machine", session::MachineName()},
      {"build", session::BuildName()},      {"legs", nlohmann::ordered_json::array()}};
  fmt::print("Osteon bench console: medians of {} rounds of {:g} s, and their ratios to off\n",
             options.rounds, options.seconds);
  for (const Leg leg : legs) {
    const auto l = static_cast<std::size_t>(leg);
    nlohmann::ordered_json row{{"leg", kLegs[l]}};
    fmt::print("  {}\n", kLegs[l]);
    for (std::size_t i = 0; i < kFigures.size(); ++i) {
      const double median = MedianOf(seen[l][i]), off = MedianOf(seen[0][i]);
      const double ratio = off > 0.0 ? median / off : 0.0;
      fmt::print("    {:<20} {:8.1f} µs   {:5.2f}\n", kFigures[i].name, median, ratio);
      row[fmt::format("{}_{}", kFigures[i].key, kFigures[i].part)] = {{"median", median}, {"ratio", ratio}};
    }
    json["legs"].push_back(row);
  }
  if (!options.json.empty())
    if (const auto written = base::WriteText(options.json, base::JsonText(json)); !written)
      return session::Fail("bench console", written.error(), session::kFailed);
  return 0;
}

}  // namespace osteon::studies
