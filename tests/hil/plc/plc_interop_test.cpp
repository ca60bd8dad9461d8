// Tests the product's PLC client, which uses libmodbus, with the simulated PLC, which has a codec of its own.

#include <gtest/gtest.h>

#include <functional>

#include "hil/plc/plc_server.h"
#include "io/modbus/plc_client.h"

namespace osteon::hil {
namespace {

using io::PlcLink;
using io::PlcVerdict;

// A simulated PLC with two clients, the controller and the guard, as in a cell. The function Until() replaces
// their loops.
class PlcCell : public ::testing::Test {
 protected:
  // Starts the PLC and connects both clients. The guard requests motion.
  void Open(const PlcServerParams& params, int response_timeout_ms = 500) {
    server_ = std::make_unique<PlcServer>(params);
    const auto client = [&](io::PlcRole role) {
      return std::make_unique<io::PlcClient>(io::PlcClientParams{.port = server_->port(),
                                                                 .role = role,
                                                                 .heartbeat_every_ms = 20,
                                                                 .response_timeout_ms = response_timeout_ms,
                                                                 .longest_pause_ms = 100});
    };
    controller_ = client(io::PlcRole::kController);
    guard_ = client(io::PlcRole::kGuard);
    guard_->RequestMotion(true);
  }
  // Runs both loops until `holds` is true. Returns false if that takes longer than about 20 s.
  bool Until(const std::function<bool()>& holds) {
    for (int i = 0; i < 20'000; ++i) {
      if (controller_lives_) controller_->NotifyAlive();
      if (guard_lives_) guard_->NotifyAlive();
      if (holds()) return true;
      rt::SleepUntil(rt::MonotonicNow() + rt::kMillisecond);
    }
    return false;
  }
  // The controller's verdict on its newest reading. The reading may be at most 1 s old.
  PlcVerdict Verdict() { return io::Judge(controller_->Latest(), rt::MonotonicNow(), rt::kSecond); }
  // Resets the PLC at its panel and requests motion. Returns true once motion is permitted.
  bool Start() {
    server_->SetPanel({.enabling = EnablingSwitch::kMiddle, .foot_pedal = true, .mode = ModeSelector::kT1});
    if (!Until([&] { return (server_->outputs().blocks & 0x3f) == 0; }))
      return false;  // for example, a heartbeat is missing
    server_->SetPanel(
        {.enabling = EnablingSwitch::kMiddle, .foot_pedal = true, .mode = ModeSelector::kT1, .reset = true});
    if (!Until([&] { return DescribeBlocks(server_->outputs().blocks) == "not requested"; })) return false;
    server_->SetPanel({.enabling = EnablingSwitch::kMiddle, .foot_pedal = true, .mode = ModeSelector::kT1});
    controller_->RequestMotion(true);
    return Until([&] { return Verdict() == PlcVerdict::kRun; });
  }

  // The heartbeat's timeout is an hour. So only the tests of the heartbeat depend on how busy the machine is.
  PlcServerParams params_{.port = 0, .logic = {.heartbeat_timeout = 3600 * rt::kSecond}};
  std::unique_ptr<PlcServer> server_;
  std::unique_ptr<io::PlcClient> controller_, guard_;
  bool controller_lives_{true}, guard_lives_{true};
};

TEST_F(PlcCell, AGuardThatWithdrawsItsRequestStopsMotionUntilTheReset) {
  Open(params_);
  ASSERT_TRUE(Start()) << DescribeBlocks(server_->outputs().blocks);
  guard_->RequestMotion(false);
  EXPECT_TRUE(Until([&] { return Verdict() == PlcVerdict::kNotPermitted; })) << "though both beat";
  const auto withdrew = static_cast<std::uint16_t>(PlcBlock::kGuardWithdrew);
  EXPECT_NE(server_->outputs().blocks & withdrew, 0);
  guard_->RequestMotion(true);
  const auto written = guard_->Latest().counters.writes;
  ASSERT_TRUE(Until([&] { return guard_->Latest().counters.writes > written + 2; }));
  EXPECT_EQ(Verdict(), PlcVerdict::kNotPermitted) << "latched";
  controller_->RequestMotion(false);  // withdraws the request, because Start() must make a new one
  const auto withdrawn = controller_->Latest().counters.writes;
  ASSERT_TRUE(Until([&] { return controller_->Latest().counters.writes > withdrawn + 2; }));
  EXPECT_TRUE(Start()) << DescribeBlocks(server_->outputs().blocks);
}

TEST_F(PlcCell, StartsAndEveryRegisterArrives) {
  Open(params_);
  ASSERT_TRUE(Start()) << DescribeBlocks(server_->outputs().blocks);
  const io::PlcReading& reading = controller_->Latest();
  EXPECT_EQ(reading.inputs.mode, io::PlcMode::kT1);
  EXPECT_EQ(reading.inputs.enabling, io::PlcEnabling::kEnabled);
  EXPECT_TRUE(reading.inputs.foot_pedal && reading.inputs.spindle_permitted && reading.inputs.power_on);
  EXPECT_FALSE(reading.inputs.emergency_stop || reading.inputs.brake_test_requested);
  EXPECT_EQ(reading.inputs.version, 3);

  server_->SetPanel({.emergency_stop = true, .enabling = EnablingSwitch::kSqueezed, .brake_test_due = true});
  EXPECT_TRUE(Until([&] { return Verdict() == PlcVerdict::kEmergencyStop; }));
  EXPECT_EQ(controller_->Latest().inputs.enabling, io::PlcEnabling::kSqueezed);
  EXPECT_TRUE(controller_->Latest().inputs.brake_test_requested);
  EXPECT_TRUE(Until([&] { return !controller_->Latest().inputs.power_on; })) << "whatever the software does";
}

// An enabling switch that was squeezed passes its middle position when it is let go. The middle position must
// not count as enabled until the switch has been released. The client ensures this, not the PLC's program.
TEST_F(PlcCell, ASqueezedSwitchCountsAsEnabledOnlyAfterItsRelease) {
  Open(params_);
  const auto shows = [&](EnablingSwitch set, io::PlcEnabling counts) {
    server_->SetPanel({.enabling = set});
    const std::uint32_t reads = controller_->Latest().counters.reads;
    if (!Until([&] { return controller_->Latest().counters.reads > reads + 5; })) return false;
    return controller_->Latest().inputs.enabling == counts;
  };
  EXPECT_TRUE(shows(EnablingSwitch::kMiddle, io::PlcEnabling::kEnabled));
  EXPECT_TRUE(shows(EnablingSwitch::kSqueezed, io::PlcEnabling::kSqueezed));
  EXPECT_TRUE(shows(EnablingSwitch::kMiddle, io::PlcEnabling::kSqueezed));
  EXPECT_TRUE(shows(EnablingSwitch::kReleased, io::PlcEnabling::kReleased));
  EXPECT_TRUE(shows(EnablingSwitch::kMiddle, io::PlcEnabling::kEnabled));
}

TEST_F(PlcCell, ALoopThatHangsStopsMotion) {
  params_.logic.heartbeat_timeout = 2 * rt::kSecond;
  for (const bool guard : {false, true}) {
    Open(params_);
    controller_lives_ = guard_lives_ = true;
    ASSERT_TRUE(Start()) << DescribeBlocks(server_->outputs().blocks);
    (guard ? guard_lives_ : controller_lives_) = false;  // its Modbus thread still runs
    EXPECT_TRUE(Until([&] { return Verdict() == PlcVerdict::kNotPermitted; }));
    const auto lost = static_cast<std::uint16_t>(guard ? PlcBlock::kGuardLost : PlcBlock::kControllerLost);
    EXPECT_TRUE(server_->outputs().blocks & lost) << DescribeBlocks(server_->outputs().blocks);
    EXPECT_EQ(controller_->Latest().link, PlcLink::kConnected);
  }
}

TEST_F(PlcCell, AStoppedPlcProgramIsDetected) {
  Open(params_);
  ASSERT_TRUE(Start());
  server_->StopProgram(true);
  EXPECT_TRUE(Until([&] { return Verdict() == PlcVerdict::kPlcStopped; }));
  EXPECT_TRUE(controller_->Latest().inputs.run_permitted) << "which the registers alone would not say";
}

TEST_F(PlcCell, ALostConnectionIsMadeAgain) {
  Open(params_);
  ASSERT_TRUE(Start());
  server_->DropConnections();
  ASSERT_TRUE(Until([&] { return controller_->Latest().counters.lost > 0; }));
  EXPECT_TRUE(Until([&] { return Verdict() == PlcVerdict::kRun; }))
      << "a short gap is within the heartbeat's time";
  EXPECT_GE(server_->counters().connections, 3u);
}

// One answer takes 30 ms, the timeout is 20 ms. The connection must stay open. Only the reading gets older,
// and the cell's max_age_ms limits its age.
TEST_F(PlcCell, OneLateAnswerKeepsTheConnection) {
  Open(params_, 20);
  ASSERT_TRUE(Start());
  guard_.reset();  // without the guard, the late answer is surely the controller's
  guard_lives_ = false;
  const io::PlcCounters before = controller_->Latest().counters;
  server_->DelayNextAnswer(30 * rt::kMillisecond);
  bool connected = true;
  ASSERT_TRUE(Until([&] {
    const io::PlcReading& reading = controller_->Latest();
    connected &= reading.link == PlcLink::kConnected;
    return reading.counters.timeouts > before.timeouts && reading.counters.reads > before.reads + 5;
  }));
  EXPECT_TRUE(connected);
  EXPECT_EQ(Verdict(), PlcVerdict::kRun);
}

TEST_F(PlcCell, ABusyPlcKeepsItsConnectionUntilTheReadingIsTooOld) {
  Open(params_);
  ASSERT_TRUE(Start());
  const io::PlcCounters before = controller_->Latest().counters;
  const rt::Nanoseconds stamp = controller_->Latest().stamp;
  server_->RefuseAsBusy(6);
  ASSERT_TRUE(Until([&] { return controller_->Latest().counters.reads > before.reads + 10; }));
  EXPECT_GT(controller_->Latest().counters.rejected, before.rejected);
  EXPECT_EQ(controller_->Latest().counters.lost, before.lost);
  EXPECT_GT(controller_->Latest().stamp, stamp);
  EXPECT_EQ(Verdict(), PlcVerdict::kRun);
  // if the PLC is busy permanently, the registers become too old, and the text for the operator gives the
  // reason
  server_->RefuseAsBusy(1'000'000);
  ASSERT_TRUE(Until([&] { return Verdict() == PlcVerdict::kStale; }));
  EXPECT_EQ(controller_->Latest().counters.lost, before.lost);
  const std::string line = io::Describe({.port = server_->port()}, controller_->Latest());
  EXPECT_NE(line.find("it answers no more: Slave device or server is busy"), std::string::npos) << line;
}

TEST_F(PlcCell, AServerThatHangsCountsAsNoConnection) {
  Open(params_);
  ASSERT_TRUE(Start());
  server_->SetHung(true);
  ASSERT_TRUE(Until([&] { return Verdict() == PlcVerdict::kNoConnection; }));
  EXPECT_GE(controller_->Latest().counters.timeouts, 1u);
  server_->SetHung(false);
  EXPECT_TRUE(Until([&] { return controller_->Latest().link == PlcLink::kConnected; }));
}

TEST_F(PlcCell, APlcOfAnotherVersionIsNeverWrittenTo) {
  params_.logic.version = 4;
  Open(params_);
  ASSERT_TRUE(Until([&] { return Verdict() == PlcVerdict::kWrongVersion; }));
  ASSERT_TRUE(Until([&] { return server_->counters().requests > 5; })) << "it goes on asking";
  EXPECT_EQ(controller_->Latest().counters.writes, 0u);
  EXPECT_TRUE(server_->outputs().blocks & static_cast<std::uint16_t>(PlcBlock::kNoController));
  EXPECT_EQ(io::Describe({.port = server_->port()}, controller_->Latest()),
            "PLC 127.0.0.1:" + std::to_string(server_->port()) +
                ": VERSION (977): found 4, accepted 3; nothing is written to it");
}

}  // namespace
}  // namespace osteon::hil
