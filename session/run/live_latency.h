#pragma once

#include <mutex>

#include "config/reading/cell_config.h"
#include "console/stream/live_status.h"
#include "io/recording/record_sink.h"
#include "session/summary/latency.h"

namespace osteon::session {

/// Measures a run's latency during the run, in the same way as the summary at its end. Passes all records on:
///
///     recorder ──▶ LiveLatency ──▶ LiveFeed
///                      └── Status() ◀── status line, page, local socket
///
/// The recorder's writer never waits: it only tries the lock.
class LiveLatency final : public io::RecordSink {
 public:
  /// @param next  gets all records; must outlive this object
  LiveLatency(const config::CellConfig& cell, io::RecordSink& next);

  void TakeTick(const control::TickRecord& tick) override;
  void TakeFrame(const simulation::FrameRecord& frame) override { next_.TakeFrame(frame); }
  void TakeEvent(const io::RecordedEvent& event) override { next_.TakeEvent(event); }

  /// The latency of the run so far; it is not known before the arm is commanded. Any thread may call it.
  [[nodiscard]] console::LatencyStatus Status() const;

 private:
  // used only by the recorder's writer
  io::RecordSink& next_;
  LatencyMeter meter_;
  LatencyContext context_;
  double period_s_;
  int ticks_{0};  // number of ticks since the figures were published

  mutable std::mutex mutex_;  // guards figures_
  LatencyFigures figures_;
};

}  // namespace osteon::session
