#pragma once

#include <atomic>
#include <cstdint>

#include "io/recording/record_sink.h"
#include "io/recording/recorder.h"

namespace osteon::session {

/// Records each fault of a run once, as an event "fault: NAME; what the cell does". Any thread.
class FaultEvents {
 public:
  /// Records the faults that are not recorded yet. @param stamp stamp of the events  @param faults  bits of
  /// safety::Fault
  void Record(io::Recorder& recorder, rt::Nanoseconds stamp, std::uint32_t faults);
  /// Forgets the recorded faults after a recovery: each fault is then new again.
  void Forget() { known_.store(0); }

 private:
  std::atomic<std::uint32_t> known_{0};  // bits of the recorded faults
};

/// Records the faults of each tick that the recorder writes, and passes all records to the next sink. It runs
/// in the recorder's thread, never in the servo thread.
class FaultSink final : public io::RecordSink {
 public:
  /// @param next  gets the same records. Both parameters must outlive this object.
  FaultSink(io::RecordSink& next, FaultEvents& events) : next_(next), events_(events) {}
  /// @param recorder  gets the events; must outlive the last tick
  void RecordIn(io::Recorder& recorder) { recorder_ = &recorder; }

  void TakeTick(const control::TickRecord& tick) override {
    if (recorder_ && tick.faults != 0) events_.Record(*recorder_, tick.stamp, tick.faults);
    next_.TakeTick(tick);
  }
  void TakeFrame(const simulation::FrameRecord& frame) override { next_.TakeFrame(frame); }
  void TakeEvent(const io::RecordedEvent& event) override { next_.TakeEvent(event); }

 private:
  io::RecordSink& next_;
  FaultEvents& events_;
  io::Recorder* recorder_{nullptr};  // null: not set yet, no event is recorded
};

}  // namespace osteon::session
