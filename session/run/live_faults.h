#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "config/reading/cell_config.h"
#include "console/stream/live_status.h"
#include "io/recording/record_sink.h"
#include "safety/fault.h"

namespace osteon::session {

/// Keeps the measured values of the tick in which each fault of a running cell was latched, and passes all
/// records on:
///
///     recorder ──▶ LiveFaults ──▶ LiveLatency
///                      └── Of(fault) ◀── page, local socket
///
/// The recorder's writer never waits: it only tries the lock.
class LiveFaults final : public io::RecordSink {
 public:
  /// @param cell  outlives this  @param recording  names the pages of the stops  @param next  gets all
  /// records; outlives this
  LiveFaults(const config::CellConfig& cell, std::filesystem::path recording, io::RecordSink& next);

  void TakeTick(const control::TickRecord& tick) override;
  void TakeFrame(const simulation::FrameRecord& frame) override { next_.TakeFrame(frame); }
  void TakeEvent(const io::RecordedEvent& event) override { next_.TakeEvent(event); }

  /// The note of a latched fault; empty texts: it is not latched, or nothing was measured. Any thread.
  [[nodiscard]] console::FaultNote Of(safety::Fault fault) const;

 private:
  // Counts a stop that begins, and updates the texts of faults that were latched or cleared in this tick.
  void UpdateSeen(const control::TickRecord& tick);

  // of the recorder's writer alone
  const config::CellConfig& cell_;
  std::filesystem::path recording_;
  io::RecordSink& next_;
  control::TickRecord before_;                 // the last tick
  bool begun_{false};                          // a tick has come
  std::size_t stops_{0};                       // number of stops so far: the number of the last one's page
  bool stopped_{false};                        // a stop has begun since the arm moved last
  std::map<safety::Fault, std::string> seen_;  // measured values of the latched faults, in words
  bool changed_{false};                        // the notes have changed and are not yet published

  mutable std::mutex mutex_;  // guards what follows
  std::map<safety::Fault, console::FaultNote> notes_;
};

}  // namespace osteon::session
