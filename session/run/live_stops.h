#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>

#include "io/recording/record_sink.h"
#include "session/stops/stop_records.h"

namespace osteon::session {

struct LiveStopsParams {
  const config::CellConfig& cell;   ///< must outlive the LiveStops
  std::filesystem::path recording;  ///< the run's recording
  std::filesystem::path folder;     ///< folder for the pages
  std::string console_url{};        ///< address of the cell's page; empty: not served
  double force_limit_N{0.0};
};

/// Writes the page of each stop while the cell still runs, half a second after the arm has come to rest, with
/// a link to the cell's page. At the run's end the same pages are written again, from the whole recording.
///
///     recorder ──▶ LiveStops ──▶ next
///                     └─ complete stop ─▶ thread of low priority ─▶ page, table
///
/// The recorder's writer never waits for the page. If a page cannot be written, the run's end tries again and
/// reports the reason.
class LiveStops final : public io::RecordSink {
 public:
  /// @param next  gets all records; must outlive this object
  LiveStops(LiveStopsParams params, io::RecordSink& next);
  ~LiveStops() override;
  LiveStops(const LiveStops&) = delete;
  LiveStops& operator=(const LiveStops&) = delete;

  void TakeTick(const control::TickRecord& tick) override;
  void TakeFrame(const simulation::FrameRecord& frame) override { next_.TakeFrame(frame); }
  void TakeEvent(const io::RecordedEvent& event) override { next_.TakeEvent(event); }

  /// Writes the pages that still wait, and ends the thread. Call it after the last tick.
  void Finish();

 private:
  struct Stop {
    StopRecord record;
    std::size_t number;  // counts the run's stops from 1
  };
  // The thread's function: writes the page of each stop in stops_, until Finish.
  void Run();

  LiveStopsParams params_;
  io::RecordSink& next_;
  StopFinder finder_;     // used only by the recorder's writer, like count_
  std::size_t count_{0};  // number of stops so far

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Stop> stops_;  // stops whose pages are not written yet; guarded by mutex_
  bool ended_{false};       // guarded by mutex_
  std::thread thread_;
};

}  // namespace osteon::session
