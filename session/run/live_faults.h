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

/// Keeps what was measured when each fault of a running cell was latched, and passes what is recorded on:
///
///     recorder ──▶ LiveFaults ──▶ LiveLatency
///                      └── Of(fault) ◀── page, local socket
///
/// The recorder's writer never waits: it only tries the lock.
class LiveFaults final : public io::RecordSink {
 public:
  /// @param cell  outlives this  @param recording  whose name the stops' pages have  @param next  gets
  /// everything; outlives this
  LiveFaults(const config::CellConfig& cell, std::filesystem::path recording, io::RecordSink& next);

  void TakeTick(const control::TickRecord& tick) override;
  void TakeFrame(const simulation::FrameRecord& frame) override { next_.TakeFrame(frame); }
  void TakeEvent(const io::RecordedEvent& event) override { next_.TakeEvent(event); }

  /// The note of a latched fault; empty texts: it is not latched, or nothing was measured. Any thread.
  [[nodiscard]] console::FaultNote Of(safety::Fault fault) const;

 private:
  void Look(const control::TickRecord& tick);

  // of the recorder's writer alone
  const config::CellConfig& cell_;
  std::filesystem::path recording_;
  io::RecordSink& next_;
  control::TickRecord before_;
  bool begun_{false};
  std::size_t stops_{0};  // so far, as their pages are numbered
  bool stopped_{false};   // since the arm moved last
  std::map<safety::Fault, std::string> seen_;
  bool changed_{false};  // and not yet published

  mutable std::mutex mutex_;  // guards what follows
  std::map<safety::Fault, console::FaultNote> notes_;
};

}  // namespace osteon::session
