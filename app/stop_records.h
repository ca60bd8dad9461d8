#pragma once

#include <cstddef>
#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

#include "config/cell_config.h"
#include "control/tick_record.h"
#include "io/recording/messages.h"
#include "safety/fault.h"

namespace osteon::app {

/// A stop within a recording: the last five seconds before it, and what followed until half a second at rest.
struct StopRecord {
  std::vector<control::TickRecord> ticks;
  std::size_t stop{0};  ///< among them: the first in which the loop no longer moved as it was asked to
  std::size_t rest{0};  ///< the first at rest; beyond the last where none is
  rt::Nanoseconds first_stamp{0};  ///< of the recording's first tick
  bool cut_off{false};             ///< the recording ends with the last of them
  safety::FaultSet faults;
  bool asked{false};   ///< for: the run's end, Ctrl-C
  bool paused{false};  ///< by the operator

  [[nodiscard]] bool IsOrderly() const { return asked && !faults.Any(); }
  [[nodiscard]] bool IsPause() const { return paused && !asked && !faults.Any(); }
  /// "arm message stale; motion not permitted", "asked for" or "a pause was asked for".
  [[nodiscard]] std::string Why() const;
  /// "What led to the stop", or of a stop without a fault "How the run ended" or "How the pause began".
  [[nodiscard]] const char* Heading() const;
};

/// Finds every stop of a recording, tick by tick: where the loop goes from moving (aligning, haptic) to
/// stopping, stopped or paused. Holds the ticks of the last five seconds, and those of a stop under way: at
/// most kMaxTicks of each.
class StopFinder {
 public:
  static constexpr std::size_t kMaxTicks = 20'000;  ///< 20 s at 1 kHz

  /// @returns the stop that ended before this tick.
  [[nodiscard]] std::optional<StopRecord> Add(const control::TickRecord& tick);
  /// @returns the stop that the recording's end cuts off. To be called once.
  [[nodiscard]] std::optional<StopRecord> Finish();

 private:
  bool AppendToStop(const control::TickRecord& tick);

  std::deque<control::TickRecord> last_;  // five seconds
  std::optional<rt::Nanoseconds> first_stamp_;
  std::optional<StopRecord> stop_;        // under way
  std::optional<rt::Nanoseconds> until_;  // once it is at rest: so long its ticks are taken
};

/// What the recording's event of a run's orderly end begins with; why it ended follows.
inline constexpr const char* kEndEvent = "end: ";

/// A stop's page, and what it is called beside its path.
struct WrittenStop {
  std::filesystem::path page;
  std::string heading;  ///< StopRecord::Heading
};

struct StopPagesParams {
  std::filesystem::path folder;
  std::string stem;
  const config::CellConfig& cell;  ///< that was run: its limits are drawn; must outlive the pages' writer
};

/// Writes each stop of a recording once it is over: a page with its plots and faults, `<stem>_stop_1.html`,
/// and a table of all its ticks, `<stem>_stop_1_ticks.csv`. Nothing else is touched: run_files.h keeps one
/// run's from another's.
class StopPages {
 public:
  explicit StopPages(StopPagesParams params) : params_(std::move(params)) {}

  /// The next tick of a recording whose session is this. After a failed write nothing more is written.
  void Add(const io::SessionInfo& session, const control::TickRecord& tick);
  /// The next event: one of them says why the run ended.
  void Add(const io::RecordedEvent& event);

  /// The rest. To be called once. @returns the pages; an error names the file.
  [[nodiscard]] tl::expected<std::vector<WrittenStop>, std::string> Finish();

 private:
  void Take(std::optional<StopRecord> stop);
  void Write(const StopRecord& stop);

  StopPagesParams params_;
  StopFinder finder_;
  double force_limit_N_{0.0};
  rt::Nanoseconds session_stamp_{0};
  std::optional<StopRecord> orderly_;  // waits for the event that says why
  std::string end_reason_{"a stop was asked for"};
  std::vector<WrittenStop> written_;
  std::string error_;
};

}  // namespace osteon::app
