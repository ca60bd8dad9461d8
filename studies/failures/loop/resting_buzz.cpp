#include "studies/failures/loop/resting_buzz.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "hil/operator/hand_grid.h"
#include "studies/failures/arm_bench.h"
#include "studies/stability/force_band.h"

namespace osteon::studies {
namespace {

constexpr double kDt_s = 1e-3;
// Judged from kStart_s on; the push reaches its full force within kRamp_s.
constexpr double kStart_s = 1.0, kRamp_s = 0.5;
constexpr double kNoise_N = 0.1, kNoise_Nm = 0.005;  // standard deviation of the sensor's noise
constexpr double kLow_hz = 200.0, kHigh_hz = 300.0;  // band of the metric
// Stiffness of our plane, and of the baseline's. The loop is not stable with the second.
constexpr double kStable_N_per_m = 20e3, kAbove_N_per_m = 7.4e6;

// Motion of the handle in one run.
struct Buzz {
  double amplitude_m{0.0};  // amplitude of the motion in the metric's band
  double wide_rms_m{0.0};   // RMS value of the motion from 5 to 400 Hz
  double push_N{0.0};       // rendered force at the end
  bool fault{false};
  std::vector<Vector3> band;  // motion in the band of the metric [m], for each tick
};

// Simulates a tool that rests on the plane for kStart_s + seconds.
// @param force_alone  true (the baseline): the loop gets a force that is a millisecond old; false: it gets a
// plane
Buzz SimulateResting(double push_N, double stiffness_N_per_m, bool force_alone, double seconds) {
  ArmTrialParams params = ScenarioTrial();
  params.hand = hil::OperatorWith({"firm", 500.0, 20.0, 1.5});
  params.servo = {.bandwidth_hz = 1000.0, .dead_cycles = 0};  // without a lag, which would hide the vibration
  params.seconds = kStart_s + seconds;
  params.loop.coupling.max_stiffness_N_per_m = stiffness_N_per_m;
  // the depth reaction needs a depth in bone, which a bare force has not; so yield instead
  if (force_alone) params.loop.on_force_limit.reaction = safety::OnForceLimit::kYield;
  if (force_alone) {
    params.loop.stabilisers = control::NoStabilisers();
    params.loop.coupling.return_s = kDt_s;  // a new frame's planes replace the old ones at once
  }
  const Pose X_start = kinematics::LbrArm(params.arm).FlangePose(params.q_start) * params.X_FT;
  const Vector3 down = X_start.linear().col(2);

  // The spring's rest position is that at which the hand, with its own and the wall's deflection, pushes with
  // push_N.
  Pose X_goal = X_start;
  hil::HandImpedance hand(params.hand);
  double depth_before_m = 0.0;
  hil::SensorModel sensor({.noise_N = kNoise_N, .noise_Nm = kNoise_Nm, .seed = 6});
  const ArmScene scene{
      .hand =
          [&](int tick, const Pose& X_WT, const Twist& V_WT) {
            const double share = std::min(1.0, tick * kDt_s / kRamp_s);
            X_goal.translation() =
                X_start.translation() + share * push_N * (1.0 / 500.0 + 1.0 / stiffness_N_per_m) * down;
            return hand.Step(kDt_s, X_WT, V_WT, X_goal, {});
          },
      .bone =
          [&](int tick, rt::Nanoseconds now, const Pose& X_WT) {
            simulation::Contact plane = PlaneAt(X_start.translation(), -down, stiffness_N_per_m);
            const double depth_m = down.dot(X_WT.translation() - X_start.translation());
            // Stands for a force that was computed elsewhere a millisecond ago: the plane is moved with the
            // tool so that it gives this force at any position of the tool.
            if (force_alone) plane.p_W_m = Vector3(X_WT.translation() - std::max(0.0, depth_before_m) * down);
            depth_before_m = depth_m;
            return FreshModel(static_cast<std::uint64_t>(tick + 1), now, {&plane, 1});
          },
      .sensor = [&](int tick, const Pose&, const Wrench& F) { return ReadBy(sensor, tick, F); }};
  const std::vector<ArmTrialTick> trial = RunLoopTrial(params, scene);

  Buzz buzz;
  std::vector<Vector3> handle;
  for (const ArmTrialTick& tick : trial) {
    handle.push_back(tick.X_WT_meas.translation());
    buzz.fault |= tick.fault;
  }
  buzz.push_N = trial.back().f_coupling_N.norm();
  const auto from = static_cast<std::size_t>(kStart_s / kDt_s);
  buzz.band = BandPass(handle, kLow_hz, kHigh_hz, kDt_s);
  buzz.amplitude_m = std::numbers::sqrt2 * Rms(buzz.band, from, buzz.band.size());
  buzz.wide_rms_m = Rms(BandPass(handle, 5.0, 400.0, kDt_s), from, handle.size());
  return buzz;
}

// Returns the amplitude in the band [um] over each 20 ms, as a line of the picture.
FailureSeries Drawn(const char* name, const Buzz& buzz, bool ours) {
  constexpr std::size_t kEach = 20;  // ms: five cycles at 250 Hz
  FailureSeries series{.name = name, .ours = ours};
  for (std::size_t i = 0; i + kEach <= buzz.band.size(); i += kEach) {
    series.x.push_back(1e-3 * static_cast<double>(i));
    series.y.push_back(std::max(1e-6, 1e6 * std::numbers::sqrt2 * Rms(buzz.band, i, i + kEach)));
  }
  return series;
}

}  // namespace

FailureResult RunRestingBuzz(const FailureSetting& setting) {
  FailureResult result{
      .id = 6,
      .name = "resting buzz",
      .metric = "amplitude of the handle between 200 and 300 Hz, at rest",
      .unit = "um",
      .baseline_name = "force from a millisecond ago, 7.4 N/um: above what the loop is stable with",
      .bound = 1.0};
  const double seconds = setting.full() ? 10.0 : 2.0;
  double wide_rms_m = 0.0, baseline_wide_rms_m = 0.0, done = 0.0;
  bool complete = true, faulted = false, baselines_fail = true;
  result.baseline = 1e9;
  for (const double push_N : {5.0, 50.0, 200.0}) {
    // Stay below the limiter's 200 N: while the force is clipped the loop does not feel the stiffness and
    // does not ring.
    const double above_N = std::min(push_N, 195.0);
    const Buzz ours = SimulateResting(push_N, kStable_N_per_m, false, seconds);
    const Buzz above = SimulateResting(above_N, kAbove_N_per_m, true, seconds);
    result.ours = std::max(result.ours, 1e6 * ours.amplitude_m);
    result.baseline = std::min(result.baseline, 1e6 * above.amplitude_m);
    baselines_fail &= 1e6 * above.amplitude_m > result.bound;
    wide_rms_m = std::max(wide_rms_m, ours.wide_rms_m);
    baseline_wide_rms_m = std::max(baseline_wide_rms_m, above.wide_rms_m);
    faulted |= ours.fault;
    if (push_N == 50.0)
      result.plot = {.x_label = "time [s], 50 N",
                     .y_label = "amplitude between 200 and 300 Hz [um]",
                     .log_y = true,
                     .series = {Drawn("7.4 N/um, force alone", above, false), Drawn("ours", ours, true)},
                     .bound_is_on_y = true};
    done += 1.0 / 3.0;
    complete &= setting.GoesOn(done);
  }
  result.baseline_fails = baselines_fail;
  result.ours_passes = complete && !faulted && result.ours <= result.bound;
  result.note = fmt::format(
      "5, 50 and 200 N for {:.0f} s each, the baseline's least shown; above 5 Hz the handle moves by {:.2g} "
      "um rms with ours at most, by {:.3g} um with the baseline",
      seconds, 1e6 * wide_rms_m, 1e6 * baseline_wide_rms_m);
  return result;
}

}  // namespace osteon::studies
