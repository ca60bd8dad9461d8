#include "studies/failures/loop/sensor_errors.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "hil/operator/quintic.h"
#include "studies/failures/arm_bench.h"

namespace osteon::studies {
namespace {

// Times of a run: the arm waits for kWaiting_s. The hand turns the tool by kTurn_rad within kTurns_s and lets
// go at kReleases_s. The drift is judged from kSettles_s after the release on. At the end a hand pushes with
// kPush_N for kPushes_s.
constexpr double kDt_s = 1e-3, kWaiting_s = 1.0, kTurns_s = 1.5, kReleases_s = 2.0, kSettles_s = 1.0;
constexpr double kTurn_rad = std::numbers::pi / 6.0, kPush_N = 10.0, kPushes_s = 1.0;
constexpr double kLever_m = 0.1;  // distance of a second judged point of the tool from the tool's origin
// Mass that the cell's file lacks; drift of the sensor's zero.
constexpr double kPayload_kg = 0.2, kDrift_N_per_s = 0.1;
constexpr double kDeadZone_N = 5.0, kDeadZone_Nm = 1.0;  // dead zone of our law

// Motion of the released tool.
struct DriftResult {
  double speed_m_per_s{0.0};  // largest speed of the released tool
  double way_m{0.0};          // travel of the tool's origin until the push
  double push_m_per_s{0.0};   // speed under the push at the end
  bool fault{false};
  std::vector<double> way_mm;  // travel of the tool's origin, by time since the release
};

// @param bias_N  error of the sensor's zero along an axis of the flange; its torque is 0.05 N·m per N
// @param ours    with bias estimate and dead zone; false: the baseline
// @param seconds  from the release to the push
DriftResult Release(double bias_N, int axis, bool ours, double seconds) {
  ArmTrialParams params = ScenarioTrial();
  params.waiting_s = kWaiting_s;
  params.seconds = kReleases_s + seconds + kPushes_s;
  params.loop.sensor_bias.acts = ours;
  // Widen the bounds of the bias estimate: nobody holds the tool while the arm waits, so the estimate may
  // also take up the payload's error.
  params.loop.sensor_bias.max_creep_m_per_s = 0.3;
  params.loop.sensor_bias.max_creep_rad_per_s = 1.0;
  if (ours) {
    params.loop.admittance.dead_zone_N = kDeadZone_N;
    params.loop.admittance.dead_zone_Nm = kDeadZone_Nm;
  }
  const Pose X_start = kinematics::LbrArm(params.arm).FlangePose(params.q_start) * params.X_FT;

  // errors of the sensor's zero, and a payload that the cell's file lacks
  hil::SensorModelParams errors{.noise_N = 0.1, .noise_Nm = 0.005, .seed = 15};
  const Vector3 direction = Vector3::Unit(axis), across = Vector3::Unit((axis + 1) % 3);
  errors.bias.f = bias_N * direction;
  errors.bias.t = 0.05 * bias_N * across;  // [N·m]: a lever of 50 mm
  errors.drift_N_per_s = Vector3(kDrift_N_per_s * direction);
  errors.drift_Nm_per_s = Vector3(0.05 * kDrift_N_per_s * across);
  hil::SensorModel sensor(errors);
  const control::ForceSensorParams extra{
      .X_FS = {}, .tool_mass_kg = kPayload_kg, .tool_center_F_m = Vector3(0.0, 0.0, 0.05)};

  const double pushes_s = kReleases_s + seconds;
  hil::HandImpedance hand(params.hand);
  const ArmScene scene{.hand = [&](int tick, const Pose& X_WT, const Twist& V_WT) -> Wrench {
                         const double t = tick * kDt_s;
                         if (t >= pushes_s)
                           return {.f = kPush_N * X_start.linear().col(0), .t = Vector3::Zero()};
                         if (t < 0.0 || t >= kReleases_s) return {};
                         Pose X_goal = X_start;
                         const double turned = hil::Quintic(std::min(1.0, t / kTurns_s)).s * kTurn_rad;
                         X_goal.linear() = ExpRotation(turned * X_start.linear().col(0)) * X_start.linear();
                         return hand.Step(kDt_s, X_WT, V_WT, X_goal, {});
                       },
                       .sensor =
                           [&](int tick, const Pose& X_WF, const Wrench& F) {
                             const Wrench weight = control::ToolWeight(extra, X_WF);
                             return ReadBy(sensor, tick, {.f = F.f + weight.f, .t = F.t + weight.t});
                           }};
  const std::vector<ArmTrialTick> trial = RunLoopTrial(params, scene);

  DriftResult result;
  const auto second = static_cast<std::size_t>(1.0 / kDt_s);
  const auto from = static_cast<std::size_t>((kReleases_s + kSettles_s) / kDt_s);
  const auto to = static_cast<std::size_t>(pushes_s / kDt_s);
  const auto second_point = [&trial](std::size_t i) { return trial[i].X_WT * Vector3(0.0, 0.0, -kLever_m); };
  for (std::size_t i = from; i + second < to; i += 10) {
    const Vector3 way = trial[i + second].X_WT.translation() - trial[i].X_WT.translation();
    result.speed_m_per_s =
        std::max({result.speed_m_per_s, way.norm(), (second_point(i + second) - second_point(i)).norm()});
  }
  for (std::size_t i = from; i < to; i += 20)
    result.way_mm.push_back(1e3 * (trial[i].X_WT.translation() - trial[from].X_WT.translation()).norm());
  result.way_m = 1e-3 * result.way_mm.back();
  result.push_m_per_s = (trial.back().X_WT.translation() - trial[to].X_WT.translation()).norm() / kPushes_s;
  for (const ArmTrialTick& tick : trial) result.fault |= tick.fault;
  return result;
}

// Returns the released tool's distance from its position a second after the release, as a line of the
// picture.
FailureSeries Drawn(const char* name, const DriftResult& drifted, bool ours) {
  FailureSeries series{.name = name, .y = drifted.way_mm, .ours = ours};
  for (std::size_t i = 0; i < series.y.size(); ++i) series.x.push_back(0.02 * static_cast<double>(i));
  return series;
}

}  // namespace

FailureResult RunSensorErrors(const FailureSetting& setting) {
  FailureResult result{.id = 15,
                       .name = "sensor",
                       .metric = "speed of a tool that nobody holds",
                       .unit = "mm/s",
                       .baseline_name = "no dead zone, bias not taken",
                       .bound = 1.0};
  const std::vector<double> biases_N =
      setting.full() ? std::vector{0.5, 1.0, 2.0, 5.0} : std::vector{0.5, 5.0};
  const int axes = setting.full() ? 3 : 1;
  // with the waiting and the turning, during which the zero drifts as well, this makes 30 s of drift
  const double seconds = setting.full() ? 27.0 : 4.0;
  result.baseline = 1e9;
  int done = 0;
  bool complete = true, faulted = false, baselines_fail = true;
  double push_m_per_s = 1e9, way_m = 0.0;
  for (const double bias_N : biases_N) {
    for (int axis = 0; axis < axes && complete; ++axis) {
      const DriftResult ours = Release(bias_N, axis, true, seconds);
      // without bias estimate the tool soon leaves the arm's reach, so this run is short
      const DriftResult bare = Release(bias_N, axis, false, 2.5);
      result.ours = std::max(result.ours, 1e3 * ours.speed_m_per_s);
      result.baseline = std::min(result.baseline, 1e3 * bare.speed_m_per_s);
      baselines_fail &= 1e3 * bare.speed_m_per_s > result.bound;
      push_m_per_s = std::min(push_m_per_s, ours.push_m_per_s);
      way_m = std::max(way_m, ours.way_m);
      faulted |= ours.fault;
      if (axis == 0 && bias_N == biases_N.back())
        result.plot = {
            .x_label = fmt::format("time [s], from a second after the release on; bias {:g} N", bias_N),
            .y_label = "way of the tool that nobody holds [mm]",
            .series = {Drawn("no dead zone", bare, false), Drawn("ours", ours, true)}};
      complete =
          setting.GoesOn(++done / static_cast<double>(biases_N.size() * static_cast<std::size_t>(axes)));
    }
  }
  result.baseline_fails = baselines_fail;
  result.ours_passes = complete && !faulted && result.ours <= result.bound && push_m_per_s > 1e-3;
  result.note = fmt::format(
      "{} biases with drift and {:g} kg too little in the cell, the baseline's least shown; over {:.0f} s "
      "ours goes {:.2g} mm, and then moves at {:.0f} mm/s or more under a push of {:g} N: the dead zone of "
      "{:g} N costs that much force, and nothing eats the push",
      done, kPayload_kg, seconds, 1e3 * way_m, 1e3 * push_m_per_s, kPush_N, kDeadZone_N);
  return result;
}

}  // namespace osteon::studies
