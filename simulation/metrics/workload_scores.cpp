#include "simulation/metrics/workload_scores.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "simulation/fidelity/accuracy.h"
#include "simulation/metrics/ripple.h"

namespace osteon::simulation {

WorkloadScores ScoreWorkload(const CutWorkload& workload, const WorkloadRun& run, const CarvedShape& before,
                             const CarvedShape& after, std::size_t surface_cells) {
  if (!run.complete)
    throw std::invalid_argument("workload: found a run that was ended early, accepted a complete one");
  constexpr double kProbe_m = 1e-3;  // radius of the ball that probes the cut
  const SweptTool swept(workload.tool, workload.CutPath());
  const CutAccuracy cut = MeasureCut(*workload.solid, before, after, swept,
                                     {.probe_radii_m = {kProbe_m},
                                      .surface_cells = surface_cells,
                                      .probe_samples = std::min<std::size_t>(2000, surface_cells)});
  WorkloadScores scores;
  scores.lost_m = cut.depth_error_m;
  scores.left_m = cut.MeanLeft_m();
  scores.depth_error_m = scores.lost_m + scores.left_m;
  scores.depth_error_se_m = cut.depth_error_se_m;
  scores.probe_p95_m = cut.probes.front().p95_m;
  scores.swept_volume_m3 = cut.swept_volume_m3;
  scores.volume_error = std::abs(run.removed_volume_m3 / cut.swept_volume_m3 - 1.0);

  scores.force = CompareForces(run.felt, workload.exact, workload.rate_hz);
  std::vector<double> magnitude_N;
  for (const FeltForce& felt : run.felt) magnitude_N.push_back(felt.f_N.norm());
  // Divide by the exact mean force, not by the measured one: a stuck tool has a large and steady force, whose
  // relative ripple would be small.
  double exact_N = 0.0;
  for (const FeltForce& exact : workload.exact)
    exact_N += exact.f_N.norm() / static_cast<double>(workload.exact.size());
  const Ripple ripple = MeasureRipple(magnitude_N, workload.rate_hz);
  scores.ripple = std::hypot(ripple.slow_N, ripple.fast_N) / exact_N;
  return scores;
}

WorkloadScores Combined(const std::vector<WorkloadScores>& all) {
  WorkloadScores sum;
  if (all.empty()) return sum;
  const auto root_mean_square = [&](const auto& member) {
    double squares = 0.0;
    for (const WorkloadScores& each : all) squares += member(each) * member(each);
    return std::sqrt(squares / static_cast<double>(all.size()));
  };
  const auto maximum = [&](const auto& member) {
    double largest = 0.0;
    for (const WorkloadScores& each : all) largest = std::max(largest, member(each));
    return largest;
  };
  using W = WorkloadScores;
  sum.depth_error_m = root_mean_square([](const W& w) { return w.depth_error_m; });
  sum.depth_error_se_m = root_mean_square([](const W& w) { return w.depth_error_se_m; });
  sum.lost_m = root_mean_square([](const W& w) { return w.lost_m; });
  sum.left_m = root_mean_square([](const W& w) { return w.left_m; });
  sum.probe_p95_m = root_mean_square([](const W& w) { return w.probe_p95_m; });
  sum.volume_error = root_mean_square([](const W& w) { return w.volume_error; });
  sum.swept_volume_m3 = root_mean_square([](const W& w) { return w.swept_volume_m3; });
  sum.ripple = root_mean_square([](const W& w) { return w.ripple; });
  sum.force.force_rms_N = root_mean_square([](const W& w) { return w.force.force_rms_N; });
  sum.force.force_relative = root_mean_square([](const W& w) { return w.force.force_relative; });
  sum.force.torque_rms_Nm = root_mean_square([](const W& w) { return w.force.torque_rms_Nm; });
  sum.force.normal_rms_deg = root_mean_square([](const W& w) { return w.force.normal_rms_deg; });
  sum.force.normal_max_deg = maximum([](const W& w) { return w.force.normal_max_deg; });
  sum.force.force_jump_N_per_ms = maximum([](const W& w) { return w.force.force_jump_N_per_ms; });
  sum.force.torque_jump_Nm_per_ms = maximum([](const W& w) { return w.force.torque_jump_Nm_per_ms; });
  sum.force.normal_jump_deg_per_ms = maximum([](const W& w) { return w.force.normal_jump_deg_per_ms; });
  sum.force.touched = std::ranges::all_of(all, [](const W& w) { return w.force.touched; });
  return sum;
}

}  // namespace osteon::simulation
