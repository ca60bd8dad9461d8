#include "studies/failures/cutting/thin_sheet.h"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/scramble.h"
#include "simulation/methods/method.h"
#include "simulation/solids/box_solid.h"
#include "studies/failures/scenario_bench.h"

namespace osteon::studies {
namespace {

constexpr double kThickness_m = 1e-3, kVoxel_m = 0.25e-3;
// A shot is aimed at a place up to kAim_m from the sheet's centre, begins up to kHighest_m above the sheet,
// ends kBeyond_m below the sheet, and is inclined by up to kMaxTilt_rad.
constexpr double kAim_m = 3e-3, kHighest_m = 2e-3, kBeyond_m = 2e-3, kMaxTilt_rad = M_PI / 6.0;

/// Vertical travel of a shot that begins at a height above the sheet.
double Descent(double height_m, double tool_radius_m) {
  return height_m + kThickness_m + 2.0 * tool_radius_m + kBeyond_m;
}

/// Half the width of the sheet. It is wide enough that an inclined shot ends at least a millimetre from the
/// sheet's edge. It is no wider, since the reference engine visits every ball in every frame.
double HalfWidth(double tool_radius_m) {
  return kAim_m + std::tan(kMaxTilt_rad) * Descent(kHighest_m, tool_radius_m) + 1e-3;
}

struct Shot {
  double speed_m_per_s;
  Vector3 start_m, way_m;  ///< start and displacement of the apex
};

/// The n-th shot of a tool, the same for every engine.
Shot MakeShot(std::uint64_t n, double tool_radius_m) {
  std::uint64_t bits = simulation::Scramble(0x5eedULL + n);
  const auto uniform = [&bits](double low, double high) {
    bits = simulation::Scramble(bits);
    return low + (high - low) * simulation::Uniform(bits);
  };
  Shot shot{};
  // Every fifth speed is uniform in its logarithm, the others are uniform: fast shots matter most, and slow
  // shots take the most frames.
  shot.speed_m_per_s = n % 5 == 0 ? 0.01 * std::pow(100.0, uniform(0.0, 1.0)) : uniform(0.01, 1.0);
  const double tilt = uniform(0.0, kMaxTilt_rad), about = uniform(0.0, 2.0 * M_PI);
  const Vector3 aim(uniform(-kAim_m, kAim_m), uniform(-kAim_m, kAim_m), 0.0);
  const Vector3 direction(std::sin(tilt) * std::cos(about), std::sin(tilt) * std::sin(about),
                          -std::cos(tilt));
  // The height is random over at least a frame's travel, so that the discrete poses fall anywhere in the
  // sheet.
  const double height_m = uniform(0.05e-3, kHighest_m - 1e-3 + 1e-3 * shot.speed_m_per_s);
  shot.start_m = aim + Vector3(0, 0, height_m);
  shot.way_m = direction * Descent(height_m, tool_radius_m) / std::cos(tilt);
  return shot;
}

/// Number of shots in a range of speeds, and how many of them passed; five ranges per decade.
struct Tally {
  int shots{0}, passed{0};
  int Add(bool has_passed) {  // @returns 1 if it has passed, otherwise 0
    ++shots;
    passed += has_passed ? 1 : 0;
    return has_passed ? 1 : 0;
  }
};
constexpr std::size_t kSpeedBins = 10;
// Index of the speed's range, of 10 from 0.01 to 1 m/s.
std::size_t BinOf(double speed_m_per_s) {
  return std::min(kSpeedBins - 1, static_cast<std::size_t>(5.0 * std::log10(speed_m_per_s / 0.01)));
}
// Returns the share of shots that passed [%] over the speed [mm/s], as a line of the picture.
FailureSeries ShareBySpeed(const std::string& name, const std::array<Tally, kSpeedBins>& tallies, bool ours) {
  FailureSeries series{.name = name, .x = {}, .y = {}, .ours = ours};
  for (std::size_t i = 0; i < kSpeedBins; ++i) {
    if (tallies[i].shots == 0) continue;
    series.x.push_back(10.0 * std::pow(10.0, (static_cast<double>(i) + 0.5) / 5.0));
    series.y.push_back(100.0 * tallies[i].passed / tallies[i].shots);
  }
  return series;
}

/// Simulates a shot, and returns whether the proxy's centre ended below the sheet.
bool PassesThrough(simulation::CuttingEngine& engine, const Shot& shot, double tool_radius_m) {
  const int frames = static_cast<int>(std::ceil(shot.way_m.norm() / (shot.speed_m_per_s * 1e-3)));
  simulation::ContactModel model;
  for (int i = 0; i <= frames; ++i)
    model = engine.Step(FrameAt(Downwards(shot.start_m + shot.way_m * (static_cast<double>(i) / frames))));
  return Pose(model.X_WP).translation().z() + tool_radius_m < -kThickness_m;
}

}  // namespace

FailureResult RunThinSheet(const FailureSetting& setting) {
  FailureResult result{.id = 1,
                       .name = "thin sheet",
                       .metric = "shots that passed through the sheet",
                       .unit = "1",
                       .baseline_name = "voxmap and pointshell, voxels of 0.25 mm"};
  const int shots_per_tool = setting.full() ? 2000 : 8, baseline_per_tool = setting.full() ? 60 : 4;
  constexpr std::array kRadii_m{1e-3, 2e-3, 3e-3, 4e-3, 5e-3};
  std::array<Tally, kSpeedBins> by_speed{}, ours_by_speed{};
  int ours = 0, baseline = 0, shots = 0, baseline_shots = 0;
  bool complete = true;
  for (std::size_t tool_index = 0; tool_index < kRadii_m.size() && complete; ++tool_index) {
    const double R = kRadii_m[tool_index];
    const double w = HalfWidth(R);
    const Vector3 low(-w, -w, -kThickness_m), high(w, w, 0.0);
    const simulation::Bone sheet = MakeBlock(
        {.low_m = low, .high_m = high, .ball_radius_m = 0.5 * kThickness_m, .point_spacing_m = 1e-3});
    const simulation::BoxSolid solid(low, high);
    const simulation::Tool tool = MakeBallTool(R);
    const auto engine = setting.make_engine(sheet, tool, Pose::Identity(), {});
    const simulation::CarvedState untouched = engine->Snapshot();
    const auto pointshell = simulation::MakeMethod(simulation::Method::kPointshell, sheet, &solid, tool,
                                                   Pose::Identity(), {}, {.voxel_m = kVoxel_m});
    const simulation::CarvedState whole = pointshell->Snapshot();
    for (int i = 0; i < shots_per_tool; ++i) {
      const Shot shot = MakeShot(1000003ULL * tool_index + static_cast<std::uint64_t>(i), R);
      engine->Restore(untouched);
      const std::size_t bin = BinOf(shot.speed_m_per_s);
      ++shots;
      ours += ours_by_speed[bin].Add(PassesThrough(*engine, shot, R));
      if (i < baseline_per_tool) {
        pointshell->Restore(whole);
        ++baseline_shots;
        baseline += by_speed[bin].Add(PassesThrough(*pointshell, shot, R));
      }
      if (i % 16 == 0 &&
          !setting.GoesOn((static_cast<double>(tool_index) + 1.0 * i / shots_per_tool) / kRadii_m.size())) {
        complete = false;
        break;
      }
    }
  }
  result.bound = 0.0;
  result.baseline = baseline;
  result.ours = ours;
  result.baseline_fails = baseline > 0;
  result.ours_passes = complete && ours == 0;
  result.plot = {
      .x_label = "speed [mm/s]",
      .y_label = "shots that passed [%]",
      .log_x = true,
      .series = {ShareBySpeed("pointshell", by_speed, false), ShareBySpeed("ours", ours_by_speed, true)}};
  result.note = fmt::format("{} shots; the baseline had {}", shots, baseline_shots);
  return result;
}

}  // namespace osteon::studies
