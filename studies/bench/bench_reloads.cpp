#include "studies/bench/bench_reloads.h"

#include <csignal>

#include <chrono>
#include <string>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/child_process.h"
#include "base/interrupt.h"
#include "base/json_text.h"
#include "base/json_value.h"
#include "base/read_text.h"
#include "base/work_folder.h"
#include "base/write_text.h"
#include "session/process/exit_code.h"
#include "session/setup/build_name.h"
#include "session/summary/chart_files.h"
#include "studies/bench/page_reloads.h"

namespace osteon::studies {
namespace {

constexpr double kLongest_s = 3600.0;       // longest duration of the demo, which is ended after the reloads
constexpr std::chrono::seconds kEnds{120};  // longest wait for the demo's end after SIGINT
constexpr double kStarts_s = 60.0;          // longest wait until the demo's arm moves
constexpr std::chrono::seconds kAfterStart{1};  // from the page that awaits the motion to the reloads
constexpr int kTellEvery = 100;                 // reloads from one line of progress to the next

nlohmann::json JsonOf(const ProcessHolds& holds) {
  return {{"resident_MB", holds.resident_MB}, {"descriptors", holds.descriptors}, {"threads", holds.threads}};
}

void PrintHolds(const char* name, const ProcessHolds& holds) {
  fmt::print("  {:<28} {:8.1f} MB  {:4} descriptors  {:4} threads\n", name, holds.resident_MB,
             holds.descriptors, holds.threads);
}

}  // namespace

int RunBenchReloads(const BenchConsoleOptions& options) {
  const base::WorkFolder folder("bench_reloads");
  const std::filesystem::path json = folder.path() / "summary.json", err = folder.path() / "err.txt";
  // a machine that wakes a thread late causes a fault; the demo is held then, so that its console goes on
  auto demo = base::ChildProcess::Start(
      {.words = {"demo", "--seconds", fmt::format("{:g}", kLongest_s), "--at-fault", "hold", "--out",
                 (folder.path() / "out").string(), "--port", "0", "--json", json.string(), "--console", "0"},
       .program = base::ProgramBeside("osteon"),
       .out = folder.path() / "out.txt",
       .err = err});
  if (!demo) return session::Fail("bench console", demo.error(), session::kFailed);
  const int port = AwaitConsolePort(**demo, err);
  if (port == 0)
    return session::Fail("bench console", "a demo failed:\n" + base::ReadText(err), session::kFailed);
  // The demo connects to its PLC after it has named the port, and moves only with this connection. If a fault
  // keeps the arm from moving, the reloads are measured nevertheless.
  const auto page_port = static_cast<std::uint16_t>(port);
  const auto moves = LoadPageAndLeave("127.0.0.1", page_port, PageEnd::kCloses, PageStay::kMotion, kStarts_s);
  if (!moves) fmt::print(stderr, "osteon bench console: {}\n", moves.error());
  std::this_thread::sleep_for(kAfterStart);
  const ReloadFigures figures =
      ReloadPages("127.0.0.1", page_port, (*demo)->pid(), options.reloads, [&](int done) {
        if (done % kTellEvery == 0)
          fmt::print(stderr, "osteon bench console: {} of {} reloads\n", done, options.reloads);
        return !(*demo)->Ended() && !base::Interrupted().load();
      });
  (*demo)->Send(SIGINT);
  (*demo)->End(kEnds);
  if (base::Interrupted().load()) return base::InterruptExitCode();
  const auto summary = nlohmann::json::parse(base::ReadText(json), nullptr, false);
  const nlohmann::json faults = base::ValueAt(summary, "faults");
  const bool without_fault = faults.is_array() && faults.empty();
  const bool all = figures.loaded == options.reloads, flat = LeftNothing(figures);

  fmt::print("Osteon bench console: {} pages loaded and left during a demo, {} of them killed, in {:.0f} s\n",
             figures.loaded, figures.killed, figures.seconds);
  PrintHolds("before", figures.before);
  PrintHolds("after a tenth of them", figures.warm);
  PrintHolds("after all", figures.after);
  fmt::print("  {:<28} {}\n", "left behind", flat ? "nothing" : "descriptors, threads or memory");
  fmt::print("  {:<28} {}\n", "faults of the demo", without_fault ? "none" : faults.dump());
  for (const std::string& failed : figures.failed) fmt::print("  {:<28} {}\n", "not loaded", failed);
  const auto part = [&](const char* key, const char* which) {
    return base::NumberAt(base::ValueAt(summary, key), which);
  };
  fmt::print("  {:<28} compute {:.0f} µs, wake-up {:.0f} µs (99 % below)\n", "tick",
             part("compute_us", "p99"), part("wakeup_us", "p99"));
  const nlohmann::json result{{"schema", "osteon.bench.console.reloads/1"},
                              {"machine", session::MachineName()},
                              {"build", session::BuildName()},
                              {"reloads", options.reloads},
                              {"loaded", figures.loaded},
                              {"killed", figures.killed},
                              {"seconds", figures.seconds},
                              {"failed", figures.failed},
                              {"before", JsonOf(figures.before)},
                              {"warm", JsonOf(figures.warm)},
                              {"after", JsonOf(figures.after)},
                              {"left_nothing", flat},
                              {"faults", faults},
                              {"compute_us", base::ValueAt(summary, "compute_us")},
                              {"wakeup_us", base::ValueAt(summary, "wakeup_us")}};
  if (!options.json.empty())
    if (const auto written = base::WriteText(options.json, base::JsonText(result)); !written)
      return session::Fail("bench console", written.error(), session::kFailed);
  return all && flat && without_fault ? 0 : session::kFailed;
}

}  // namespace osteon::studies
