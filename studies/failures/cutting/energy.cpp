#include "studies/failures/cutting/energy.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "simulation/methods/method.h"
#include "studies/failures/scenario_bench.h"

namespace osteon::studies {
namespace {

// Radius of the burr; its height above the surface at the top of a cycle; its depth at the bottom.
constexpr double kRadius_m = 2e-3, kTop_m = 0.3e-3, kDepth_m = 1.6e-3;
constexpr double kRowStep_m = 1.5e-3;           // distance of neighbouring dimples
constexpr int kFramesPerCycle = 300, kRow = 5;  // kRow: number of dimples in a row
constexpr double kSpindle_rad_per_s = 4000.0 * 2.0 * M_PI / 60.0;
constexpr double kCuttingEnergy_J_per_m3 = 0.48e9;  // sawbones, MacAvelia 2012: 0.45 to 0.53 J/mm³

/// Work and energy of a run, summed over its cycles.
struct WorkSums {
  double drive_J{0.0}, feed_J{0.0}, cut_J{0.0};
  double returned_J{0.0};  ///< largest energy that a closed cycle gave to the hand; never negative
  double stored_J{0.0};    ///< largest energy stored in the coupling's spring
  /// Work of drive and feed, and cutting energy [J], over the number of cycles.
  FailureSeries drive_and_feed, cut;

  [[nodiscard]] double Imbalance() const {
    return std::abs(drive_J + feed_J - cut_J) / std::max(cut_J, 1e-12);
  }
  /// Largest energy that a cycle gave to the hand, over the spring's largest energy. A value below a
  /// thousandth is the error of the trapezoidal rule.
  [[nodiscard]] double ReturnedShare() const { return returned_J / std::max(stored_J, 1e-12); }
};

/// Position of a cycle's dimple on the surface.
Vector3 PlaceOf(int cycle) {
  return {(cycle % kRow - kRow / 2) * kRowStep_m, cycle / kRow * kRowStep_m, 0.0};
}

/// Position of the apex at a share (0 … 1) of a cycle: down, sideways and round, up, back to the start.
Vector3 OnCycle(int cycle, double depth_m, double share) {
  const double phase = 2.0 * M_PI * share;
  return PlaceOf(cycle) + Vector3(0.3e-3 * std::sin(phase), 0.15e-3 * std::sin(2.0 * phase),
                                  0.5 * (kTop_m - depth_m) + 0.5 * (kTop_m + depth_m) * std::cos(phase));
}

/// Runs the cycles and sums their work.
WorkSums SumWork(simulation::CuttingEngine& engine, int cycles, double depth_m, double spindle_rad_per_s,
                 double stiffness_N_per_m) {
  WorkSums sums;
  Vector3 p = OnCycle(0, depth_m, 0.0), f = Vector3::Zero();
  engine.Step(FrameAt(Downwards(p), spindle_rad_per_s));
  for (int cycle = 0; cycle < cycles; ++cycle) {
    double onto_hand_J = 0.0;
    for (int i = 1; i <= kFramesPerCycle; ++i) {
      const Vector3 next = OnCycle(cycle, depth_m, static_cast<double>(i) / kFramesPerCycle);
      const auto model = engine.Step(FrameAt(Downwards(next), spindle_rad_per_s));
      const Vector3 force = model.F_T_W.f;
      onto_hand_J += 0.5 * (f + force).dot(next - p);
      sums.drive_J += model.spindle_torque_Nm * std::abs(spindle_rad_per_s) * 1e-3;
      sums.stored_J = std::max(sums.stored_J, 0.5 * force.squaredNorm() / stiffness_N_per_m);
      sums.cut_J = model.cutting_work_J;
      f = force;
      p = next;
    }
    sums.feed_J -= onto_hand_J;
    sums.returned_J = std::max(sums.returned_J, onto_hand_J);
    sums.drive_and_feed.x.push_back(cycle + 1.0);
    sums.drive_and_feed.y.push_back(sums.drive_J + sums.feed_J);
    sums.cut.x.push_back(cycle + 1.0);
    sums.cut.y.push_back(sums.cut_J);
  }
  return sums;
}

}  // namespace

FailureResult RunEnergy(const FailureSetting& setting) {
  FailureResult result{.id = 20,
                       .name = "energy",
                       .metric = "drive's and feed's work against the cutting energy",
                       .unit = "1",
                       .baseline_name = "the paper as printed",
                       .bound = 0.05};
  const int cycles = setting.full() ? 100 : 30;
  const double half_width_m = kRow / 2 * kRowStep_m + kRadius_m + 1e-3;
  const simulation::Bone block =
      MakeBlock({.low_m = {-half_width_m, -kRadius_m - 1e-3, -3e-3},
                 .high_m = {half_width_m, PlaceOf(cycles).y() + kRadius_m + 1e-3, 0.0},
                 .ball_radius_m = 0.6e-3,
                 .point_spacing_m = 0.4e-3,
                 .specific_cutting_energy_J_per_m3 = kCuttingEnergy_J_per_m3});
  const simulation::Tool tool = MakeBallTool(kRadius_m);
  const simulation::CuttingParams params;
  const auto ours_engine = setting.make_engine(block, tool, Pose::Identity(), params);
  WorkSums ours = SumWork(*ours_engine, cycles, kDepth_m, kSpindle_rad_per_s, params.stiffness_N_per_m);
  bool complete = setting.GoesOn(0.6);
  const WorkSums still = SumWork(*setting.make_engine(block, tool, Pose::Identity(), params),
                                 setting.full() ? 20 : 4, 0.5e-3, 0.0, params.stiffness_N_per_m);
  complete = setting.GoesOn(0.8) && complete;
  const auto printed = simulation::MakeMethod(simulation::Method::kPaperPrinted, block, nullptr, tool,
                                              Pose::Identity(), params, {});
  WorkSums baseline = SumWork(*printed, cycles, kDepth_m, kSpindle_rad_per_s, params.stiffness_N_per_m);
  static_cast<void>(setting.GoesOn(1.0));

  constexpr double kQuadrature = 1e-3;  // error of the trapezoidal rule, as a share of the spring's energy
  const double returned = std::max(ours.ReturnedShare(), still.ReturnedShare());
  result.baseline = baseline.Imbalance();
  result.ours = ours.Imbalance();
  result.baseline_fails = result.baseline > result.bound;
  result.ours_passes = complete && result.ours <= result.bound && returned <= kQuadrature && ours.cut_J > 0.0;
  result.note = fmt::format(
      "{} cycles; drive {:.3f} J, feed {:.3f} J, cut {:.3f} J; a closed cycle gave back {:.2g} of the "
      "spring's energy (spindle off: {:.2g}), the baseline {:.2g}",
      cycles, ours.drive_J, ours.feed_J, ours.cut_J, ours.ReturnedShare(), still.ReturnedShare(),
      baseline.ReturnedShare());
  baseline.drive_and_feed.name = "printed: drive and feed";
  baseline.cut.name = "printed: cut";
  ours.drive_and_feed.name = "ours: drive and feed";
  ours.cut.name = "ours: cut";
  ours.drive_and_feed.ours = ours.cut.ours = true;
  result.plot = {.x_label = "cycle",
                 .y_label = "work and cutting energy [J]",
                 .series = {std::move(baseline.drive_and_feed), std::move(baseline.cut),
                            std::move(ours.drive_and_feed), std::move(ours.cut)}};
  return result;
}

}  // namespace osteon::studies
