#include "studies/failures/procedure/tool_in_bone.h"

#include <algorithm>

#include <fmt/format.h>

#include "session/procedure/procedure_session.h"
#include "simulation/engine/tool_change.h"
#include "studies/failures/scenario_bench.h"

namespace osteon::studies {
namespace {

// Radii of a small reamer that has cut a cavity in a block, and of a larger reamer at the same centre; both
// are scaled by about 1 : 5.5 from real reamers.
constexpr double kSmall_m = 4.0e-3, kLarge_m = 4.6e-3, kStiffness_N_per_m = 20e3;
constexpr int kFrames = 200;  // frames of the cut with the small reamer

}  // namespace

// The baseline resumes motion with the larger tool at the smaller tool's place: the tool begins in bone, and
// the coupling pushes it out. Ours refuses to resume and says how far to retract; after the retraction the
// tool is clear of bone.
FailureResult RunToolInBone(const FailureSetting& setting) {
  FailureResult result{.id = 34,
                       .name = "tool in bone",
                       .metric = "deepest ball of the tool in bone when motion resumes",
                       .unit = "mm",
                       .baseline_name = "the tool changes where it stands",
                       .bound = 0.0};
  const simulation::Bone block = MakeBlock({.low_m = {-9e-3, -9e-3, -9e-3},
                                            .high_m = {9e-3, 9e-3, 0.0},
                                            .ball_radius_m = 0.6e-3,
                                            .point_spacing_m = setting.full() ? 0.3e-3 : 0.5e-3,
                                            .specific_cutting_energy_J_per_m3 = 3e6});
  const simulation::Tool small = MakeBallTool(kSmall_m), large = MakeBallTool(kLarge_m);
  const auto engine = setting.make_engine(block, small, Pose::Identity(), {});
  Pose X_end = Pose::Identity();
  for (int i = 0; i <= kFrames; ++i) {
    const double share = static_cast<double>(i) / kFrames;
    X_end = Downwards({0.0, 0.0, 0.3e-3 - 3.0e-3 * share});
    (void)engine->Step(FrameAt(X_end, kScenarioSpindle_rad_per_s, 5e-3));
  }
  const simulation::CarvedState state = engine->Snapshot();
  const Pose X_small = state.X_GP;
  // The head's centre keeps its place, so the apex lies further ahead by the difference of the radii.
  const Pose X_large = X_small * Eigen::Translation3d(0.0, 0.0, kLarge_m - kSmall_m);
  const double clear_m = simulation::ToolClearance(state, large, X_large);
  result.baseline = std::max(0.0, -1e3 * clear_m);
  // Ours: retract along the tool's axis until the tool is clear of bone.
  double retracted_m = 0.0;
  Pose X_retracted = X_large;
  FailureSeries depth{.name = "deepest ball, where it stands", .ours = false},
      free{.name = "gap demanded", .ours = true};
  while (simulation::ToolClearance(state, large, X_retracted) < session::kClearToResume_m &&
         retracted_m < 0.02) {
    depth.x.push_back(1e3 * retracted_m);
    depth.y.push_back(-1e3 * simulation::ToolClearance(state, large, X_retracted));
    retracted_m += 0.1e-3;
    X_retracted = X_large * Eigen::Translation3d(0.0, 0.0, -retracted_m);
  }
  result.ours = std::max(0.0, -1e3 * simulation::ToolClearance(state, large, X_retracted));
  const auto other = setting.make_engine(block, large, Pose::Identity(), {});
  simulation::CarvedState without = simulation::WithoutContact(state);
  other->Restore(without);
  (void)other->Step(FrameAt(X_retracted));
  const auto first = other->Step(FrameAt(X_retracted));
  result.baseline_fails = result.baseline > 0.1;
  result.ours_passes = result.ours <= result.bound && first.contact_count == 0 && setting.GoesOn(1.0);
  result.note = fmt::format(
      "Reamers of {:g} and {:g} mm at one centre: refused, \"retract {:.1f} mm first\". The coupling of 20 "
      "N/mm would push with {:.0f} N at once.",
      2e3 * kSmall_m, 2e3 * kLarge_m, 1e3 * retracted_m, kStiffness_N_per_m * 1e-3 * result.baseline);
  free.x = {0.0, 1e3 * retracted_m};
  free.y = {-0.5, -0.5};
  result.plot = {.x_label = "retracted, mm", .y_label = "depth in bone, mm", .series = {depth, free}};
  return result;
}

}  // namespace osteon::studies
