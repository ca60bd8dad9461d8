#pragma once

#include <optional>
#include <string>
#include <vector>

#include "control/tick_record.h"
#include "io/recording/record_sink.h"
#include "io/recording/recorder.h"
#include "session/summary/event_row.h"

namespace osteon::session {

/// Name of the event in a recording and in its summary.
inline constexpr const char* kDeflectionEvent = "deflection";

/// The largest displacements of tool, surface layer and mount in a run; all are 0 in a rigid cell.
struct PeakDeflection {
  void Add(const control::ComplianceRecord& record);

  bool present{false};                  ///< whether the cell models the compliance of tool, layer or mount
  double bend_m{0.0}, layer_m{0.0};     ///< displacement of the apex by bending; indentation of the layer
  double mount_m{0.0}, mount_rad{0.0};  ///< translation and rotation of the bone at its mount's point
};

/// Finds in a run's ticks where a displacement grew larger than the cell's error. Each such event becomes a
/// row in the list of the run's events:
///
///     "deflection"   at the first such tick, with the largest displacement of this event [mm]
///
/// An event ends when the displacement has been within the error for half a second.
class DeflectionEvents {
 public:
  /// Takes the next tick of a run. @returns whether an event begins in it
  bool Add(const control::TickRecord& tick);

  /// The rows so far, in order; times count from the first tick.
  [[nodiscard]] const std::vector<EventRow>& rows() const { return rows_; }

 private:
  std::vector<EventRow> rows_;
  std::optional<rt::Nanoseconds> start_;  // stamp of the run's first tick
  std::optional<rt::Nanoseconds> last_;   // stamp of the last tick with a displacement beyond the error
};

/// Makes the text that is recorded when a deflection event begins: "deflection: the tool gives way by 0.052
/// mm, more than the cell's error".
[[nodiscard]] std::string DescribeDeflection(const control::ComplianceRecord& record);

/// Passes all records on to the next sink, and records an event whenever a deflection event begins. Runs in
/// the recorder's thread, never in the servo thread.
class DeflectionSink final : public io::RecordSink {
 public:
  /// @param next  gets the same records; null: there is no other sink. Must outlive this object.
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
