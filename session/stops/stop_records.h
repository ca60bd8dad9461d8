#pragma once

#include <cstddef>
#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

#include "config/reading/cell_config.h"
#include "control/tick_record.h"
#include "io/recording/messages.h"
#include "safety/fault.h"

namespace osteon::session {

/// The ticks of a stop within a recording: the last five seconds before the stop, the stop itself, and half a
/// second with the arm at rest.
struct StopRecord {
  std::vector<control::TickRecord> ticks;
  std::size_t stop{0};             ///< index of the first tick in which the loop brakes or is at rest
  std::size_t rest{0};             ///< index of the first tick at rest; ticks.size() if there is none
  rt::Nanoseconds first_stamp{0};  ///< stamp of the recording's first tick
  bool cut_off{false};             ///< the recording ends before the stop is complete
  safety::FaultSet faults;
  bool asked{false};   ///< the stop was requested, by the run's end or Ctrl-C
  bool paused{false};  ///< the operator has paused the cell

  /// Whether the stop is the requested end of the run, without a fault.
  [[nodiscard]] bool IsOrderly() const { return asked && !faults.Any(); }
  [[nodiscard]] bool IsPause() const { return paused && !asked && !faults.Any(); }
  /// Names the reason of the stop: its faults ("arm message stale; motion not permitted"), "asked for", "a
  /// pause was asked for" or "the arm ended the session".
  [[nodiscard]] std::string DescribeCause() const;
  /// Returns "What led to the stop"; for a stop without a fault "How the run ended" or "How the pause began".
  [[nodiscard]] const char* Heading() const;
};

/// Whether the loop moves the arm in a phase.
[[nodiscard]] bool MovesArm(control::Phase phase);

/// Whether a stop begins with `tick`: the loop moved the arm in the tick before, and stops or pauses in this
/// one.
[[nodiscard]] bool BeginsStop(const control::TickRecord& before, const control::TickRecord& tick);

/// Finds every stop of a recording, tick by tick. A stop is a change of the loop from moving (aligning,
/// haptic) to stopping, stopped or paused. Keeps in memory the ticks of the last five seconds, and those of a
/// stop in progress: at most kMaxTicks of each.
class StopFinder {
 public:
  static constexpr std::size_t kMaxTicks = 20'000;  ///< 20 s at 1 kHz

  /// Takes the next tick. @returns a stop once: with the first tick that no longer belongs to it; else
  /// nothing
  [[nodiscard]] std::optional<StopRecord> Add(const control::TickRecord& tick);
  /// Ends the recording. @returns the stop that is still in progress; nothing: there is none. Call it once.
  [[nodiscard]] std::optional<StopRecord> Finish();

 private:
  // Adds a tick to the stop in progress. @returns false if the stop was complete before it
  bool AppendToStop(const control::TickRecord& tick);

  std::deque<control::TickRecord> last_;  // ticks of the last five seconds
  std::optional<rt::Nanoseconds> first_stamp_;
  std::optional<StopRecord> stop_;        // the stop in progress
  std::optional<rt::Nanoseconds> until_;  // set once the arm is at rest: ticks are collected up to this stamp
};

/// The event that records an orderly end begins with this text; the reason follows.
inline constexpr const char* kEndEvent = "end: ";

/// The files of a stop: its page, with the page's heading, and the table of its ticks.
struct WrittenStop {
  std::filesystem::path page;
  std::string heading;          ///< StopRecord::Heading
  std::filesystem::path ticks;  ///< CSV file with the ticks
};

/// Where to write a stop's page and table, and the facts about the run that the page shows.
struct StopFiles {
  std::filesystem::path folder;
  std::string stem;
  const config::CellConfig& cell;     ///< the run's cell, for the limits in the charts
  std::filesystem::path recording{};  ///< the page prints the command that shows it; empty: none
  rt::Nanoseconds session_stamp{0};   ///< time of the recording's beginning; 0: virtual time
  double force_limit_N{0.0};
  std::string end_reason{};   ///< why the run ended, if it ended without a fault
  std::string console_url{};  ///< address of the cell's page; empty: the cell no longer runs
};

/// Writes the page of a stop and the table of its ticks. The error names the file.
[[nodiscard]] tl::expected<WrittenStop, std::string> WriteStop(const StopRecord& stop, std::size_t number,
                                                               const StopFiles& files);

struct StopPagesParams {
  std::filesystem::path folder;
  std::string stem;
  const config::CellConfig& cell;     ///< the run's cell, for limits in the charts; must outlive StopPages
  std::filesystem::path recording{};  ///< the page prints the command that shows it; empty: none
};

/// Writes each stop of a recording once it is complete: a page with its plots and faults,
/// `<stem>_stop_1.html`, and a table of all its ticks, `<stem>_stop_1_ticks.csv`. Touches no other file;
/// run_files.h keeps the files of different runs apart.
class StopPages {
 public:
  explicit StopPages(StopPagesParams params) : params_(std::move(params)) {}

  /// Adds the next tick of this session's recording. After a failed write it writes nothing more.
  void Add(const io::SessionInfo& session, const control::TickRecord& tick);
  /// Adds the next event. The event of the run's end has the reason for an orderly stop.
  void Add(const io::RecordedEvent& event);

  /// Completes the last stop. Call it once. @returns the pages; an error names the file.
  [[nodiscard]] tl::expected<std::vector<WrittenStop>, std::string> Finish();

 private:
  // Writes a complete stop; an orderly one is kept until the event with its reason arrives.
  void AddStop(std::optional<StopRecord> stop);
  void Write(const StopRecord& stop);

  StopPagesParams params_;
  StopFinder finder_;
  double force_limit_N_{0.0};
  rt::Nanoseconds session_stamp_{0};
  std::optional<StopRecord> orderly_;  // a stop whose reason comes in a later event
  std::string end_reason_{"a stop was asked for"};
  std::vector<WrittenStop> written_;
  std::string error_;
};

}  // namespace osteon::session
