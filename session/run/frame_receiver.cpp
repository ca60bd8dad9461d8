#include "session/run/frame_receiver.h"

#include <exception>

#include "base/paced_priority.h"
#include "base/realtime_thread.h"

namespace osteon::session {
namespace {

constexpr rt::Nanoseconds kWait = 5 * rt::kMillisecond;  // longest wait for a frame before Stop is checked

}  // namespace

FrameReceiver::FrameReceiver(FrameRunner& runner, io::EngineClient& client, io::Recorder& recorder)
    : runner_(runner), client_(client), recorder_(recorder), thread_([this] {
        try {
          Loop();
        } catch (const std::exception& error) {
          error_ = error.what();
        }
      }) {}

FrameReceiver::~FrameReceiver() { Stop(); }

void FrameReceiver::Stop() {
  stop_.store(true);
  if (thread_.joinable()) thread_.join();
}

void FrameReceiver::Loop() {
  rt::NameThread("frames");
  rt::PacedPriority priority;
  for (;;) {
    const bool last = stop_.load(std::memory_order_relaxed);
    io::EngineFrame frame;
    while (client_.AwaitFrame(frame, last ? 0 : rt::MonotonicNow() + kWait)) {
      simulation::FrameRecord record =
          runner_.Observe(frame.model, frame.spindle_rad_per_s, frame.model.pose_stamp);
      record.stamp = rt::MonotonicNow();
      record.duration_ns = frame.duration_ns;
      recorder_.PushFrame(record);
      runner_.RecordEvents(recorder_, record.stamp);
      priority.CountWork(rt::MonotonicNow());
    }
    if (last) return;
  }
}

}  // namespace osteon::session
