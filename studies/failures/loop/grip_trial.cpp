#include "studies/failures/loop/grip_trial.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "hil/operator/tremor.h"
#include "studies/failures/arm_bench.h"
#include "studies/stability/force_band.h"

namespace osteon::studies {
namespace {

// kCalm_s: time after the step from which on calm_N is measured.
constexpr double kDt_s = 1e-3, kCalm_s = 0.5;
constexpr double kLow_hz = 5.0, kHigh_hz = 40.0;     // band in which the force is measured
constexpr double kNoise_N = 0.1, kNoise_Nm = 0.005;  // standard deviation of the sensor's noise
// Travel and frequency of the hand's free motion before the step.
constexpr double kSwing_m = 0.03, kSwing_hz = 0.5;

}  // namespace

GripTrial RunGripTrial(const GripTrialParams& params) {
  ArmTrialParams arm = ScenarioTrial();
  arm.seconds = params.step_s + params.seconds;
  arm.loop = params.loop;
  const Pose X_start = kinematics::LbrArm(arm.arm).FlangePose(arm.q_start) * arm.X_FT;
  const Vector3 along = (X_start.linear() * Vector3(0.6, 0.0, 0.8)).normalized();

  const hil::OperatorHandParams loose = hil::OperatorWith({"loose", 300.0, 13.0, 1.1}),
                                tight = hil::OperatorWith(params.after);
  hil::HandImpedance loose_mass(loose), tight_mass(tight);
  bool stepped = false;
  Pose X_held = X_start;  // the pose at which the tight hand holds the tool
  // constant wrench that is added to the tight hand's, so that the sum does not jump at the step
  Wrench kept;
  hil::SensorModel sensor({.noise_N = kNoise_N, .noise_Nm = kNoise_Nm, .seed = 16});
  const hil::Tremor tremor(params.tremor_N, 1);
  std::vector<Vector3> hand_forces, tremor_forces;
  const ArmScene scene{
      .hand =
          [&](int tick, const Pose& X_WT, const Twist& V_WT) {
            const double t = tick * kDt_s, swing_rad_per_s = 2.0 * std::numbers::pi * kSwing_hz;
            Pose X_goal = X_start;
            X_goal.translation() += 0.5 * kSwing_m * (1.0 - std::cos(swing_rad_per_s * t)) * along;
            const Twist V_goal{.v = 0.5 * kSwing_m * swing_rad_per_s * std::sin(swing_rad_per_s * t) * along,
                               .w = Vector3::Zero()};
            Wrench F;
            if (t < params.step_s) {
              F = loose_mass.Step(kDt_s, X_WT, V_WT, X_goal, V_goal);
            } else {
              // at the step: keep the hand's wrench; a clamp has no muscles that could keep it
              if (!stepped) {
                stepped = true;
                X_held = X_WT;
                const Wrench before = loose.spring().Pull(X_WT, V_WT, X_goal, V_goal);
                const Wrench now = tight.spring().Pull(X_WT, V_WT, X_held, {});
                if (!params.clamp) kept = {.f = before.f - now.f, .t = before.t - now.t};
              }
              F = tight_mass.Step(kDt_s, X_WT, V_WT, X_held, {});
              F = {.f = F.f + kept.f, .t = F.t + kept.t};
            }
            tremor_forces.push_back(t < params.tremor_from_s ? Vector3(Vector3::Zero()) : tremor.ForceAt(t));
            F.f += tremor_forces.back();
            hand_forces.push_back(F.f);
            return F;
          },
      .sensor = [&](int tick, const Pose&, const Wrench& F) { return ReadBy(sensor, tick, F); }};

  GripTrial result;
  for (const ArmTrialTick& tick : RunLoopTrial(arm, scene)) {
    result.fault |= tick.fault;
    result.index = std::max(result.index, tick.vibration_index);
    result.indices.push_back(tick.vibration_index);
    result.references_N.push_back(tick.vibration_reference_N);
    result.damping_factors.push_back(tick.damping_factor);
    if (tick.damping_factor > 2.0) result.heavy_s += kDt_s;
  }
  const auto window = static_cast<std::size_t>(GripTrial::kWindow_s / kDt_s),
             every = static_cast<std::size_t>(GripTrial::kEvery_s / kDt_s);
  for (std::size_t i = 0; i + window <= hand_forces.size(); i += every) {
    const double effective_N = RmsInBand(hand_forces, i, window, kLow_hz, kHigh_hz, kDt_s);
    result.window_N.push_back(effective_N);
    result.max_N = std::max(result.max_N, effective_N);
    result.tremor_N =
        std::max(result.tremor_N, RmsInBand(tremor_forces, i, window, kLow_hz, kHigh_hz, kDt_s));
    if (static_cast<double>(i) * kDt_s >= params.step_s + kCalm_s - 1e-9)
      result.calm_N = std::max(result.calm_N, effective_N);
  }
  return result;
}

}  // namespace osteon::studies
