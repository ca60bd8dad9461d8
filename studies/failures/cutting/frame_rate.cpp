#include "studies/failures/cutting/frame_rate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "control/coupling/virtual_coupling.h"
#include "studies/failures/scenario_bench.h"

namespace osteon::studies {
namespace {

constexpr std::array kRates_hz{250.0, 500.0, 1000.0, 2000.0};
constexpr std::size_t kNominal = 2;  // index of the rate 1 kHz
constexpr double kServo_hz = 4000.0;
constexpr int kPlotEvery = 8;                    // ticks from one drawn point to the next
constexpr double kRun_s = 1.0, kPlunge_s = 0.4;  // after the plunge the hand moves sideways

/// Smooth step from 0 to 1.
double Blend(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return s * s * (3.0 - 2.0 * s);
}

/// Apex of the hand's tool: down by 1.1 mm within kPlunge_s, then along x by 3 mm.
Vector3 HandAt(double t_s) {
  return {3e-3 * Blend((t_s - kPlunge_s) / 0.5), 0.0, 0.1e-3 - 1.1e-3 * Blend(t_s / kPlunge_s)};
}

/// The outcome at one frame rate.
struct Run {
  std::array<double, 2> mean_force_N{};  ///< over the plunge, and over the traverse
  double removed_m3{0.0};
  FailureSeries force;
};

/// Simulates frames at `rate_hz`, each with the hand's pose at the frame's time. Between frames the servo
/// loop renders the newest frame's planes at kServo_hz, as on the arm (control::EvaluateCoupling, without
/// damping).
Run Play(simulation::CuttingEngine& engine, double rate_hz) {
  Run run;
  std::array<int, 2> ticks{};
  const int per_frame = static_cast<int>(std::lround(kServo_hz / rate_hz));
  constexpr control::CouplingParams coupling{.damping_Ns_per_m = 0.0};
  control::CouplingState state;
  simulation::ContactModel model;
  for (int i = 0; i <= static_cast<int>(kRun_s * kServo_hz); ++i) {
    const double t_s = i / kServo_hz;
    const auto now = static_cast<rt::Nanoseconds>(std::llround(1e9 * t_s));
    const Pose X_WT = Downwards(HandAt(t_s));
    if (i % per_frame == 0) {
      auto frame = FrameAt(X_WT, kScenarioSpindle_rad_per_s, 1.0 / rate_hz);
      frame.stamp = now;
      model = engine.Step(frame);
    }
    const auto output = control::EvaluateCoupling(
        coupling, {.model = model, .X_WT = X_WT, .now = now, .spindle_turns = true}, state);
    const std::size_t phase = t_s > kPlunge_s + 1e-9 ? 1 : 0;
    const double force_N = output.F_T_W.f.norm();
    run.mean_force_N[phase] += force_N;
    ++ticks[phase];
    if (i % kPlotEvery == 0) {
      run.force.x.push_back(t_s);
      run.force.y.push_back(force_N);
    }
  }
  for (std::size_t i = 0; i < 2; ++i) run.mean_force_N[i] /= std::max(1, ticks[i]);
  run.removed_m3 = model.removed_volume_m3;
  return run;
}

/// Largest relative differences from the run at 1 kHz: of the mean forces, and of the removed volume.
struct Spread {
  double force{0.0}, volume{0.0};
  [[nodiscard]] double worst() const { return std::max(force, volume); }
};

Spread SpreadOf(const std::array<Run, kRates_hz.size()>& runs) {
  const Run& nominal = runs[kNominal];
  Spread spread;
  for (const Run& run : runs) {
    for (std::size_t i = 0; i < 2; ++i)
      spread.force = std::max(spread.force, std::abs(run.mean_force_N[i] / nominal.mean_force_N[i] - 1.0));
    spread.volume = std::max(spread.volume, std::abs(run.removed_m3 / nominal.removed_m3 - 1.0));
  }
  return spread;
}

}  // namespace

FailureResult RunFrameRate(const FailureSetting& setting) {
  FailureResult result{.id = 22,
                       .name = "frame rate",
                       .metric = "largest difference in force or volume between 0.25 and 2 kHz",
                       .unit = "1",
                       .baseline_name = "removal up to the device's pose",
                       .bound = 0.02};
  const double R = setting.full() ? 5e-3 : 3e-3;
  const simulation::Bone block = MakeBlock({.low_m = {-1.3 * R - 1e-3, -1.3 * R, -3e-3},
                                            .high_m = {1.3 * R + 4e-3, 1.3 * R, 0.0},
                                            .ball_radius_m = setting.full() ? 0.5e-3 : 0.75e-3,
                                            .point_spacing_m = setting.full() ? 0.25e-3 : 0.35e-3,
                                            .specific_cutting_energy_J_per_m3 = 10e6});
  const simulation::Tool tool = MakeBallTool(R);
  std::array<Run, kRates_hz.size()> rate_law, immediate;
  bool complete = true;
  for (std::size_t i = 0; i < kRates_hz.size() && complete; ++i) {
    rate_law[i] = Play(*setting.make_engine(block, tool, Pose::Identity(), {}), kRates_hz[i]);
    complete = setting.GoesOn((2.0 * static_cast<double>(i) + 1.0) / (2.0 * kRates_hz.size()));
    immediate[i] =
        Play(*setting.make_engine(block, tool, Pose::Identity(), {.law = simulation::RemovalLaw::kImmediate}),
             kRates_hz[i]);
    complete = setting.GoesOn((2.0 * static_cast<double>(i) + 2.0) / (2.0 * kRates_hz.size())) && complete;
  }
  if (complete) {
    const Spread ours = SpreadOf(rate_law), baseline = SpreadOf(immediate);
    result.ours = ours.worst();
    result.baseline = baseline.worst();
    result.note =
        fmt::format("ours: force within {:.2f} %, volume within {:.2f} %; baseline: {:.0f} % and {:.1f} %",
                    100.0 * ours.force, 100.0 * ours.volume, 100.0 * baseline.force, 100.0 * baseline.volume);
  }
  result.baseline_fails = result.baseline > result.bound;
  result.ours_passes = complete && result.ours <= result.bound;
  result.plot = {.x_label = "time [s]", .y_label = "force [N]"};
  const auto add = [&](Run& run, const std::string& name, bool ours) {
    run.force.name = name;
    run.force.ours = ours;
    result.plot.series.push_back(std::move(run.force));
  };
  for (const std::size_t i : {std::size_t{0}, kRates_hz.size() - 1}) {
    add(immediate[i], fmt::format("device's pose, {:g} kHz", 1e-3 * kRates_hz[i]), false);
    add(rate_law[i], fmt::format("ours, {:g} kHz", 1e-3 * kRates_hz[i]), true);
  }
  return result;
}

}  // namespace osteon::studies
