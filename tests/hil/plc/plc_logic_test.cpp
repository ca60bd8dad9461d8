#include "hil/plc/plc_logic.h"

#include <functional>
#include <stdexcept>

#include <gtest/gtest.h>

// Tests the simulated PLC's program: what blocks motion, what restores it, and when power is switched off.

namespace osteon::hil {
namespace {

// The PLC's program in virtual time, with a cycle of 10 ms. Both heartbeats count up unless a test switches
// them off.
class Bench {
 public:
  explicit Bench(const PlcLogicParams& params = {}) : plc(params) {}

  // Runs the program for this time [ms] and returns its last outputs.
  const PlcLogicOutputs& Run(int ms) {
    for (int i = 0; i < ms; i += 10) {
      now += 10 * rt::kMillisecond;
      if (controller_beats) ++in.controller_heartbeat;
      if (guard_beats) ++in.guard_heartbeat;
      plc.Step(now, in);
    }
    return plc.outputs();
  }
  void PressReset() {
    in.reset = true;
    Run(10);
    in.reset = false;
    Run(10);
  }
  // Withdraws the request for motion, then makes it again.
  void RequestAnew() {
    in.motion_request = false;
    Run(10);
    in.motion_request = true;
    Run(10);
  }
  // Brings the PLC to the state in which motion is permitted.
  Bench& Start() {
    in.mode = ModeSelector::kT1;
    in.enabling = EnablingSwitch::kMiddle;
    Run(50);
    PressReset();
    RequestAnew();
    return *this;
  }

  PlcLogic plc;
  PlcLogicInputs in;
  rt::Nanoseconds now{0};
  bool controller_beats{true}, guard_beats{true};
};

constexpr std::uint16_t Bit(PlcBlock block) { return static_cast<std::uint16_t>(block); }

TEST(PlcLogic, StartsBlockedAndEachInputRemovesItsBlock) {
  Bench b;
  b.controller_beats = b.guard_beats = false;
  EXPECT_EQ(DescribeBlocks(b.Run(10).blocks),
            "no controller yet, no guard yet, no mode, not enabled, not requested, not reset");
  EXPECT_FALSE(b.plc.outputs().power_on);
  b.controller_beats = true;
  EXPECT_EQ(DescribeBlocks(b.Run(10).blocks), "no guard yet, no mode, not enabled, not requested, not reset");
  b.guard_beats = true;
  EXPECT_EQ(DescribeBlocks(b.Run(10).blocks), "no mode, not enabled, not requested, not reset");
  b.in.mode = ModeSelector::kT1;
  b.in.enabling = EnablingSwitch::kMiddle;
  EXPECT_EQ(DescribeBlocks(b.Run(10).blocks), "not requested, not reset");
  b.in.motion_request = true;  // too early: the request must be made while no fault is latched
  b.Run(10);
  b.PressReset();
  EXPECT_EQ(DescribeBlocks(b.plc.outputs().blocks), "not requested");
  EXPECT_FALSE(b.plc.outputs().power_on) << "never had power";
  b.RequestAnew();
  EXPECT_EQ(DescribeBlocks(b.plc.outputs().blocks), "none");
  EXPECT_TRUE(b.plc.outputs().run_permitted && b.plc.outputs().power_on);
}

// Tests each cause alone on a running cell: which blocks it sets, whether motion returns by itself, and what
// restores motion otherwise.
TEST(PlcLogic, EachCauseStopsMotionAndItsRowTellsHowMotionReturns) {
  using Change = std::function<void(Bench&)>;
  struct Row {
    const char* name;
    Change cause;
    int ms;  // time after which motion must be blocked [ms]
    std::uint16_t blocks;
    Change undo;
    bool returns_alone;         // motion returns as soon as the cause is gone
    bool returns_with_request;  // motion returns after a new request; false: a reset is needed first
  };
  const auto nothing = [](Bench&) {};
  const std::uint16_t asked = Bit(PlcBlock::kNotRequested);
  for (const Row& row : {
           Row{"emergency stop", [](Bench& b) { b.in.emergency_stop = true; }, 10,
               static_cast<std::uint16_t>(Bit(PlcBlock::kEmergencyStop) | asked),
               [](Bench& b) { b.in.emergency_stop = false; }, false, false},
           Row{"controller's heartbeat", [](Bench& b) { b.controller_beats = false; }, 260,
               static_cast<std::uint16_t>(Bit(PlcBlock::kControllerLost) | asked),
               [](Bench& b) { b.controller_beats = true; }, false, false},
           Row{"guard's request", [](Bench& b) { b.in.guard_permits = false; }, 10,
               static_cast<std::uint16_t>(Bit(PlcBlock::kGuardWithdrew) | asked),
               [](Bench& b) { b.in.guard_permits = true; }, false, false},
           Row{"guard's heartbeat", [](Bench& b) { b.guard_beats = false; }, 260,
               static_cast<std::uint16_t>(Bit(PlcBlock::kGuardLost) | asked),
               [](Bench& b) { b.guard_beats = true; }, false, false},
           Row{"mode none", [](Bench& b) { b.in.mode = ModeSelector::kNone; }, 10,
               static_cast<std::uint16_t>(Bit(PlcBlock::kNoMode) | asked),
               [](Bench& b) { b.in.mode = ModeSelector::kT1; }, false, true},
           Row{"another mode", [](Bench& b) { b.in.mode = ModeSelector::kAutomatic; }, 10, asked, nothing,
               false, true},
           Row{"enabling switch let go", [](Bench& b) { b.in.enabling = EnablingSwitch::kReleased; }, 10,
               Bit(PlcBlock::kNotEnabled), [](Bench& b) { b.in.enabling = EnablingSwitch::kMiddle; }, true,
               true},
           Row{"enabling switch squeezed", [](Bench& b) { b.in.enabling = EnablingSwitch::kSqueezed; }, 10,
               Bit(PlcBlock::kNotEnabled),
               [](Bench& b) {
                 b.in.enabling = EnablingSwitch::kMiddle;
                 b.Run(50);
                 EXPECT_FALSE(b.plc.outputs().run_permitted) << "from squeezed the middle does not count";
                 b.in.enabling = EnablingSwitch::kReleased;
                 b.Run(10);
                 b.in.enabling = EnablingSwitch::kMiddle;
               },
               true, true},
           Row{"request withdrawn", [](Bench& b) { b.in.motion_request = false; }, 10, asked, nothing, false,
               true},
       }) {
    SCOPED_TRACE(row.name);
    Bench b;
    b.Start();
    ASSERT_TRUE(b.plc.outputs().run_permitted) << DescribeBlocks(b.plc.outputs().blocks);
    row.cause(b);
    EXPECT_TRUE(b.Run(row.ms - 10).run_permitted) << "not before its time";
    b.Run(10);
    EXPECT_FALSE(b.plc.outputs().run_permitted);
    EXPECT_EQ(b.plc.outputs().blocks, row.blocks) << DescribeBlocks(b.plc.outputs().blocks);

    // power is switched off 500 ms after the permission ends, whatever the cause
    EXPECT_TRUE(b.Run(480).power_on);
    EXPECT_FALSE(b.Run(30).power_on);

    row.undo(b);
    EXPECT_EQ(b.Run(50).run_permitted, row.returns_alone);
    b.RequestAnew();
    EXPECT_EQ(b.plc.outputs().run_permitted, row.returns_with_request);
    b.PressReset();
    b.RequestAnew();
    EXPECT_TRUE(b.plc.outputs().run_permitted) << DescribeBlocks(b.plc.outputs().blocks);
    EXPECT_TRUE(b.plc.outputs().power_on);
  }
}

TEST(PlcLogic, ResetDoesNothingWhileTheCauseLasts) {
  Bench b;
  b.Start();
  b.in.emergency_stop = true;
  b.Run(10);
  b.PressReset();
  EXPECT_TRUE(b.plc.outputs().emergency_stop);
  b.in.emergency_stop = false;
  EXPECT_TRUE(b.Run(100).emergency_stop) << "pulled out alone is not enough";
  b.PressReset();
  EXPECT_FALSE(b.plc.outputs().emergency_stop);

  b.Start();
  b.controller_beats = false;
  b.Run(300);
  b.PressReset();
  EXPECT_EQ(b.plc.outputs().blocks & Bit(PlcBlock::kControllerLost), Bit(PlcBlock::kControllerLost));
}

TEST(PlcLogic, AHeldResetButtonResetsOnce) {
  Bench b;
  b.Start();
  b.in.reset = true;  // the button stays pressed from now on, as if it were taped down
  b.Run(50);
  b.in.emergency_stop = true;
  b.Run(10);
  b.in.emergency_stop = false;
  EXPECT_TRUE(b.Run(100).emergency_stop);
}

// Power is switched off 500 ms after the permission was last given. A pause of 300 ms ends in time, and a
// second pause starts the delay from the beginning.
TEST(PlcLogic, PowerStaysOnDuringAShortPause) {
  Bench b;
  b.Start();
  b.in.enabling = EnablingSwitch::kReleased;
  b.Run(300);
  b.in.enabling = EnablingSwitch::kMiddle;
  EXPECT_TRUE(b.Run(10).run_permitted);
  b.in.enabling = EnablingSwitch::kReleased;
  EXPECT_TRUE(b.Run(400).power_on) << "the delay counts from the last permission";
  EXPECT_FALSE(b.Run(110).power_on);
}

TEST(PlcLogic, SpindleNeedsThePedalAndThePermission) {
  Bench b;
  b.in.foot_pedal = true;
  EXPECT_FALSE(b.Run(10).spindle_permitted);
  b.Start();
  EXPECT_TRUE(b.plc.outputs().spindle_permitted);
  b.in.foot_pedal = false;
  EXPECT_FALSE(b.Run(10).spindle_permitted);
  EXPECT_TRUE(b.plc.outputs().run_permitted);
  b.in.foot_pedal = true;
  b.in.enabling = EnablingSwitch::kReleased;
  EXPECT_FALSE(b.Run(10).spindle_permitted);
}

TEST(PlcLogic, AConstantHeartbeatCountsAsNoController) {
  Bench b;
  b.controller_beats = false;
  b.in.controller_heartbeat = 7;
  EXPECT_TRUE(b.Run(1000).blocks & Bit(PlcBlock::kNoController));
}

TEST(PlcLogic, HeartbeatMayWrapAround) {
  Bench b;
  b.in.controller_heartbeat = 65'500;  // the counter passes 65535 and wraps around within the next 400 ms
  b.Start();
  EXPECT_TRUE(b.Run(1000).run_permitted);
}

// The clock jumps back by 1 s. This must neither switch the power off early nor lengthen the delay of 500 ms.
TEST(PlcLogic, AClockThatGoesBackDoesNotChangeThePowerDelay) {
  Bench b;
  b.Start();
  b.in.enabling = EnablingSwitch::kReleased;
  b.Run(400);
  b.now -= rt::kSecond;
  EXPECT_TRUE(b.Run(10).power_on);
  b.now += rt::kSecond;
  EXPECT_FALSE(b.Run(110).power_on);
}

TEST(PlcLogic, RefusesDurationsThatAreNotPositive) {
  EXPECT_THROW(PlcLogic({.heartbeat_timeout = 0}), std::invalid_argument);
  EXPECT_THROW(PlcLogic({.power_cut_delay = -1}), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::hil
