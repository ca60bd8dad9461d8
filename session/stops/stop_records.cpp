#include "session/stops/stop_records.h"

#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "control/loop/tick_state.h"
#include "report/page.h"
#include "session/replay/export_tables.h"
#include "session/stops/stop_page.h"
#include "session/stops/trip_limits.h"
#include "session/summary/each_fault.h"
#include "session/summary/fault_seen.h"
#include "session/summary/run_files.h"

namespace osteon::session {
namespace {

using control::Phase;
using control::TickRecord;

// A stop's record begins kBefore before the stop, and ends once the arm has been at rest for kAfter.
constexpr rt::Nanoseconds kBefore = 5 * rt::kSecond, kAfter = rt::kSecond / 2;

bool IsStoppingOrStopped(Phase phase) { return phase == Phase::kStopping || phase == Phase::kStopped; }
// Whether the arm is at rest: it is neither braking, nor without control after a stop 0, in which it may
// still move.
bool IsAtRest(const TickRecord& tick) {
  return tick.phase != Phase::kStopping &&
         tick.cell_state != static_cast<std::uint8_t>(safety::CellState::kStop0);
}

// A row for each fault of the stop, with the value that was measured in the first tick that has the fault.
std::vector<StopFaultRow> FaultRows(const StopRecord& stop, const control::ServoParams& servo) {
  std::vector<StopFaultRow> rows;
  ForEachFault(stop.faults, [&](safety::Fault fault, const safety::FaultText& text) {
    const TickRecord* first = FirstWith(fault, stop.ticks);
    const std::string seen = first ? SeenAt(fault, *first, &servo) : "";
    rows.push_back({.fault = fault,
                    .name = text.name,
                    .seen = text.cause + (seen.empty() ? "" : ": " + seen),
                    .reaction = text.reaction,
                    .clearing = text.clearing});
  });
  return rows;
}

// Says for how long the arm's rest was recorded, or why that was less than half a second.
std::string RestText(const StopRecord& stop) {
  const TickRecord& last = stop.ticks.back();
  if (stop.rest >= stop.ticks.size()) {
    if (!control::HasMessage(last))
      return "Whether the arm came to rest is not known: it sent no message any more.";
    return stop.cut_off ? "The recording ends while the arm was not at rest yet."
                        : "The arm did not come to rest in this time.";
  }
  const TickRecord& first_at_rest = stop.ticks[stop.rest];
  const rt::Nanoseconds rested = last.stamp - first_at_rest.stamp;
  std::string text =
      fmt::format("The arm was at rest from {:.3f} s on; {:.1f} s of that are shown",
                  rt::ToSeconds(first_at_rest.stamp - stop.ticks[stop.stop].stamp), rt::ToSeconds(rested));
  if (rested < kAfter - rt::kSecond / 50)
    text += stop.cut_off ? ": there the recording ends" : ": then it moved again";
  return text + ".";
}

// Makes the input of a stop's page. @param end_reason  why the run ended; used for a stop without a fault
StopPageInput PageOf(const StopRecord& stop, std::size_t number, const std::string& end_reason,
                     double force_limit_N, const TripLimits& limits) {
  const TickRecord& at = stop.ticks[stop.stop];
  const std::string why = stop.IsOrderly() ? end_reason : stop.DescribeCause();
  return {
      .title = stop.IsOrderly()
                   ? fmt::format("How the run ended: {}", why)
                   : fmt::format("{} no. {}: {}", stop.IsPause() ? "Pause, stop" : "Stop", number, why),
      .heading = stop.Heading(),
      .where = fmt::format("0 s is the tick at which the stop began: {:.3f} s into the recording, tick {}. "
                           "Shown are {:.1f} s before it and {:.1f} s after. {}",
                           rt::ToSeconds(at.stamp - stop.first_stamp), at.tick,
                           rt::ToSeconds(at.stamp - stop.ticks.front().stamp),
                           rt::ToSeconds(stop.ticks.back().stamp - at.stamp), RestText(stop)),
      .no_fault_text = stop.asked || stop.paused ? fmt::format("No fault: {}.", why) : "No fault.",
      .faults = FaultRows(stop, limits.servo),
      .ticks = stop.ticks,
      .time = {.zero = at.stamp, .label = "time since the stop began [s]", .mark = "stop"},
      .force_limit_N = force_limit_N,
      .limits = limits};
}

// Makes the command that shows the recording at a stop. @param stop_s  time from the recording's start
std::string ViewCommandOf(const std::filesystem::path& recording, double stop_s) {
  constexpr double kBefore_s = 1.0;  // the view begins this long before the stop, to show its cause
  return fmt::format("osteon view {} --at {:.1f}", recording.string(), std::max(0.0, stop_s - kBefore_s));
}

}  // namespace

std::string StopRecord::DescribeCause() const {
  std::string why;
  ForEachFault(faults, [&](safety::Fault, const safety::FaultText& text) {
    why += (why.empty() ? "" : "; ") + std::string(text.name);
  });
  if (!why.empty()) return why;
  if (asked) return "asked for";
  return paused ? "a pause was asked for" : "the arm ended the session";
}

const char* StopRecord::Heading() const {
  if (IsPause()) return "How the pause began";
  return IsOrderly() ? "How the run ended" : "What led to the stop";
}

bool MovesArm(Phase phase) { return phase == Phase::kAligning || phase == Phase::kHaptic; }

// A slow tool comes to rest within a tick. A pause then has no tick in the phase of stopping, only ticks in
// the paused state.
bool BeginsStop(const TickRecord& before, const TickRecord& tick) {
  return MovesArm(before.phase) && (IsStoppingOrStopped(tick.phase) || control::IsPaused(tick));
}

std::optional<StopRecord> StopFinder::Add(const TickRecord& tick) {
  std::optional<StopRecord> ended;
  if (stop_ && !AppendToStop(tick)) ended = std::exchange(stop_, std::nullopt);
  if (!first_stamp_) first_stamp_ = tick.stamp;
  const bool begins = !last_.empty() && BeginsStop(last_.back(), tick);
  last_.push_back(tick);
  while (tick.stamp - last_.front().stamp > kBefore || last_.size() > kMaxTicks) last_.pop_front();
  if (begins) {
    const std::size_t ticks_before = last_.size() - 1;
    stop_ = StopRecord{.ticks = {last_.begin(), last_.end() - 1},
                       .stop = ticks_before,
                       .rest = ticks_before,
                       .first_stamp = *first_stamp_,
                       .faults = {},
                       .asked = tick.input.stop,
                       .paused = tick.input.pause || control::IsPaused(tick)};
    until_.reset();
    AppendToStop(tick);
  }
  return ended;
}

bool StopFinder::AppendToStop(const TickRecord& tick) {
  if (MovesArm(tick.phase) || (until_ && tick.stamp > *until_)) return false;
  if (stop_->ticks.size() - stop_->stop >= kMaxTicks) return false;
  stop_->ticks.push_back(tick);
  if (!until_) {
    if (IsAtRest(tick))
      until_ = tick.stamp + kAfter;
    else
      stop_->rest = stop_->ticks.size();
  }
  if (!IsStoppingOrStopped(tick.phase)) return true;
  ForEachFault([&](safety::Fault fault, const safety::FaultText&) {
    if ((tick.faults & static_cast<std::uint32_t>(fault)) != 0) stop_->faults.Latch(fault);
  });
  return true;
}

std::optional<StopRecord> StopFinder::Finish() {
  if (stop_) stop_->cut_off = true;
  return std::exchange(stop_, std::nullopt);
}

void StopPages::Add(const io::SessionInfo& session, const TickRecord& tick) {
  force_limit_N_ = session.force_limit_N;
  session_stamp_ = session.stamp;
  AddStop(finder_.Add(tick));
}

void StopPages::Add(const io::RecordedEvent& event) {
  if (event.text.starts_with(kEndEvent)) end_reason_ = event.text.substr(std::string_view(kEndEvent).size());
}

tl::expected<std::vector<WrittenStop>, std::string> StopPages::Finish() {
  AddStop(finder_.Finish());
  if (orderly_) Write(*std::exchange(orderly_, std::nullopt));
  if (!error_.empty()) return tl::make_unexpected(error_);
  return written_;
}

void StopPages::AddStop(std::optional<StopRecord> stop) {
  if (!stop) return;
  if (orderly_) Write(*std::exchange(orderly_, std::nullopt));
  if (stop->IsOrderly())
    orderly_ = std::move(stop);
  else
    Write(*stop);
}

void StopPages::Write(const StopRecord& stop) {
  if (!error_.empty()) return;
  auto written = WriteStop(stop, written_.size() + 1,
                           {.folder = params_.folder,
                            .stem = params_.stem,
                            .cell = params_.cell,
                            .recording = params_.recording,
                            .session_stamp = session_stamp_,
                            .force_limit_N = force_limit_N_,
                            .end_reason = end_reason_});
  if (written)
    written_.push_back(std::move(*written));
  else
    error_ = written.error();
}

tl::expected<WrittenStop, std::string> WriteStop(const StopRecord& stop, std::size_t number,
                                                 const StopFiles& files) {
  WrittenStop written{.page = StopPage(files.folder, files.stem, number),
                      .heading = stop.Heading(),
                      .ticks = StopTable(files.folder, files.stem, number)};
  const TripLimits limits = TripLimitsOf(files.cell, files.session_stamp == 0);
  StopPageInput page = PageOf(stop, number, files.end_reason, files.force_limit_N, limits);
  page.ticks_file = written.ticks.filename().string();
  page.console_url = files.console_url;
  if (!files.recording.empty())
    page.view_command =
        ViewCommandOf(files.recording, rt::ToSeconds(stop.ticks[stop.stop].stamp - files.session_stamp));
  if (auto done = ExportTicks(stop.ticks, files.session_stamp, written.ticks); !done)
    return tl::make_unexpected(done.error());
  if (auto shown = report::WritePage(MakeStopPage(page), written.page); !shown)
    return tl::make_unexpected(shown.error());
  return written;
}

}  // namespace osteon::session
