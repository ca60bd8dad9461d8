#include "studies/bench/bench_console.h"

#include <csignal>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <thread>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/child_process.h"
#include "base/interrupt.h"
#include "base/json_text.h"
#include "base/json_value.h"
#include "base/percentile.h"
#include "base/read_text.h"
#include "base/work_folder.h"
#include "base/write_text.h"
#include "console/server/page_client.h"
#include "io/local/local_client.h"
#include "session/process/exit_code.h"
#include "session/setup/build_name.h"
#include "session/summary/chart_files.h"
#include "studies/bench/bench_reloads.h"
#include "studies/bench/page_reloads.h"

namespace osteon::studies {
namespace {

constexpr int kPages = 8;                        // number of pages in the leg kEight
constexpr std::chrono::milliseconds kLooks{50};  // time between two polls whether the demo has ended
constexpr int kLooksToAsk = 20;                  // polls between two requests for the drawing latency
// longest time from a tick to its drawn figure, as console.md states it
constexpr double kMaxLatency_ms = 100.0;

// The demos of a round, in turn; their names are in kLegs.
enum class Leg : std::uint8_t { kOff, kIdle, kEight, kPage, kBusy, kBrowser };
constexpr std::array<const char*, 6> kLegs{"off",      "on, no page",          "eight pages, one stuck",
                                           "one page", "one page, cores busy", "one page in a browser"};

// A figure of a demo's summary: its two keys in the JSON, and its name in the output. All are in µs.
struct Figure {
  const char *key, *part, *name;
};
constexpr std::array<Figure, 4> kFigures{
    Figure{"compute_us", "p50", "tick compute p50"}, Figure{"compute_us", "p99", "tick compute p99"},
    Figure{"wakeup_us", "p99", "tick wake-up p99"}, Figure{"frame_us", "p50", "frame p50"}};

// How often and how late the carved bone reached a page, between the first and the last change of the cut.
struct BoneFigures {
  double mesh_per_s{0.0}, whole_per_s{0.0}, longest_gap_ms{0.0}, age_ms_p50{0.0}, age_ms_p95{0.0};
};
// A member of BoneFigures, with its key in the JSON, its name in the output and its unit.
struct BoneFigure {
  const char *key, *name, *unit;
  double BoneFigures::*value;
};
constexpr std::array<BoneFigure, 5> kBoneFigures{
    BoneFigure{"mesh_per_s", "bone: mesh messages", "/s", &BoneFigures::mesh_per_s},
    BoneFigure{"whole_per_s", "bone: whole changes", "/s", &BoneFigures::whole_per_s},
    BoneFigure{"longest_gap_ms", "bone: longest gap", "ms", &BoneFigures::longest_gap_ms},
    BoneFigure{"age_ms_p50", "bone: age p50", "ms", &BoneFigures::age_ms_p50},
    BoneFigure{"age_ms_p95", "bone: age p95", "ms", &BoneFigures::age_ms_p95}};

// Result of one demo: its summary (null if the demo failed), and figures of the bone that reached a page.
struct DemoFigures {
  nlohmann::json summary{};
  std::optional<BoneFigures> bone{};
  std::string without_page{};  // reason why a page did not open; the leg then has no result
  std::optional<double> received_ms{}, drawn_ms{};  // medians of the time since the tick
};

// Asks the demo's console for the present median of the time from a tick until a browser's page has drawn it.
std::optional<double> AskDrawn(pid_t demo) {
  for (const std::filesystem::path& socket : io::FindLocalServers()) {
    if (socket.stem() != fmt::format("run-{}", demo)) continue;
    const auto text = io::AskLocalServer(socket, "status");
    const auto answer = text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
    const nlohmann::json& drawn_ms = base::ValueAt(base::ValueAt(answer, "run"), "drawn_ms");
    if (drawn_ms.is_number()) return drawn_ms.get<double>();
  }
  return std::nullopt;
}

// Keeps every core busy at normal priority, as other work would.
class BusyCores {
 public:
  BusyCores() {
    for (unsigned core = 0; core < std::max(1U, std::thread::hardware_concurrency()); ++core)
      threads_.emplace_back([this] {
        while (!done_.load(std::memory_order_relaxed)) continue;
      });
  }
  ~BusyCores() {
    done_.store(true);
    for (std::thread& thread : threads_) thread.join();
  }
  BusyCores(const BusyCores&) = delete;
  BusyCores& operator=(const BusyCores&) = delete;

 private:
  std::atomic<bool> done_{false};
  std::vector<std::thread> threads_;
};

// Computes the figures of the bone that a page received. The first complete surface is the uncut bone, and is
// left out.
BoneFigures FiguresOf(const console::PageClient::Bone& bone) {
  BoneFigures figures;
  if (bone.whole_s.size() < 3) return figures;
  const std::vector<double> times(bone.whole_s.begin() + 1, bone.whole_s.end());
  const double span_s = times.back() - times.front();
  if (!(span_s > 0.0)) return figures;
  figures.mesh_per_s = static_cast<double>(bone.messages - 1) / span_s;
  figures.whole_per_s = static_cast<double>(times.size() - 1) / span_s;
  for (std::size_t i = 1; i < times.size(); ++i)
    figures.longest_gap_ms = std::max(figures.longest_gap_ms, 1e3 * (times[i] - times[i - 1]));
  std::vector<double> ages(bone.age_ms.begin() + 1, bone.age_ms.end());
  figures.age_ms_p50 = base::LowerPercentile(ages, 0.5);
  figures.age_ms_p95 = base::LowerPercentile(ages, 0.95);
  return figures;
}

// Runs one demo with the leg's pages or browser until it ends.
DemoFigures RunDemoWith(Leg leg, const BenchConsoleOptions& options, const std::filesystem::path& folder) {
  std::error_code error;
  const std::filesystem::path json = folder / "summary.json", err = folder / "err.txt";
  for (const auto& earlier :
       {json, err})  // remove old files: otherwise the port of an earlier demo would be used
    std::filesystem::remove(earlier, error);
  auto demo =
      base::ChildProcess::Start({.words = {"demo", "--seconds", fmt::format("{:g}", options.seconds), "--out",
                                           (folder / "out").string(), "--overwrite", "--port", "0", "--json",
                                           json.string(), "--console", leg == Leg::kOff ? "off" : "0"},
                                 .program = base::ProgramBeside("osteon"),
                                 .out = folder / "out.txt",
                                 .err = err});
  if (!demo) return {};
  std::optional<BusyCores> busy;
  if (leg == Leg::kBusy) busy.emplace();
  std::vector<std::unique_ptr<console::PageClient>> pages;
  std::unique_ptr<base::ChildProcess> browser;
  if (const int port = leg == Leg::kOff ? 0 : AwaitConsolePort(**demo, err); port > 0) {
    const int count = leg == Leg::kEight ? kPages : leg == Leg::kPage || leg == Leg::kBusy ? 1 : 0;
    for (int i = 0; i < count; ++i)  // if there are several pages, the last one does not read
      if (auto page = console::PageClient::Open("127.0.0.1", port, i + 1 < kPages))
        pages.push_back(std::move(*page));
      else
        return {.without_page = page.error()};
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
  DemoFigures figures;
  for (int look = 0; !(*demo)->Ended() && !base::Interrupted().load(); ++look) {
    if (browser && look % kLooksToAsk == 0)
      if (const auto drawn_ms = AskDrawn((*demo)->pid())) figures.drawn_ms = drawn_ms;
    std::this_thread::sleep_for(kLooks);
  }
  if (browser) browser->Send(SIGTERM);
  if (!pages.empty()) {
    figures.bone = FiguresOf(pages.front()->bone());
    std::vector<double> received_ms = pages.front()->received_ms();
    figures.received_ms = base::LowerPercentile(received_ms, 0.5);
  }
  pages.clear();
  if (!base::Interrupted().load())
    figures.summary = nlohmann::json::parse(base::ReadText(json), nullptr, false);
  return figures;
}

// Figures of all rounds, by leg.
struct Rounds {
  std::array<std::array<std::vector<double>, kFigures.size()>, kLegs.size()> cell;
  std::array<std::array<std::vector<double>, kBoneFigures.size()>, kLegs.size()> bone;
  std::array<std::vector<double>, kLegs.size()> received_ms, drawn_ms;

  void Add(Leg leg, const DemoFigures& demo) {
    const auto l = static_cast<std::size_t>(leg);
    for (std::size_t i = 0; i < kFigures.size(); ++i)
      cell[l][i].push_back(
          demo.summary.value(kFigures[i].key, nlohmann::json::object()).value(kFigures[i].part, 0.0));
    for (std::size_t i = 0; i < kBoneFigures.size(); ++i)
      if (demo.bone) bone[l][i].push_back((*demo.bone).*kBoneFigures[i].value);
    if (demo.received_ms) received_ms[l].push_back(*demo.received_ms);
    if (demo.drawn_ms) drawn_ms[l].push_back(*demo.drawn_ms);
  }
};

// Prints a leg's medians. @returns them for the JSON
nlohmann::ordered_json TellLeg(Leg leg, Rounds& rounds) {
  const auto l = static_cast<std::size_t>(leg);
  nlohmann::ordered_json row{{"leg", kLegs[l]}};
  fmt::print("  {}\n", kLegs[l]);
  for (std::size_t i = 0; i < kFigures.size(); ++i) {
    const double median = base::Median(rounds.cell[l][i]), off = base::Median(rounds.cell[0][i]);
    const double ratio = off > 0.0 ? median / off : 0.0;
    fmt::print("    {:<20} {:8.1f} µs   {:5.2f}\n", kFigures[i].name, median, ratio);
    row[fmt::format("{}_{}", kFigures[i].key, kFigures[i].part)] = {{"median", median}, {"ratio", ratio}};
  }
  for (const auto& [key, name, values] :
       {std::tuple("received_ms_p50", "tick to page", &rounds.received_ms[l]),
        std::tuple("drawn_ms_p50", "tick to drawn figure", &rounds.drawn_ms[l])}) {
    if (values->empty()) continue;
    const double median = base::Median(*values);
    fmt::print("    {:<20} {:8.1f} ms   {} {:g}\n", name, median, median < kMaxLatency_ms ? "below" : "above",
               kMaxLatency_ms);
    row[key] = median;
  }
  if (rounds.bone[l][0].empty()) return row;
  for (std::size_t i = 0; i < kBoneFigures.size(); ++i) {
    const double median = base::Median(rounds.bone[l][i]);
    fmt::print("    {:<20} {:8.1f} {}\n", kBoneFigures[i].name, median, kBoneFigures[i].unit);
    row["bone"][kBoneFigures[i].key] = median;
  }
  return row;
}

}  // namespace

int RunBenchConsole(const BenchConsoleOptions& options) {
  base::InstallInterrupt();
  if (options.reloads > 0) return RunBenchReloads(options);
  const base::WorkFolder folder("bench_console");
  std::vector<Leg> legs{Leg::kOff, Leg::kIdle, Leg::kEight, Leg::kPage, Leg::kBusy};
  if (!options.chromium.empty()) legs.push_back(Leg::kBrowser);
  Rounds rounds;
  for (int round = 0; round < options.rounds; ++round)
    for (const Leg leg : legs) {
      const DemoFigures demo = RunDemoWith(leg, options, folder.path());
      if (base::Interrupted().load()) return base::InterruptExitCode();
      if (!demo.without_page.empty())
        return session::Fail("bench console", "a page did not open: " + demo.without_page, session::kFailed);
      if (!demo.summary.is_object())
        return session::Fail("bench console", "a demo failed:\n" + base::ReadText(folder.path() / "err.txt"),
                             session::kFailed);
      rounds.Add(leg, demo);
      fmt::print(stderr, "osteon bench console: round {} of {}: {}\n", round + 1, options.rounds,
                 kLegs[static_cast<std::size_t>(leg)]);
    }

  nlohmann::ordered_json json{
      {"schema", "osteon.bench.console/1"}, {"rounds", options.rounds},
      {"seconds", options.seconds},         {"machine", session::MachineName()},
      {"build", session::BuildName()},      {"legs", nlohmann::ordered_json::array()}};
  fmt::print("Osteon bench console: medians of {} rounds of {:g} s, and their ratios to off\n",
             options.rounds, options.seconds);
  for (const Leg leg : legs) json["legs"].push_back(TellLeg(leg, rounds));
  if (!options.json.empty())
    if (const auto written = base::WriteText(options.json, base::JsonText(json)); !written)
      return session::Fail("bench console", written.error(), session::kFailed);
  return 0;
}

}  // namespace osteon::studies
