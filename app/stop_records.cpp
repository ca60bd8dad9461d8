#include "app/stop_records.h"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "app/each_fault.h"
#include "app/export_tables.h"
#include "app/fault_seen.h"
#include "app/report/page.h"
#include "app/report/stop_page.h"
#include "app/run_files.h"
#include "app/trip_limits.h"
#include "control/tick_state.h"

namespace osteon::app {
namespace {

using control::Phase;
using control::TickRecord;

constexpr rt::Nanoseconds kBefore = 5 * rt::kSecond, kAfter = rt::kSecond / 2;

bool Moves(Phase phase) { return phase == Phase::kAligning || phase == Phase::kHaptic; }
bool Ends(Phase phase) { return phase == Phase::kStopping || phase == Phase::kStopped; }
// Neither braking nor without control: a stop 0 is over once the arm is measured to stand.
bool Rests(const TickRecord& tick) {
  return tick.phase != Phase::kStopping &&
         tick.cell_state != static_cast<std::uint8_t>(safety::CellState::kStop0);
}

std::vector<StopFaultRow> FaultRows(const StopRecord& stop, std::span<const TickRecord> ticks,
                                    const control::ServoParams& servo) {
  std::vector<StopFaultRow> rows;
  ForEachFault(stop.faults, [&](safety::Fault fault, const safety::FaultText& text) {
    const TickRecord* first = FirstWith(fault, ticks);
    const std::string seen = first ? SeenAt(fault, *first, &servo) : "";
    rows.push_back({.fault = fault,
                    .name = text.name,
                    .seen = text.cause + (seen.empty() ? "" : ": " + seen),
                    .reaction = text.reaction,
                    .clearing = text.clearing});
  });
  return rows;
}

// So long of it was recorded at rest, or why less than half a second was.
std::string RestText(std::span<const TickRecord> all, const StopRecord& stop) {
  const TickRecord& last = all[stop.end - 1];
  if (stop.rest >= stop.end)
    return control::HasMessage(last)
               ? "The recording ends while the arm was not at rest yet."
               : "Whether the arm came to rest is not known: it sent no message any more.";
  const rt::Nanoseconds rested = last.stamp - all[stop.rest].stamp;
  std::string text =
      fmt::format("The arm was at rest from {:.3f} s on; {:.1f} s of that are shown",
                  rt::ToSeconds(all[stop.rest].stamp - all[stop.stop].stamp), rt::ToSeconds(rested));
  if (rested < kAfter - rt::kSecond / 50)
    text += stop.end < all.size() ? ": then it moved again" : ": there the recording ends";
  return text + ".";
}

StopPageInput PageOf(const io::Recording& recording, const StopRecord& stop, std::size_t number,
                     const TripLimits& limits) {
  const std::span<const TickRecord> all(recording.ticks);
  const std::span<const TickRecord> ticks = all.subspan(stop.begin, stop.end - stop.begin);
  const TickRecord& at = all[stop.stop];
  const bool orderly = stop.asked && !stop.faults.Any();
  const std::string why = orderly ? EndReason(recording.events) : stop.Why();
  return {
      .title = orderly ? fmt::format("How the run ended: {}", why)
                       : fmt::format("{} no. {}: {}", stop.IsPause() ? "Pause, stop" : "Stop", number, why),
      .heading = stop.Heading(),
      .where = fmt::format("0 s is the tick at which the stop began: {:.3f} s into the recording, tick {}. "
                           "Shown are {:.1f} s before it and {:.1f} s after. {}",
                           rt::ToSeconds(at.stamp - all.front().stamp), at.tick,
                           rt::ToSeconds(at.stamp - ticks.front().stamp),
                           rt::ToSeconds(ticks.back().stamp - at.stamp), RestText(all, stop)),
      .no_fault_text = stop.asked || stop.paused ? fmt::format("No fault: {}.", why) : "No fault.",
      .faults = FaultRows(stop, ticks, limits.servo),
      .ticks = ticks,
      .time = {.zero = at.stamp, .label = "time since the stop began [s]", .mark = "stop"},
      .force_limit_N = recording.session.force_limit_N,
      .limits = limits};
}

StopRecord StopFrom(std::span<const TickRecord> ticks, std::size_t i) {
  StopRecord stop{.begin = i,
                  .stop = i,
                  .rest = i,
                  .end = i,
                  .faults = {},
                  .asked = ticks[i].input.stop,
                  .paused = ticks[i].input.pause || control::IsPaused(ticks[i])};
  while (stop.begin > 0 && ticks[i].stamp - ticks[stop.begin - 1].stamp <= kBefore) --stop.begin;
  while (stop.rest < ticks.size() && !Rests(ticks[stop.rest])) ++stop.rest;
  const rt::Nanoseconds until = ticks[std::min(stop.rest, ticks.size() - 1)].stamp + kAfter;
  std::uint32_t bits = 0;
  while (stop.end < ticks.size() && !Moves(ticks[stop.end].phase) && ticks[stop.end].stamp <= until) {
    if (Ends(ticks[stop.end].phase)) bits |= ticks[stop.end].faults;
    ++stop.end;
  }
  ForEachFault([&](safety::Fault fault, const safety::FaultText&) {
    if ((bits & static_cast<std::uint32_t>(fault)) != 0) stop.faults.Latch(fault);
  });
  return stop;
}

}  // namespace

std::string StopRecord::Why() const {
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
  return asked && !faults.Any() ? "How the run ended" : "What led to the stop";
}

std::string EndReason(std::span<const io::RecordedEvent> events) {
  for (auto event = events.rbegin(); event != events.rend(); ++event)
    if (event->text.starts_with(kEndEvent)) return event->text.substr(std::string_view(kEndEvent).size());
  return "a stop was asked for";
}

std::vector<StopRecord> FindStops(std::span<const TickRecord> ticks) {
  std::vector<StopRecord> stops;
  // a tool that hardly moves is braked within a tick: then the pause is the first tick that is not motion
  for (std::size_t i = 1; i < ticks.size(); ++i)
    if (Moves(ticks[i - 1].phase) && (Ends(ticks[i].phase) || control::IsPaused(ticks[i])))
      stops.push_back(StopFrom(ticks, i));
  return stops;
}

tl::expected<std::vector<WrittenStop>, std::string> WriteStops(const io::Recording& recording,
                                                               const config::CellConfig& cell,
                                                               const std::filesystem::path& folder,
                                                               const std::string& stem) {
  const std::vector<StopRecord> stops = FindStops(recording.ticks);
  const TripLimits limits = TripLimitsOf(cell, recording.session.stamp == 0);
  std::vector<WrittenStop> written;
  for (std::size_t n = 1; n <= stops.size(); ++n) {
    const StopRecord& stop = stops[n - 1];
    const std::span<const TickRecord> ticks(recording.ticks);
    const std::filesystem::path table = StopTable(folder, stem, n);
    if (auto done =
            ExportTicks(ticks.subspan(stop.begin, stop.end - stop.begin), recording.session.stamp, table);
        !done)
      return tl::make_unexpected(done.error());
    StopPageInput page = PageOf(recording, stop, n, limits);
    page.where += " Every tick is in " + table.filename().string() + ".";
    if (auto done = WritePage(MakeStopPage(page), StopPage(folder, stem, n)); !done)
      return tl::make_unexpected(done.error());
    written.push_back({.page = StopPage(folder, stem, n), .heading = stop.Heading()});
  }
  return written;
}

}  // namespace osteon::app
