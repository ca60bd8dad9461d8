#include "studies/charts/method_ladder.h"

#include <algorithm>
#include <cmath>

#include "simulation/packing/disjoint_packing.h"
#include "simulation/packing/mass_points.h"
#include "simulation/packing/packing_builder.h"
#include "simulation/packing/split_packing.h"
#include "studies/bench/method_engine.h"

namespace osteon::studies {
namespace {

constexpr double kReamer_m = 25e-3;  // radius of the reamer for which the steps' lengths are stated
constexpr double kZone_m = 6.5e-3;   // depth of the finely packed layer; the cut is at most 5.5 mm deep
// Smallest radius of a split ball, divided by the spacing; see SplitParams and SplitPackingParams.
constexpr double kMinSplit = 0.4 / 2.5;

// Whether the method splits balls when the tool touches them.
bool Splits(const MethodStep& step) { return step.method == "split" || step.method == "cpu-split"; }

double ToolRadius(const simulation::CutWorkload& work) { return work.tool.balls.front().radius_m; }

// Packs overlapping balls on a lattice, fine down to kZone_m; their radii are capped as MethodStep states.
std::vector<simulation::Ball> Overlapping(const simulation::CutWorkload& work, double spacing_m,
                                          std::uint64_t seed) {
  simulation::PackingParams params;
  const double cap_m = std::max(1.2 * spacing_m, std::min(2.0 * spacing_m, 0.2 * ToolRadius(work)));
  params.lattice = {.finest_m = spacing_m, .coarser_from_m = {kZone_m}};
  params.cup_radius_cap_m = cap_m;
  params.cup_depth_m = kZone_m - cap_m;
  params.min_radius_m = 0.1 * cap_m;
  // the gap that the default scene has at its spacing of 1.5 mm, in proportion
  params.surface_gap_m = std::clamp(0.04e-3 * spacing_m / 1.5e-3, 0.002e-3, 0.1e-3);
  params.samples = {.finest_m = spacing_m / 6.0, .coarser_from_m = {kZone_m}};
  params.seed = seed;
  return simulation::BuildPacking(*work.solid, *work.zone, params);
}

// Packs large balls in the proportions of SplitPackingParams, fine to the depth of the cut.
std::vector<simulation::Ball> ForSplitting(const simulation::CutWorkload& work, double spacing_m,
                                           std::uint64_t seed) {
  simulation::SplitPackingParams params;
  const double scale = spacing_m / params.spacing_m;
  params.spacing_m = spacing_m;
  params.fine_depth_m = kZone_m;
  params.coarser_from_m *= scale;
  params.surface_radius_m *= scale;
  params.surface_gap_m *= scale;
  params.seed = seed;
  return simulation::BuildSplitPacking(*work.solid, *work.zone, params);
}

// Packs balls that don't overlap, with radii from radius_m / 3 to radius_m.
std::vector<simulation::Ball> Disjoint(const simulation::CutWorkload& work, double radius_m,
                                       std::uint64_t seed) {
  return simulation::BuildDisjointPacking(
      *work.solid, *work.zone,
      {.count = 0, .min_radius_m = radius_m / 3.0, .max_radius_m = radius_m, .grade = 0.3, .seed = seed});
}

}  // namespace

std::vector<MethodStep> MethodLadder(bool quick) {
  struct Rungs {  // a method's lengths, coarse to fine, and the fewer lengths of a quick run
    const char* method;
    std::vector<double> lengths_mm, quick_mm;
  };
  static const std::vector<double> spacings{4.0, 3.0, 2.0, 1.5, 1.0}, quick_spacings{3.0, 1.5};
  static const std::vector<double> split{8.0, 5.6, 4.0}, quick_split{8.0, 5.6};
  static const std::vector<double> disjoint{4.0, 2.8, 2.0, 1.4, 1.0}, quick_disjoint{4.0, 2.0};
  static const std::vector<double> voxels{2.0, 1.4, 1.0, 0.7, 0.5, 0.35, 0.25, 0.125}, quick_voxels{1.0, 0.5};
  static const std::vector<Rungs> all{
      {"cpu", spacings, quick_spacings},           {"cpu-split", split, quick_split},
      {"ours", spacings, quick_spacings},          {"split", split, quick_split},
      {"stamps", spacings, quick_spacings},        {"paper", disjoint, quick_disjoint},
      {"paper-printed", disjoint, quick_disjoint}, {"voxel", voxels, quick_voxels},
      {"pointshell", voxels, quick_voxels}};
  std::vector<MethodStep> ladder;
  for (const Rungs& rungs : all)
    for (const double length_mm : quick ? rungs.quick_mm : rungs.lengths_mm)
      ladder.push_back({.method = rungs.method, .length_m = 1e-3 * length_mm});
  return ladder;
}

const std::vector<std::string>& LadderMethods() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const MethodStep& step : MethodLadder(true))
      if (all.empty() || all.back() != step.method) all.push_back(step.method);
    return all;
  }();
  return names;
}

bool IsOurs(const std::string& method) {
  return method == "cpu" || method == "cpu-split" || method == "ours" || method == "split";
}

std::string EngineOfStep(const MethodStep& step) {
  return step.method == "split" ? "ours" : step.method == "cpu-split" ? "cpu" : step.method;
}

simulation::CuttingParams CuttingForStep(const MethodStep& step, const simulation::CutWorkload& work) {
  simulation::CuttingParams cutting = work.cutting;
  if (!Splits(step)) return cutting;
  cutting.split.on = true;
  cutting.split.min_radius_m = kMinSplit * ScaledLength(step.length_m, work);
  cutting.split.pool_blocks = 16'384;  // the reamer's cut takes some thousand blocks
  return cutting;
}

double ScaledLength(double length_m, const simulation::CutWorkload& work) {
  return length_m * std::sqrt(ToolRadius(work) / kReamer_m);
}

LadderBone PackForStep(const MethodStep& step, const simulation::CutWorkload& work,
                       const std::vector<simulation::MassPoint>& points, std::uint64_t seed) {
  LadderBone made;
  made.bone.name = std::string(TaskName(work.task));
  made.bone.materials = work.materials;
  made.bone.points = points;
  const double length_m = ScaledLength(step.length_m, work);
  if (WantsVoxels(step.method)) {
    made.r_max_m = 0.5 * length_m;
    return made;
  }
  made.bone.balls = Splits(step)                 ? ForSplitting(work, length_m, seed)
                    : WantsDisjoint(step.method) ? Disjoint(work, length_m, seed)
                                                 : Overlapping(work, length_m, seed);
  // Count only balls that reach to within 3 mm of the zone's surface: deeper balls may be larger.
  for (const simulation::Ball& ball : made.bone.balls)
    if (work.zone->DepthAt(Vector3(ball.center_m)) - ball.radius_m < 3e-3)
      made.r_max_m = std::max(made.r_max_m, ball.radius_m);
  return made;
}

bool SharePacking(const MethodStep& a, const MethodStep& b) {
  const auto kind = [](const MethodStep& step) {  // kind of packing
    return Splits(step) ? 3 : WantsVoxels(step.method) ? 2 : WantsDisjoint(step.method) ? 1 : 0;
  };
  return a.length_m == b.length_m && kind(a) == kind(b);
}

std::vector<simulation::MassPoint> LadderPoints(const simulation::CutWorkload& work) {
  simulation::MassPointParams params;
  params.cells = {.finest_m = ScaledLength(0.75e-3, work), .coarser_from_m = {kZone_m}};
  return simulation::BuildMassPoints(*work.solid, *work.zone, params);
}

}  // namespace osteon::studies
