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

#include "base/spsc_ring.h"
#include "control/ports.h"
#include "io/recording/mcap_writer.h"
#include "io/recording/messages.h"
#include "io/recording/record_sink.h"
#include "io/recording/record_topics.h"
#include "simulation/engine/frame_record.h"

namespace osteon::io {

struct RecorderParams {
  std::filesystem::path path;
  std::size_t tick_capacity{8192};   ///< most ticks that may wait for the disk: 8 s at 1 kHz
  std::size_t frame_capacity{8192};  ///< most frames that may wait for the disk
  /// Number of waiting ticks from which the writer counts as stalled. The rest of the ring must hold all
  /// ticks of the stop that follows.
  std::size_t stalled_ticks{2048};
  bool writer_thread{true};       ///< false: the owner calls Drain (virtual time)
  RecordSink* live{nullptr};      ///< receives every message as well; must outlive the recorder; null: none
  RecordTopics* topics{nullptr};  ///< adds derived topics, and outlives the recorder; null: none
};

/// Counts of a closed recording, including losses.
struct RecordingCounts {
  std::uint64_t ticks{0}, frames{0}, events{0};
  std::uint64_t dropped_ticks{0}, dropped_frames{0};  ///< refused by a full ring, as the disk was too slow
  std::uint64_t unwritten{0};  ///< messages of all kinds that the disk did not accept (for example because it
                               ///< is full)
  std::uint64_t bytes{0};
};

/// Records a session as MCAP.
///
///     servo thread ──Push──▶ ring ─┐
///     simulation ──PushFrame▶ ring ─┼─▶ Drain: merged by stamp ─▶ file
///     anybody ───PushEvent──▶ list ─┘             └─▶ RecordSink: a live view
///
/// In wall time a thread calls Drain every 20 ms. In virtual time the owner calls it, so that two equal runs
/// give equal bytes. Order among equal stamps: tick, frame, event.
///
/// A kill -9 loses what was pushed in the last 0.3 s: a chunk is passed to the system once it has 256 KiB or
/// is 0.25 s old. In wall time a second thread brings the file to the disk itself (fdatasync) every second,
/// so that neither the tick nor the writer waits for the disk. A power cut loses about one second more. In
/// virtual time the file is not brought to the disk, because such a run can be repeated.
///
/// A full disk, or a removed file, stops only the recording: error() reports it at once, the rings are
/// emptied as before, and losses are counted.
class Recorder final : public control::TickRecorder {
 public:
  /// Creates or overwrites the file. The error names the path and the reason.
  [[nodiscard]] static tl::expected<std::unique_ptr<Recorder>, std::string> Open(const RecorderParams& params,
                                                                                 const SessionInfo& session);
  /// Closes without reporting an error, so call Close if errors matter.
  ~Recorder() override;
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Servo thread only. Returns false, and counts the tick as dropped, if the ring is full because the disk
  /// is too slow.
  bool Push(const control::TickRecord& record) OSTEON_RT override;
  /// Servo thread only. Whether at least RecorderParams::stalled_ticks ticks are waiting: by default 2 s at 1
  /// kHz.
  [[nodiscard]] bool Stalled() const OSTEON_RT override { return ticks_.waiting() >= stalled_ticks_; }
  /// Simulation thread only. Returns false, and counts the frame as dropped, if the ring is full because the
  /// disk is too slow.
  bool PushFrame(const simulation::FrameRecord& record) OSTEON_RT;
  /// Any thread except the tick's, because it allocates and locks.
  void PushEvent(rt::Nanoseconds stamp, std::string text);
  void PushEvent(RecordedEvent event);

  /// Writes everything pushed so far. One thread at a time; meant for virtual time.
  void Drain();

  /// The file's first error so far, with its path; empty if there was none. Any thread except the tick's.
  [[nodiscard]] std::string error() const;
  /// Counts so far; `bytes` is set only after Close. Any thread except the tick's.
  [[nodiscard]] RecordingCounts counts() const;

  /// Writes the messages still waiting, the summary and the footer. Call it after the pushing threads have
  /// ended; a second call gives the same result. The error names the path, the reason (a full disk, for
  /// example) and how much was lost.
  tl::expected<RecordingCounts, std::string> Close();

 private:
  Recorder(const RecorderParams& params, McapWriter writer);
  // The bodies of the two threads: RunWriter drains the queues into the file, RunSync brings the file to the
  // disk each second.
  void RunWriter();
  void RunSync();
  // Waits until Close, at most for `time`. True if Close was called.
  [[nodiscard]] bool WaitForStop(std::chrono::milliseconds time);
  // Writes everything pushed so far, merged by stamp. @param end_chunk  also ends the present chunk
  void Write(bool end_chunk);

  std::size_t stalled_ticks_;
  RecordSink* live_;
  RecordTopics* topics_;
  rt::SpscRing<control::TickRecord> ticks_;
  rt::SpscRing<simulation::FrameRecord> frames_;
  std::mutex events_mutex_;
  std::vector<RecordedEvent> events_;  // guarded by events_mutex_

  mutable std::mutex writer_mutex_;  // guards the members below, which write the file
  McapWriter writer_;
  std::uint16_t tick_channel_{0}, frame_channel_{0}, event_channel_{0};
  std::string bytes_;  // scratch
  RecordingCounts counts_;
  bool to_disk_{false};  // true in wall time: Close waits until the file is on the disk
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
