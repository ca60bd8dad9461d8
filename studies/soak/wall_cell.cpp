#include "studies/soak/wall_cell.h"

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/json_value.h"
#include "base/read_text.h"
#include "config/reading/strict/derived_file.h"
#include "console/server/page_client.h"
#include "io/local/local_client.h"
#include "io/local/local_server.h"

namespace osteon::studies {
namespace {

using std::chrono::milliseconds, std::chrono::seconds, std::chrono::steady_clock;

// Time limits are generous, so that a busy machine does not decide the outcome.
constexpr seconds kEnd{90};  // from SIGTERM to a process's end
// Time limit of an episode: this ratio × its time of rendering, plus these seconds.
constexpr double kPatienceRatio = 3.0, kPatience_s = 120.0;
constexpr milliseconds kPollInterval{50};
constexpr double kUseEvery_s = 0.5;  // time between two measurements of the processes' use of the machine
// Time for which a page stays open in an episode in which pages come and go.
constexpr double kPageStays_s = 1.0;
// Time in which the PLC notices a missing heartbeat and withdraws the permission, which takes 0.25 s.
constexpr milliseconds kPlcNotices{800};
constexpr const char* kPlan = "acetabulum";  // file name of the plan, for a cell whose script follows a plan

double Now_s() { return std::chrono::duration<double>(steady_clock::now().time_since_epoch()).count(); }

// Number of entries of a folder; 0 if there is no such folder.
int CountEntries(const std::filesystem::path& folder) {
  std::error_code error;
  int count = 0;
  for (auto entry = std::filesystem::directory_iterator(folder, error);
       !error && entry != std::filesystem::directory_iterator(); entry.increment(error))
    ++count;
  return count;
}

// The console's port, from a controller's output; 0: not printed yet.
int ConsolePort(const std::string& printed) {
  static const std::regex kAddress("console: http://127\\.0\\.0\\.1:([0-9]+)/");
  std::smatch found;
  return std::regex_search(printed, found, kAddress) ? std::stoi(found[1]) : 0;
}

}  // namespace

ProcessUse UseOf(pid_t process) {
  const std::filesystem::path folder = std::filesystem::path("/proc") / std::to_string(process);
  std::istringstream statm(base::ReadText(folder / "statm"));
  double whole = 0.0, resident = 0.0;  // in pages of memory
  statm >> whole >> resident;
  return {.memory_MB = resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6,
          .files = CountEntries(folder / "fd"),
          .threads = CountEntries(folder / "task")};
}

// The console's pages that watch one controller. They connect; if the script says so, they disconnect and
// connect again.
class WallCell::Pages {
 public:
  void Open(int port) {
    port_ = port;
    for (std::size_t i = 0; i < pages_.size(); ++i) OpenPage(i);
    opened_s_ = Now_s();
  }
  [[nodiscard]] bool open() const { return port_ > 0; }

  // Closes all pages and opens them again, once every kPageStays_s.
  void ReopenEverySecond() {
    if (!open() || Now_s() - opened_s_ < kPageStays_s) return;
    for (std::size_t i = 0; i < pages_.size(); ++i) {
      ClosePage(i);
      OpenPage(i);
    }
    opened_s_ = Now_s();
  }

  // Closes all pages. @returns the number of messages that each page got
  std::array<std::uint64_t, kWallPages> Close() {
    for (std::size_t i = 0; i < pages_.size(); ++i) ClosePage(i);
    return messages_;
  }

 private:
  // Connects a page. All pages but the last one read their messages.
  void OpenPage(std::size_t i) {
    if (auto page = console::PageClient::Open("127.0.0.1", port_, i + 1 < pages_.size()))
      pages_[i] = std::move(*page);
  }
  void ClosePage(std::size_t i) {
    if (pages_[i]) messages_[i] += pages_[i]->messages();
    pages_[i].reset();
  }

  int port_{0};  // the console's port; 0: not known yet
  double opened_s_{0.0};
  std::array<std::unique_ptr<console::PageClient>, kWallPages> pages_;
  std::array<std::uint64_t, kWallPages> messages_{};
};

WallCell::WallCell(std::filesystem::path config_root, std::filesystem::path folder,
                   std::function<bool()> stop)
    : config_root_(std::move(config_root)),
      folder_(std::move(folder)),
      stop_(std::move(stop)),
      parts_(folder_, stop_) {}

WallOutcome WallCell::Run(const WallEpisode& episode) {
  const double begin_s = Now_s();
  if (WallOutcome discarded; cell_ && (needs_new_cell_ || cell_->Ended() || episode.life.index != life_))
    EndCell(discarded);
  needs_new_cell_ = false;
  static_cast<void>(cpus_.TakeLongest());  // discard what was measured between the episodes
  WallOutcome outcome;
  try {
    if (!cell_) outcome.error = StartCell(episode.life);
    if (outcome.error.empty() && guard_ && guard_->Ended()) guard_.reset();
    if (outcome.error.empty() && !guard_) outcome.error = StartGuard();
    if (outcome.error.empty()) StartController(episode);
  } catch (const std::exception& error) {
    outcome.error = error.what();
  }
  if (!outcome.error.empty()) return outcome;
  pause_ = 0;
  pausing_ = changed_ = false;
  Pages pages;
  WatchController(episode, pages, outcome);
  outcome.messages = pages.Close();
  outcome.cpu_stood_still = cpus_.TakeLongest();
  outcome.exit = run_->End(seconds(0));
  run_.reset();
  EndParts(episode, outcome);
  outcome.seconds_wall = Now_s() - begin_s;
  return outcome;
}

void WallCell::WatchController(const WallEpisode& episode, Pages& pages, WallOutcome& outcome) {
  const double give_up_s = Now_s() + kPatienceRatio * episode.seconds + kPatience_s;
  double use_s = 0.0, last_rendered_s = 0.0;
  bool half_measured = false;
  while (!run_->Ended()) {
    const double now_s = Now_s();
    if (stop_() || now_s > give_up_s) {
      outcome.error = stop_() ? "stopped" : "the controller did not end";
      run_->Send(SIGTERM);
      run_->End(kEnd);
      return;
    }
    if (!pages.open()) {
      if (const int port = ConsolePort(parts_.Printed("run")); port > 0) pages.Open(port);
    } else if (episode.event == WallEvent::kPages) {
      pages.ReopenEverySecond();
    }
    if (const auto answer = AskController("status")) {
      const nlohmann::json json = nlohmann::json::parse(*answer, nullptr, false);
      const double rendered_s = base::NumberAt(base::ValueAt(json, "status"), "rendered_s");
      if (rendered_s > 0.0) PerformDueActions(episode, rendered_s, outcome);
      // Measure only while the controller renders: at its end it reads its recording for the report, which
      // takes memory.
      if (rendered_s > last_rendered_s && now_s - use_s > kUseEvery_s) {
        outcome.use = MeasureUses();
        use_s = now_s;
      }
      last_rendered_s = rendered_s;
      if (!half_measured && rendered_s > 0.5 * episode.seconds) {
        outcome.half = UseOf(run_->pid());
        half_measured = true;
      }
    }
    std::this_thread::sleep_for(kPollInterval);
  }
}

PartUses WallCell::MeasureUses() const {
  const pid_t engine = base::FindChild(run_->pid(), "simulate");
  return {UseOf(run_->pid()), engine > 0 ? UseOf(engine) : ProcessUse{}, UseOf(guard_->pid()),
          UseOf(cell_->pid()), UseOf(getpid())};
}

void WallCell::PerformDueActions(const WallEpisode& episode, double rendered_s, WallOutcome& outcome) {
  // at the end of the pause's length: request the next tool if the script says so, then resume
  if (pausing_) {
    if (Now_s() < resume_at_s_) return;
    changed_ = changed_ || !episode.pauses[pause_].next_tool || Request("next", outcome);
    if (!changed_ || !Request("resume", outcome)) return;
    pausing_ = changed_ = false;
    outcome.event_done = ++pause_ == episode.pauses.size();
    return;
  }
  if (pause_ < episode.pauses.size()) {
    const WallPause& pause = episode.pauses[pause_];
    if (rendered_s < pause.begin_s || !Request("pause", outcome)) return;
    pausing_ = true;
    resume_at_s_ = Now_s() + pause.length_s;
    return;
  }
  if (outcome.event_done || rendered_s < episode.at_s) return;
  switch (episode.event) {
    case WallEvent::kHaltedCell:
      cell_->Send(SIGSTOP);
      std::this_thread::sleep_for(std::chrono::duration<double>(episode.halt_s));
      cell_->Send(SIGCONT);
      break;
    case WallEvent::kControllerKill:
      run_->Send(SIGKILL);
      break;
    case WallEvent::kGuardKill:
      guard_->Send(SIGKILL);
      break;
    case WallEvent::kCellKill:
      cell_->Send(SIGKILL);
      break;
    case WallEvent::kEngineKill:
      if (const pid_t engine = base::FindChild(run_->pid(), "simulate"); engine > 0) {
        kill(engine, SIGKILL);
        break;
      }
      outcome.refused = "the controller has no engine's process";
      return;
    default:
      return;
  }
  outcome.event_done = true;
}

bool WallCell::Request(const char* request, WallOutcome& outcome) {
  const auto answer = AskController(request);
  const nlohmann::json json = answer ? nlohmann::json::parse(*answer, nullptr, false) : nlohmann::json();
  if (base::FlagAt(json, "done")) {
    outcome.refused.clear();
    return true;
  }
  outcome.refused = fmt::format("{}: {}", request,
                                json.is_object() ? base::TextAt(json, "reason")
                                : answer         ? *answer
                                                 : answer.error());
  return false;
}

void WallCell::EndParts(const WallEpisode& episode, WallOutcome& outcome) {
  outcome.summary = parts_.Folder("run") / "run.json";
  outcome.recording =
      episode.life.plan ? parts_.Folder("run") / "session" / "run_1.mcap" : parts_.Folder("run") / "run.mcap";
  if (IsKill(episode.event)) std::this_thread::sleep_for(kPlcNotices);
  if (episode.ends_life) EndCell(outcome);
  // after a kill the guard has withheld datagrams, or is gone: the next episode starts a new one
  if (IsKill(episode.event)) EndGuard(outcome);
}

void WallCell::EndCell(WallOutcome& outcome) {
  if (cell_) {
    cell_->Send(SIGTERM);
    cell_->End(kEnd);
    outcome.cell = parts_.ReportOfCell();
    cell_.reset();
  }
  EndGuard(outcome);
}

void WallCell::EndGuard(WallOutcome& outcome) {
  if (!guard_) return;
  guard_->Send(SIGTERM);
  guard_->End(kEnd);
  outcome.guard_reason = parts_.ReasonOfGuard();
  guard_.reset();
}

std::string WallCell::StartCell(const CellLife& life) {
  std::vector<config::YamlEdit> edits{{"plc.guard", "true"},
                                      {"guard", "{port: 30209}"},
                                      {"link_quality.ask_again", "true"},
                                      {"operator.tremor_N", "1"}};
  if (life.loss_ratio > 0.0)
    edits.push_back({"injections", fmt::format("[{{wire: arm, direction: both, from_s: 0.5, to_s: 80000, "
                                               "loss_ratio: {}, burst_count: 2}}]",
                                               life.loss_ratio)});
  if (life.engine_process) edits.push_back({"simulation", "{process: local}"});
  config::WriteDerived(config_root_ / "cells" / "demo.yaml", edits, cell_file());
  parts_.UseCell(cell_file());
  life_ = life.index;
  std::vector<std::string> options{"--json", "cell.json", "--console",
                                   "off",    "--seconds", fmt::format("{:g}", life.seconds)};
  if (life.plan)
    options.insert(options.end(), {"--plan", (config_root_ / "plans" / kPlan).string() + ".yaml"});
  cell_ = parts_.Start("cell", options);
  if (parts_.AwaitReady("cell", *cell_)) return "";
  cell_.reset();
  return "osteon cell is not ready: " + parts_.LastError("cell");
}

std::string WallCell::StartGuard() {
  guard_ = parts_.Start("guard", {"--json", "guard.json"});
  if (parts_.AwaitReady("guard", *guard_)) return "";
  guard_.reset();
  return "osteon guard is not ready: " + parts_.LastError("guard");
}

void WallCell::StartController(const WallEpisode& episode) {
  std::vector<std::string> options{
      "--json",    "run.json", "--engine",  "cpu",
      "--console", "0",        "--seconds", fmt::format("{:g}", episode.seconds)};
  if (episode.event == WallEvent::kHaltedCell) options.insert(options.end(), {"--recover", "3"});
  if (episode.life.plan)
    options.insert(options.end(),
                   {"--plan", (config_root_ / "plans" / kPlan).string() + ".yaml", "--session", "session"});
  else
    options.insert(options.end(), {"--record", "run.mcap"});
  run_ = parts_.Start("run", options);
}

tl::expected<std::string, std::string> WallCell::AskController(const std::string& request) const {
  return io::AskLocalServer(io::LocalSocketFolder() / fmt::format("run-{}.sock", run_->pid()), request);
}

}  // namespace osteon::studies
