#pragma once

#include <optional>
#include <string>
#include <vector>

#include "control/tick_record.h"
#include "io/recording/record_sink.h"
#include "io/recording/recorder.h"
#include "session/summary/event_row.h"

namespace osteon::session {

inline constexpr const char* kDeflectionEvent = "deflection";

/// The largest displacements of what gives way in a run. All 0: nothing does.
struct PeakDeflection {
  void Add(const control::ComplianceRecord& record);

  bool present{false};                  ///< something gives way
  double bend_m{0.0}, layer_m{0.0};     ///< of the tool's apex, and of the surface layer
  double mount_m{0.0}, mount_rad{0.0};  ///< of the bone at its mount's point
};

/// Finds in a run's ticks where a displacement grew beyond the cell's error, as rows among the run's events:
///
///     "deflection"   at the first such tick, with the largest displacement until it is over [mm]
///
/// A displacement that was within the error for less than half a second makes no new row.
class DeflectionEvents {
 public:
  /// Takes the next tick of a run. @returns whether an event begins in it
  bool Add(const control::TickRecord& tick);

  /// The rows so far, in order; times count from the first tick.
  [[nodiscard]] const std::vector<EventRow>& rows() const { return rows_; }

 private:
  std::vector<EventRow> rows_;
  std::optional<rt::Nanoseconds> start_, last_;  // of the run; the last tick beyond the error
};

/// What is recorded where such an event begins: "deflection: the tool gives way by 0.052 mm, more than the
/// cell's error".
[[nodiscard]] std::string DescribeDeflection(const control::ComplianceRecord& record);

/// Stands before a recorder's other sink, and records an event at each beginning. In the writer's thread,
/// never in the tick's.
class DeflectionSink final : public io::RecordSink {
 public:
  /// @param next  sees the same; null: nobody does. Must outlive this.
  explicit DeflectionSink(io::RecordSink* next) : next_(next) {}
  /// @param recorder  gets the events; must outlive the last tick
  void RecordIn(io::Recorder& recorder) { recorder_ = &recorder; }

  void TakeTick(const control::TickRecord& tick) override;
  void TakeFrame(const simulation::FrameRecord& frame) override;
  void TakeEvent(const io::RecordedEvent& event) override;

 private:
  io::RecordSink* next_;
  io::Recorder* recorder_{nullptr};
  DeflectionEvents events_;
};

}  // namespace osteon::session
