#include "control/excitation/excited_hold.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"

// Tests the excited hold, which moves a paused arm along the excitation's path and aborts if a fault occurs.
// The simulated arm follows its command one tick later. Its joint 0 moves the tool along z by 1 m per rad.

namespace osteon::control {
namespace {

// Parameters with one draw and one period of the excitation, after a rest of 0.1 s.
ExcitedHoldParams Params() {
  ExcitedHoldParams params{.path = {.draws = 1, .periods = 1, .peak_speed_m_per_s = 0.05}, .wait_s = 0.1};
  params.direction[0] = 1.0;
  params.J_W(2, 0) = 1.0;
  return params;
}

// An excited hold with its simulated arm, in a pause.
class HoldRig {
 public:
  explicit HoldRig(const ExcitedHoldParams& params = Params()) : hold_(params) {
    tick_ = {.received = true,
             .activation = 1,
             .active = true,
             .permitted = true,
             .state = safety::CellState::kPaused};
    tick_.q_hold[1] = tick_.q_meas[1] = 0.7;
  }

  // Runs one tick. @param change  modifies the tick's inputs
  ExcitedHoldStep Tick(const std::function<void(ExcitedTick&)>& change = {}) {
    ++tick_.sequence;
    ExcitedTick tick = tick_;
    if (change) change(tick);
    {
      rt::CheckedNoAllocScope no_alloc;
      step_ = hold_.Step(tick);
    }
    tick_.q_meas[0] = tick_.q_hold[0] + step_.offset[0];
    return step_;
  }
  ExcitedHoldStep TicksUntilMoving() {
    for (int k = 0; k < 2000; ++k) Tick();
    EXPECT_TRUE(step_.excites);
    EXPECT_NE(step_.x_m, 0.0);
    return step_;
  }
  // Runs ticks with modified inputs until the hold is done; after an abort, that is when the arm is at rest.
  // @returns the number of ticks
  int TicksToRest(const std::function<void(ExcitedTick&)>& change) {
    int ticks = 0;
    while (!hold_.done() && ticks < 2000) {
      Tick(change);
      ++ticks;
    }
    return ticks;
  }

  ExcitedHold hold_;
  ExcitedTick tick_;
  ExcitedHoldStep step_;
};

TEST(ExcitedHold, WaitsForThePauseThenMovesAndEndsWhereItBegan) {
  HoldRig rig;
  rig.tick_.state = safety::CellState::kHaptic;
  for (int k = 0; k < 500; ++k) EXPECT_EQ(rig.Tick().x_m, 0.0);
  rig.tick_.state = safety::CellState::kPaused;
  for (int k = 0; k < 100; ++k) EXPECT_EQ(rig.Tick().x_m, 0.0);
  double max_m = 0.0;
  for (int k = 0; k < 10000 && !rig.hold_.done(); ++k) max_m = std::max(max_m, std::abs(rig.Tick().x_m));
  EXPECT_TRUE(rig.hold_.done());
  EXPECT_GT(max_m, 1e-3);
  EXPECT_EQ(rig.step_.path.part, ExcitationPart::kDone);
  EXPECT_EQ(rig.step_.offset, JointArray{});
  EXPECT_EQ(rig.step_.abort, ExcitationAbort::kNone);
}

// The arm follows one tick late, so the measured offset y equals the commanded offset x of the tick before.
TEST(ExcitedHold, MeasuresTheOffsetAlongTheAxis) {
  HoldRig rig;
  rig.TicksUntilMoving();
  const double before_m = rig.step_.x_m;
  EXPECT_NEAR(rig.Tick().y_m, before_m, 1e-15);
}

// Parameters that excite joint 2 alone, with offsets in rad.
ExcitedHoldParams JointParams() {
  ExcitedHoldParams params{
      .path = {.draws = 1, .periods = 1, .peak_speed_m_per_s = 0.15, .max_travel_m = 0.017},
      .joint = 2,
      .wait_s = 0.1};
  params.direction[2] = 1.0;
  params.J_W(0, 2) = 0.1;  // the joint moves the tool along x, not along the measured axis z
  return params;
}

TEST(ExcitedHold, MovesAndMeasuresOneJointAlone) {
  ExcitedHold hold(JointParams());
  ExcitedTick tick{.received = true,
                   .activation = 1,
                   .active = true,
                   .permitted = true,
                   .state = safety::CellState::kPaused};
  double before_rad = 0.0, max_rad = 0.0;
  for (int k = 0; k < 3000; ++k) {
    ++tick.sequence;
    ExcitedHoldStep step;
    {
      rt::CheckedNoAllocScope no_alloc;
      step = hold.Step(tick);
    }
    EXPECT_EQ(step.y_m, before_rad);
    for (std::size_t j = 0; j < step.offset.size(); ++j) EXPECT_EQ(step.offset[j], j == 2 ? step.x_m : 0.0);
    tick.q_meas = step.offset;
    before_rad = step.x_m;
    max_rad = std::max(max_rad, std::abs(step.x_m));
  }
  EXPECT_GT(max_rad, 1e-3);
  EXPECT_LE(max_rad, 0.017);
  // an error of the joint that does not change the tool's position along z
  tick.q_meas[2] += 0.021;
  ++tick.sequence;
  EXPECT_EQ(hold.Step(tick).abort, ExcitationAbort::kTracking);
}

TEST(ExcitedHold, RefusesANonexistentJointOrAJointWithAForceOverlay) {
  ExcitedHoldParams params = JointParams();
  params.joint = 7;
  EXPECT_THROW(ExcitedHold{params}, std::invalid_argument);
  params.joint = 2;
  params.overlay.on = true;
  EXPECT_THROW(ExcitedHold{params}, std::invalid_argument);
}

TEST(ExcitedHold, AdvancesByTheLostMessages) {
  HoldRig rig, gap;
  rig.TicksUntilMoving();
  gap.TicksUntilMoving();
  for (int k = 0; k < 4; ++k) rig.Tick();
  gap.tick_.sequence += 3;
  EXPECT_EQ(gap.Tick().x_m, rig.step_.x_m);
}

TEST(ExcitedHold, PausesWhileTheSwitchIsReleased) {
  ExcitedHoldParams params = Params();
  params.has_interlock = true;
  HoldRig rig(params);
  rig.TicksUntilMoving();
  const auto released = [](ExcitedTick& tick) { tick.permitted = false; };
  for (int k = 0; k < 501; ++k) rig.Tick(released);
  EXPECT_TRUE(rig.step_.path.at_rest);
  EXPECT_FALSE(rig.hold_.done());
  EXPECT_EQ(rig.step_.abort, ExcitationAbort::kNone);
}

// A change of the inputs, and the abort that it must cause.
struct AbortCase {
  ExcitationAbort abort;
  std::function<void(ExcitedTick&)> change;
};

TEST(ExcitedHold, EachAbortBrakesToRestWithinHalfASecond) {
  const AbortCase cases[] = {
      {ExcitationAbort::kLeftPause, [](ExcitedTick& tick) { tick.state = safety::CellState::kFault; }},
      {ExcitationAbort::kForce, [](ExcitedTick& tick) { tick.force_S_N.x() = 30.1; }},
      {ExcitationAbort::kTracking, [](ExcitedTick& tick) { tick.q_meas[0] += 0.0101; }},
      {ExcitationAbort::kAnswersLost, [](ExcitedTick& tick) { tick.answers_lost = 51; }},
      {ExcitationAbort::kSensor, [](ExcitedTick& tick) { tick.sensor_trusted = false; }},
      {ExcitationAbort::kSensor, [](ExcitedTick& tick) { tick.sensor_age_s = 0.2; }}};
  for (const AbortCase& abort_case : cases) {
    HoldRig rig;
    rig.TicksUntilMoving();
    double last_m = rig.step_.x_m;
    EXPECT_LE(rig.TicksToRest([&](ExcitedTick& tick) {
      abort_case.change(tick);
      EXPECT_LT(std::abs(rig.step_.x_m - last_m), 0.06e-3) << "a jump of the command";
      last_m = rig.step_.x_m;
    }),
              501)
        << Describe(abort_case.abort);
    EXPECT_EQ(rig.step_.abort, abort_case.abort) << Describe(rig.step_.abort);
    const double resting_m = rig.step_.x_m;
    EXPECT_EQ(rig.Tick().x_m, resting_m);
  }
}

TEST(ExcitedHold, AFewLostAnswersDoNotAbort) {
  HoldRig rig;
  rig.TicksUntilMoving();
  for (std::uint32_t k = 0; k < 3000; ++k)
    rig.Tick([&](ExcitedTick& tick) { tick.answers_lost = k / 100; });  // 1 % of the answers are lost
  EXPECT_EQ(rig.step_.abort, ExcitationAbort::kNone);
}

TEST(ExcitedHold, AGrowingVibrationAborts) {
  HoldRig rig;
  rig.TicksUntilMoving();
  // a force at 15 Hz whose amplitude grows exponentially
  const auto abort_of = [&](double growth_per_s) {
    for (int k = 0; k < 800 && rig.step_.abort == ExcitationAbort::kNone; ++k)
      rig.Tick([&](ExcitedTick& tick) {
        tick.force_S_N.x() = 4.0 * std::exp(growth_per_s * 1e-3 * k) * std::sin(2.0 * 3.14159265 * 15e-3 * k);
      });
    return rig.step_.abort;
  };
  EXPECT_EQ(abort_of(0.0), ExcitationAbort::kNone) << "an even vibration";
  EXPECT_EQ(abort_of(5.0), ExcitationAbort::kForceGrows);
}

TEST(ExcitedHold, AnArmThatLeavesCommandingGetsNoOffset) {
  HoldRig rig;
  rig.TicksUntilMoving();
  rig.Tick([](ExcitedTick& tick) { tick.active = false; });
  EXPECT_EQ(rig.step_.abort, ExcitationAbort::kArmLeft);
  EXPECT_EQ(rig.step_.offset, JointArray{});
  EXPECT_TRUE(rig.hold_.done());
}

TEST(ExcitedHold, RefusesParametersOutOfRange) {
  ExcitedHoldParams params = Params();
  params.max_force_N = 0.0;
  EXPECT_THROW(ExcitedHold{params}, std::invalid_argument);
  params = Params();
  params.axis_W = {0.0, 0.0, 2.0};
  EXPECT_THROW(ExcitedHold{params}, std::invalid_argument);
}

}  // namespace
}  // namespace osteon::control
