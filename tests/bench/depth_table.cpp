#include <cstdio>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "tests/oracles/depth_table.h"

// Prints a table of the accuracy of removal as CSV: for both scenes, the recommended packings, splitting into
// more and into fewer children, and the paper's rule on the paper's own packings.
//
//     osteon_depth_table > results/depth.csv
//
// The table is the same on any machine.

namespace osteon::simulation {
namespace {

// Measures a scene with one method and one step length of the tool, and prints a row of the table.
void Print(const DepthScene& scene, const DepthMethod& method, double step_m) {
  const DepthRow row = MeasureDepth(scene, method, step_m, {.surface_cells = 60'000, .probe_samples = 6000});
  const CutAccuracy& a = row.accuracy;
  std::printf("%s,\"%s\",%g,%zu,%zu,%zu,%zu,%.4f,%.4f", row.scene.c_str(), row.method.c_str(), step_m * 1e3,
              row.balls, row.live, row.touching, row.blocks, a.depth_error_m * 1e3, a.depth_error_se_m * 1e3);
  for (const ProbeGap& probe : a.probes) std::printf(",%.4f,%.4f", probe.mean_m * 1e3, probe.p95_m * 1e3);
  std::printf(",%.3g,%.3f,%.1f\n", row.overlap_m * 1e3, a.swept_volume_m3 * 1e9, a.cut_area_m2 * 1e6);
  std::fflush(stdout);
}

int Main() {
  std::printf(
      "scene,method,step_mm,balls,live,touching,blocks,depth_error_mm,standard_error_mm,probe_R_mean_mm,"
      "probe_R_p95_mm,probe_half_R_mean_mm,probe_half_R_p95_mm,probe_1mm_mean_mm,probe_1mm_p95_mm,"
      "left_in_path_mm,swept_mm3,cut_mm2\n");
  const DepthScene block = MakeBlockScene(), cup = MakeCupScene();
  constexpr double kStep_m = 0.1e-3;
  // numbers of balls, and the largest radius of each packing
  for (const auto& [count, radius_m] : {std::pair{560ul, 2e-3}, {4000ul, 0.9e-3}, {16105ul, 0.5e-3}})
    Print(block, DisjointMethod(block, count, radius_m), kStep_m);
  DepthMethod ours = RecommendedMethod(block);
  for (const double step_m : {0.05e-3, 0.5e-3, kStep_m}) Print(block, ours, step_m);
  for (const int children : {16, 32, 48, 96}) {
    ours.split.children = children;
    ours.name = "graded, split into " + std::to_string(children);
    Print(block, ours, kStep_m);
  }
  ours.split.on = false;
  ours.name = "graded, not split";
  Print(block, ours, kStep_m);

  for (const auto& [count, radius_m] : {std::pair{6000ul, 1.2e-3}, {23000ul, 0.75e-3}})
    Print(cup, DisjointMethod(cup, count, radius_m), kStep_m);
  DepthMethod overlap = RecommendedMethod(cup);
  for (const double step_m : {0.05e-3, 0.5e-3, kStep_m}) Print(cup, overlap, step_m);
  overlap.split.on = true;
  overlap.split.pool_blocks = 20'000;
  overlap.name = "overlap, split";
  Print(cup, overlap, kStep_m);
  return 0;
}

}  // namespace
}  // namespace osteon::simulation

int main() {
  try {
    return osteon::simulation::Main();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "osteon_depth_table: %s\n", error.what());
    return 1;
  }
}
