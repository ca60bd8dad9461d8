#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <gtest/gtest.h>

#include "hil/operator/hand_grid.h"
#include "hil/operator/tremor.h"
#include "studies/failures/arm_bench.h"

// The vibration index on bone that swings on its mount: the swing must not count as an oscillation of the
// loop.

namespace osteon::studies {
namespace {

constexpr double kDt_s = 1e-3, kSeconds = 5.0, kFrom_s = 1.0, kTwoPi = 2.0 * std::numbers::pi;
constexpr double kStiffness_N_per_m = 20e3;

struct Press {
  double mean_drag{0.0};  // factor on the law's drag
  double swing_m{0.0};    // from the lowest to the highest place of the tool
  bool fault{false};
};

// A hand presses with up to 100 N and lets go, 0.7 times a second, with a tremor. @param mount_hz  of bone of
// 12 kg; absent: it rests
Press PressAndLetGo(const hil::GridHand& held, double tremor_N, std::optional<double> mount_hz) {
  ArmRideParams params;
  params.arm = ScenarioArm();
  params.X_FT = ScenarioTool();
  params.q_start << 0.2, 0.5, 0.1, -1.4, 0.15, 0.8, 0.3;
  params.hand = hil::OperatorWith(held);
  params.seconds = kSeconds;
  const Pose X_start = kinematics::LbrArm(params.arm).FlangePose(params.q_start) * params.X_FT;
  const Vector3 down = X_start.linear().col(2);
  if (mount_hz) {
    control::BoneMountParams mount;
    mount.p_WMo_m = X_start.translation();
    mount.stiffness_N_per_m.setConstant(mount.mass_kg * std::pow(kTwoPi * *mount_hz, 2));
    mount.max_shift_m = 0.05;
    params.loop.compliance.mount = mount;
  }
  hil::HandImpedance hand(params.hand);
  hil::SensorModel sensor({.noise_N = 0.1, .noise_Nm = 0.005, .seed = 42});
  const hil::Tremor tremor(tremor_N, 1);
  const ArmScene scene{
      .hand =
          [&](int tick, const Pose& X_WT, const Twist& V_WT) {
            const double t = tick * kDt_s, push_N = 40.0 - 60.0 * std::cos(kTwoPi * 0.7 * t);
            Pose X_goal = X_start;
            X_goal.translation() += push_N * (1.0 / held.stiffness_N_per_m + 1.0 / kStiffness_N_per_m) * down;
            Wrench F = hand.Step(kDt_s, X_WT, V_WT, X_goal, {});
            F.f += tremor.ForceAt(t);
            return F;
          },
      .bone =
          [&](int tick, rt::Nanoseconds now, const Pose&) {
            const simulation::Contact plane = PlaneAt(X_start.translation(), -down, kStiffness_N_per_m);
            return FreshModel(static_cast<std::uint64_t>(tick + 1), now, {&plane, 1});
          },
      .sensor = [&](int tick, const Pose&, const Wrench& F) { return ReadBy(sensor, tick, F); }};
  Press press;
  double low_m = 1.0, high_m = -1.0, count = 0.0;
  for (const ArmRideTick& tick : RideServoLoop(params, scene)) {
    press.fault |= tick.fault;
    if ((count += 1.0) * kDt_s < kFrom_s) continue;
    press.mean_drag += tick.damping_factor * kDt_s / (kSeconds - kFrom_s);
    const double at_m = down.dot(tick.X_WT_meas.translation() - X_start.translation());
    low_m = std::min(low_m, at_m);
    high_m = std::max(high_m, at_m);
  }
  press.swing_m = high_m - low_m;
  return press;
}

TEST(SwingingMount, TheVibrationIndexAddsNoMoreDragThanOnBoneAtRest) {
  double most_at_rest = 0.0;
  for (const hil::GridHand& hand : hil::NamedHands()) {
    if (hand.mass_kg == 0.0) continue;  // fixture and clamp let nothing go
    for (const double tremor_N : {0.5, 1.0}) {
      const Press rest = PressAndLetGo(hand, tremor_N, {});
      EXPECT_FALSE(rest.fault) << hand.name;
      most_at_rest = std::max(most_at_rest, rest.mean_drag);
      for (const double hz : {4.0, 6.0, 8.0, 10.0, 12.0, 15.0, 20.0}) {
        const Press press = PressAndLetGo(hand, tremor_N, hz);
        EXPECT_FALSE(press.fault) << hand.name << " " << hz << " Hz";
        EXPECT_LE(press.mean_drag, 1.15 * rest.mean_drag)
            << hand.name << ", tremor " << tremor_N << " N, mount of " << hz << " Hz";
        EXPECT_GT(press.swing_m, rest.swing_m) << hand.name << " " << hz << " Hz: the bone gives way";
      }
    }
  }
  EXPECT_GT(most_at_rest, 1.5) << "the index acts in this scene at all";
}

}  // namespace
}  // namespace osteon::studies
