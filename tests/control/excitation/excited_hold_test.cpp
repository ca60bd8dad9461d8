#include "control/excitation/excited_hold.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"

// An excited hold with an arm that follows one tick late: one joint moves the tool along z, 1 m for 1 rad.

namespace osteon::control {
namespace {

ExcitedHoldParams Params() {
  ExcitedHoldParams params{.path = {.draws = 1, .periods = 1, .peak_speed_m_per_s = 0.05}, .wait_s = 0.1};
  params.direction[0] = 1.0;
  params.J_W(2, 0) = 1.0;
  return params;
}

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

  // One tick. @param change  what differs in it
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
  // What a change of the ticks leads to. @returns ticks until the path stood
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
  double greatest_m = 0.0;
  for (int k = 0; k < 10000 && !rig.hold_.done(); ++k)
    greatest_m = std::max(greatest_m, std::abs(rig.Tick().x_m));
  EXPECT_TRUE(rig.hold_.done());
  EXPECT_GT(greatest_m, 1e-3);
  EXPECT_EQ(rig.step_.path.part, ExcitationPart::kDone);
  EXPECT_EQ(rig.step_.offset, JointArray{});
  EXPECT_EQ(rig.step_.abort, ExcitationAbort::kNone);
}

TEST(ExcitedHold, MeasuresTheOffsetAlongTheAxis) {
  HoldRig rig;
  rig.TicksUntilMoving();
  const double before_m = rig.step_.x_m;
  EXPECT_NEAR(rig.Tick().y_m, before_m, 1e-15);
}

ExcitedHoldParams JointParams() {
  ExcitedHoldParams params{
      .path = {.draws = 1, .periods = 1, .peak_speed_m_per_s = 0.15, .max_travel_m = 0.017},
      .joint = 2,
      .wait_s = 0.1};
  params.direction[2] = 1.0;
  params.J_W(0, 2) = 0.1;  // it moves the tool along x, not along the axis
  return params;
}

TEST(ExcitedHold, MovesAndMeasuresOneJointAlone) {
  ExcitedHold hold(JointParams());
  ExcitedTick tick{.received = true,
                   .activation = 1,
                   .active = true,
                   .permitted = true,
                   .state = safety::CellState::kPaused};
  double before_rad = 0.0, greatest_rad = 0.0;
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
    greatest_rad = std::max(greatest_rad, std::abs(step.x_m));
  }
  EXPECT_GT(greatest_rad, 1e-3);
  EXPECT_LE(greatest_rad, 0.017);
  // a tool on the joint's axis shows nothing of its error
  tick.q_meas[2] += 0.021;
  ++tick.sequence;
  EXPECT_EQ(hold.Step(tick).abort, ExcitationAbort::kTracking);
}

TEST(ExcitedHold, RefusesAJointThatThereIsNot) {
  ExcitedHoldParams params = JointParams();
  params.joint = 7;
  EXPECT_THROW(ExcitedHold{params}, std::invalid_argument);
  params.joint = 2;
  params.overlay.on = true;
  EXPECT_THROW(ExcitedHold{params}, std::invalid_argument);
}

TEST(ExcitedHold, AdvancesOverMessagesThatWereLost) {
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
  for (const AbortCase& one : cases) {
    HoldRig rig;
    rig.TicksUntilMoving();
    double last_m = rig.step_.x_m;
    EXPECT_LE(rig.TicksToRest([&](ExcitedTick& tick) {
      one.change(tick);
      EXPECT_LT(std::abs(rig.step_.x_m - last_m), 0.06e-3) << "a jump of the command";
      last_m = rig.step_.x_m;
    }),
              501)
        << Describe(one.abort);
    EXPECT_EQ(rig.step_.abort, one.abort) << Describe(rig.step_.abort);
    const double resting_m = rig.step_.x_m;
    EXPECT_EQ(rig.Tick().x_m, resting_m);
  }
}

TEST(ExcitedHold, AFewLostAnswersAreNoReason) {
  HoldRig rig;
  rig.TicksUntilMoving();
  for (std::uint32_t k = 0; k < 3000; ++k)
    rig.Tick([&](ExcitedTick& tick) { tick.answers_lost = k / 100; });  // 1 %
  EXPECT_EQ(rig.step_.abort, ExcitationAbort::kNone);
}

TEST(ExcitedHold, ForceThatGrowsAborts) {
  HoldRig rig;
  rig.TicksUntilMoving();
  const auto run = [&](double growth_per_s) {
    for (int k = 0; k < 800 && rig.step_.abort == ExcitationAbort::kNone; ++k)
      rig.Tick([&](ExcitedTick& tick) {
        tick.force_S_N.x() = 4.0 * std::exp(growth_per_s * 1e-3 * k) * std::sin(2.0 * 3.14159265 * 15e-3 * k);
      });
    return rig.step_.abort;
  };
  EXPECT_EQ(run(0.0), ExcitationAbort::kNone) << "an even vibration";
  EXPECT_EQ(run(5.0), ExcitationAbort::kForceGrows);
}

TEST(ExcitedHold, AnArmThatLeavesGetsNoOffset) {
  HoldRig rig;
  rig.TicksUntilMoving();
  rig.Tick([](ExcitedTick& tick) { tick.active = false; });
  EXPECT_EQ(rig.step_.abort, ExcitationAbort::kArmLeft);
  EXPECT_EQ(rig.step_.offset, JointArray{});
  EXPECT_TRUE(rig.hold_.done());
}

TEST(ExcitedHold, RefusesWhatIsOutOfRange) {
  ExcitedHoldParams params = Params();
  params.max_force_N = 0.0;
  EXPECT_THROW(ExcitedHold{params}, std::invalid_argument);
  params = Params();
  params.axis_W = {0.0, 0.0, 2.0};
  EXPECT_THROW(ExcitedHold{params}, std::invalid_argument);
}

}  // namespace
}  // namespace osteon::control
