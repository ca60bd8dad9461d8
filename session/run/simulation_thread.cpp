#include "session/run/simulation_thread.h"

#include <exception>

#include "base/paced_priority.h"
#include "base/realtime_thread.h"

namespace osteon::session {

SimulationThread::SimulationThread(FrameRunner& runner, rt::LatestValue<simulation::ToolCommand>& commands,
                                   rt::LatestValue<simulation::ContactModel>& models, io::Recorder& recorder)
    : runner_(runner), commands_(commands), models_(models), recorder_(recorder), thread_([this] {
        try {
          Loop();
        } catch (const std::exception& error) {
          error_ = error.what();
        }
      }) {}

SimulationThread::~SimulationThread() { Stop(); }

void SimulationThread::Stop() {
  stop_.store(true);
  if (thread_.joinable()) thread_.join();
}

void SimulationThread::Loop() {
  rt::NameThread("simulation");
  rt::PacedPriority priority;
  rt::Nanoseconds done = 0;
  while (!stop_.load(std::memory_order_relaxed)) {
    const simulation::ToolCommand command = commands_.Load();
    const rt::Nanoseconds start = rt::MonotonicNow();
    if (command.stamp == done) {
      rt::SleepUntil(start + 50'000);  // poll every 50 us; commands come once a millisecond
      continue;
    }
    done = command.stamp;
    simulation::FrameRecord record = runner_.Run(command);
    models_.Store(record.model);
    record.stamp = rt::MonotonicNow();
    record.duration_ns = record.stamp - start;
    recorder_.PushFrame(record);
    runner_.AdaptResolution(record, 1e-3 * static_cast<double>(record.duration_ns));
    runner_.RecordEvents(recorder_, record.stamp);
    priority.CountWork(rt::MonotonicNow());
    if (record.model.status == simulation::EngineStatus::kDeviceLost)
      return;  // the servo loop stops when the model gets too old
  }
}

}  // namespace osteon::session
