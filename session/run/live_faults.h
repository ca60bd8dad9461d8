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

/// Keeps, for each latched fault of a running cell, the values measured in the tick in which it was latched.
/// Passes all records on:
///
///     recorder ──▶ LiveFaults ──▶ LiveLatency
///                      └── Of(fault) ◀── page, local socket
///
/// The recorder's writer never waits: it only tries the lock.
class LiveFaults final : public io::RecordSink {
 public:
  /// @param cell  must outlive this object  @param recording  the pages of the stops are named after it
  /// @param next  gets all records; must outlive this object
  LiveFaults(const config::CellConfig& cell, std::filesystem::path recording, io::RecordSink& next);

  void TakeTick(const control::TickRecord& tick) override;
  void TakeFrame(const simulation::FrameRecord& frame) override { next_.TakeFrame(frame); }
  void TakeEvent(const io::RecordedEvent& event) override { next_.TakeEvent(event); }

  /// The note of a latched fault; its texts are empty if the fault is not latched, or nothing was measured.
  /// Any thread.
  [[nodiscard]] console::FaultNote Of(safety::Fault fault) const;

 private:
  // Counts the stop if one begins in this tick, and updates the texts of faults that were latched or cleared
  // in it.
  void UpdateSeen(const control::TickRecord& tick);

  // only the recorder's thread uses the following members
  const config::CellConfig& cell_;
  std::filesystem::path recording_;
  io::RecordSink& next_;
  control::TickRecord before_;                 // the last tick
  bool begun_{false};                          // at least one tick was taken
  std::size_t stops_{0};                       // number of stops so far: the number of the last stop's page
  bool stopped_{false};                        // a stop has begun, and the arm has not moved again since
  std::map<safety::Fault, std::string> seen_;  // measured values of the latched faults, in words
  bool changed_{false};                        // the notes have changed and are not published yet

  mutable std::mutex mutex_;  // guards the members below
  std::map<safety::Fault, console::FaultNote> notes_;
};

}  // namespace osteon::session
