#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <tl/expected.hpp>

#include "control/ports.h"
#include "control/rt/spsc_ring.h"
#include "io/recording/mcap_writer.h"
#include "io/recording/messages.h"
#include "simulation/frame_record.h"

namespace osteon::io {

struct RecorderParams {
  std::filesystem::path path;
  std::size_t tick_capacity{8192};   ///< ticks that wait for the disk: 8 s at 1 kHz
  std::size_t frame_capacity{8192};  ///< frames that wait for the disk
  /// So many that wait mean that the writer stands still: early enough for a stop that is recorded to its
  /// end.
  std::size_t stalled_ticks{2048};
  bool writer_thread{true};  ///< false: the owner calls Drain (virtual time)
};

/// What a closed recording holds, and what it could not take.
struct RecordingCounts {
  std::uint64_t ticks{0}, frames{0}, events{0};
  std::uint64_t dropped_ticks{0}, dropped_frames{0};  ///< the disk was behind: refused by a full ring
  std::uint64_t unwritten{0};  ///< messages of all kinds that the disk would not take (it is full, say)
  std::uint64_t bytes{0};
};

/// Records a session as MCAP.
///
///     servo thread ──Push──▶ ring ─┐
///     simulation ──PushFrame▶ ring ─┼─▶ Drain: merged by stamp ─▶ file
///     anybody ───PushEvent──▶ list ─┘
///
/// In wall time a thread drains every 20 ms; in virtual time the owner does, and two equal runs give equal
/// bytes. Among equal stamps: tick, frame, event.
///
/// What a kill -9 takes is what was pushed in the last 0.3 s: a chunk is handed to the system once it is
/// 64 KiB or 0.25 s old. In wall time a second thread brings it to the disk itself (fdatasync) every second,
/// so that neither the tick nor the writer waits for the disk; a power cut takes about that second more. In
/// virtual time nothing is synchronised: such a run can be had again.
///
/// A disk that is full, or a file that was removed, stops the recording and nothing else: error() says so at
/// once, the rings are emptied as before, what is lost is counted.
class Recorder final : public control::TickRecorder {
 public:
  /// Creates or overwrites the file. The error names the path and the reason.
  [[nodiscard]] static tl::expected<std::unique_ptr<Recorder>, std::string> Open(const RecorderParams& params,
                                                                                 const SessionInfo& session);
  /// Closes; an error is then lost, so call Close where it matters.
  ~Recorder() override;
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Servo thread only. False, and counted, where the disk is behind.
  bool Push(const control::TickRecord& record) OSTEON_RT override;
  /// Servo thread only: RecorderParams::stalled_ticks wait, 2 s at 1 kHz.
  [[nodiscard]] bool Stalled() const OSTEON_RT override { return ticks_.waiting() >= stalled_ticks_; }
  /// Simulation thread only. False, and counted, where the disk is behind.
  bool PushFrame(const simulation::FrameRecord& record) OSTEON_RT;
  /// Any thread but those of the tick: allocates and locks.
  void PushEvent(rt::Nanoseconds stamp, std::string text);

  /// Writes everything pushed so far. Any one thread; meant for virtual time.
  void Drain();

  /// What went wrong with the file so far, with its path; empty where nothing did. Any thread but the tick's.
  [[nodiscard]] std::string error() const;
  /// So far; bytes only after Close. Any thread but the tick's.
  [[nodiscard]] RecordingCounts counts() const;

  /// Writes the rest, the summary and the footer. To be called once the pushing threads have ended; calling
  /// it again gives the same answer. The error names the path, the reason (a full disk, say) and how much was
  /// lost.
  tl::expected<RecordingCounts, std::string> Close();

 private:
  Recorder(const RecorderParams& params, McapWriter writer);
  void RunWriter();
  void RunSync();
  [[nodiscard]] bool WaitForStop(std::chrono::milliseconds time);
  void Write(bool end_chunk);

  std::size_t stalled_ticks_;
  rt::SpscRing<control::TickRecord> ticks_;
  rt::SpscRing<simulation::FrameRecord> frames_;
  std::mutex events_mutex_;
  std::vector<RecordedEvent> events_;  // guarded by events_mutex_

  mutable std::mutex writer_mutex_;  // guards what follows: the file's side
  McapWriter writer_;
  std::uint16_t tick_channel_{0}, frame_channel_{0}, event_channel_{0};
  std::string bytes_;  // scratch
  RecordingCounts counts_;
  bool to_disk_{false};  // wall time: what is closed is on the disk
  bool closed_{false};
  std::string close_error_;

  std::mutex stop_mutex_;
  std::condition_variable stop_changed_;
  bool stop_{false};  // guarded by stop_mutex_
  mutable std::mutex sync_mutex_;
  std::string sync_error_;  // guarded by sync_mutex_
  std::thread writer_thread_, sync_thread_;
};

}  // namespace osteon::io
