#include "session/run/live_faults.h"

#include <gtest/gtest.h>

#include "safety/cell_state.h"

namespace osteon::session {
namespace {

using safety::Fault;

// Counts the ticks that LiveFaults passes on.
class Sink final : public io::RecordSink {
 public:
  void TakeTick(const control::TickRecord&) override { ++ticks; }
  void TakeFrame(const simulation::FrameRecord&) override {}
  void TakeEvent(const io::RecordedEvent&) override {}
  int ticks{0};
};

control::TickRecord TickOf(control::Phase phase, Fault fault = Fault::kNone, double sensor_age_s = 0.0) {
  control::TickRecord tick;
  tick.phase = phase;
  tick.faults = static_cast<std::uint32_t>(fault);
  tick.sensor_age_s = sensor_age_s;
  return tick;
}

TEST(LiveFaults, KeepsTheValueMeasuredWhenTheFaultOccurred) {
  const config::CellConfig cell{};
  Sink sink;
  LiveFaults faults(cell, "out/run.mcap", sink);
  faults.TakeTick(TickOf(control::Phase::kHaptic));
  EXPECT_EQ(faults.Of(Fault::kSensorStale).seen, "");
  faults.TakeTick(TickOf(control::Phase::kStopping, Fault::kSensorStale, 0.101));
  faults.TakeTick(TickOf(control::Phase::kStopped, Fault::kSensorStale, 0.9));  // older, at rest
  EXPECT_EQ(faults.Of(Fault::kSensorStale).seen, "the reading is 101 ms old, accepted 100 ms");
  EXPECT_EQ(faults.Of(Fault::kSensorStale).page, "out/run_stop_1.html");
  EXPECT_EQ(faults.Of(Fault::kInterlock).seen, "") << "another one";
  EXPECT_EQ(sink.ticks, 3);
}

TEST(LiveFaults, ARecoveryClearsTheFaultsAndTheNextStopHasTheNextPage) {
  const config::CellConfig cell{};
  Sink sink;
  LiveFaults faults(cell, "run.mcap", sink);
  faults.TakeTick(TickOf(control::Phase::kHaptic));
  faults.TakeTick(TickOf(control::Phase::kStopped, Fault::kSensorStale, 0.101));
  faults.TakeTick(TickOf(control::Phase::kWaiting));  // recovered
  EXPECT_EQ(faults.Of(Fault::kSensorStale).seen, "");
  faults.TakeTick(TickOf(control::Phase::kHaptic));
  faults.TakeTick(TickOf(control::Phase::kStopping, Fault::kSensorStale, 0.103));
  EXPECT_EQ(faults.Of(Fault::kSensorStale).seen, "the reading is 103 ms old, accepted 100 ms");
  EXPECT_EQ(faults.Of(Fault::kSensorStale).page, "run_stop_2.html");
}

TEST(LiveFaults, AFaultBeforeAnyMotionHasNoStopAndNoPage) {
  const config::CellConfig cell{};
  Sink sink;
  LiveFaults faults(cell, "run.mcap", sink);
  faults.TakeTick(TickOf(control::Phase::kWaiting));
  faults.TakeTick(TickOf(control::Phase::kStopped, Fault::kSensorStale, 0.101));
  EXPECT_NE(faults.Of(Fault::kSensorStale).seen, "");
  EXPECT_EQ(faults.Of(Fault::kSensorStale).page, "");
}

}  // namespace
}  // namespace osteon::session
