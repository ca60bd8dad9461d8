#include "app/stop_records.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/each_fault.h"
#include "app/export_tables.h"
#include "app/fault_seen.h"
#include "app/report/page.h"
#include "app/report/run_charts.h"
#include "app/report/svg_text.h"
#include "app/run_files.h"

namespace osteon::app {
namespace {

using control::Phase;
using control::TickRecord;

constexpr rt::Nanoseconds kBefore = 5 * rt::kSecond, kAfter = rt::kSecond / 2;

bool Moves(Phase phase) { return phase == Phase::kAligning || phase == Phase::kHaptic; }
bool Ends(Phase phase) { return phase == Phase::kStopping || phase == Phase::kStopped; }

std::string FaultTable(const StopRecord& stop, std::span<const TickRecord> ticks) {
  std::string rows;
  ForEachFault(stop.faults, [&](safety::Fault fault, const safety::FaultText& text) {
    const TickRecord* first = FirstWith(fault, ticks);
    const std::string seen = first ? SeenAt(fault, *first) : "";
    rows += "<tr>";
    for (const std::string& cell : {std::string(text.name), text.cause + (seen.empty() ? "" : ": " + seen),
                                    std::string(text.reaction), std::string(text.clearing)})
      rows += "<td>" + Escape(cell) + "</td>";
    rows += "</tr>\n";
  });
  if (rows.empty())
    return stop.asked || stop.paused ? "<p>No fault: it was asked to stop.</p>\n" : "<p>No fault.</p>\n";
  return "<table>\n<tr><th>fault</th><th>what was seen</th><th>what the cell does</th><th>how to go "
         "on</th></tr>\n" +
         rows + "</table>\n";
}

std::string PageOf(const io::Recording& recording, const StopRecord& stop, std::size_t number,
                   double speed_limit_m_per_s, const std::string& table) {
  const std::span<const TickRecord> all(recording.ticks);
  const std::span<const TickRecord> ticks = all.subspan(stop.begin, stop.end - stop.begin);
  const double at_s = rt::ToSeconds(all[stop.stop].stamp - all.front().stamp);
  const std::string title = fmt::format("Stop no. {}: {}", number, stop.Why());
  std::string page = PageBegin(title);
  page += fmt::format(
      "<h1>{}</h1>\n<p>{:.3f} s into the recording, tick {}. Below, {:.1f} s before it and {:.1f} s "
      "after; every tick is in {}.</p>\n",
      Escape(title), at_s, all[stop.stop].tick, rt::ToSeconds(all[stop.stop].stamp - ticks.front().stamp),
      rt::ToSeconds(ticks.back().stamp - all[stop.stop].stamp), Escape(table));
  page += FaultTable(stop, ticks);
  page += Figure(ForceChart(ticks, recording.session.force_limit_N), "Forces on the tool.");
  page += Figure(MotionChart(ticks, speed_limit_m_per_s), "Tool speed, and the contact model's age.");
  return page + kPageEnd;
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

std::vector<StopRecord> FindStops(std::span<const TickRecord> ticks) {
  std::vector<StopRecord> stops;
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    if (!Ends(ticks[i].phase) || !Moves(ticks[i - 1].phase)) continue;
    StopRecord stop{.begin = i,
                    .stop = i,
                    .end = i,
                    .faults = {},
                    .asked = ticks[i].input.stop,
                    .paused = ticks[i].input.pause};
    while (stop.begin > 0 && ticks[i].stamp - ticks[stop.begin - 1].stamp <= kBefore) --stop.begin;
    std::size_t rest = i;
    while (rest < ticks.size() && ticks[rest].phase == Phase::kStopping) ++rest;
    const rt::Nanoseconds until = ticks[std::min(rest, ticks.size() - 1)].stamp + kAfter;
    std::uint32_t bits = 0;
    while (stop.end < ticks.size() && Ends(ticks[stop.end].phase) && ticks[stop.end].stamp <= until) {
      bits |= ticks[stop.end].faults;
      ++stop.end;
    }
    ForEachFault([&](safety::Fault fault, const safety::FaultText&) {
      if ((bits & static_cast<std::uint32_t>(fault)) != 0) stop.faults.Latch(fault);
    });
    stops.push_back(stop);
  }
  return stops;
}

tl::expected<std::vector<std::filesystem::path>, std::string> WriteStops(const io::Recording& recording,
                                                                         double speed_limit_m_per_s,
                                                                         const std::filesystem::path& folder,
                                                                         const std::string& stem) {
  const std::vector<StopRecord> stops = FindStops(recording.ticks);
  std::vector<std::filesystem::path> pages;
  for (std::size_t n = 1; n <= stops.size(); ++n) {
    const StopRecord& stop = stops[n - 1];
    const std::span<const TickRecord> ticks(recording.ticks);
    if (auto written = ExportTicks(ticks.subspan(stop.begin, stop.end - stop.begin), recording.session.stamp,
                                   StopTable(folder, stem, n));
        !written)
      return tl::make_unexpected(written.error());
    if (auto written = WritePage(
            PageOf(recording, stop, n, speed_limit_m_per_s, StopTable(folder, stem, n).filename().string()),
            StopPage(folder, stem, n));
        !written)
      return tl::make_unexpected(written.error());
    pages.push_back(StopPage(folder, stem, n));
  }
  return pages;
}

}  // namespace osteon::app
