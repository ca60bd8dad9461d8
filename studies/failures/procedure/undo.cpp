#include "studies/failures/procedure/undo.h"

#include <cmath>

#include <fmt/format.h>

#include "simulation/engine/tool_change.h"
#include "studies/failures/scenario_bench.h"

namespace osteon::studies {
namespace {

constexpr double kRadius_m = 4e-3;

// Cuts one pass: down, sideways, and out again. Passes with different numbers are 2 mm apart, side by side.
void Ream(simulation::CuttingEngine& engine, int number, int frames) {
  for (int i = 0; i <= frames; ++i) {
    const double share = static_cast<double>(i) / frames;
    const double depth_m = 1.5e-3 * std::sin(M_PI * share);
    (void)engine.Step(FrameAt(Downwards({2e-3 * number + 1e-3 * share, 0.0, 0.5e-3 - depth_m}),
                              kScenarioSpindle_rad_per_s));
  }
}

// Sets the engine's bone to a saved state; the tool is clear of bone.
void Continue(simulation::CuttingEngine& engine, const simulation::CarvedState& state) {
  engine.Restore(simulation::WithoutContact(state));
}

}  // namespace

// Two passes in a row are compared with two other sequences that must leave the same bone. Sequence 1: two
// passes, the second of which is undone and cut again. Sequence 2: one pass, whose state is saved and resumed
// by another engine, which cuts the second pass. The baseline does not restore the bone when a pass is
// undone.
FailureResult RunUndo(const FailureSetting& setting) {
  FailureResult result{.id = 35,
                       .name = "undo",
                       .metric = "ways to the same two passes that leave another bone",
                       .unit = "1",
                       .baseline_name = "the state is not restored",
                       .bound = 0.0};
  const int frames = setting.full() ? 1000 : 200;
  const simulation::Bone block = MakeBlock({.low_m = {-7e-3, -6e-3, -4e-3},
                                            .high_m = {8e-3, 6e-3, 0.0},
                                            .ball_radius_m = setting.full() ? 0.4e-3 : 0.6e-3,
                                            .point_spacing_m = setting.full() ? 0.25e-3 : 0.4e-3,
                                            .specific_cutting_energy_J_per_m3 = setting.full() ? 30e6 : 3e6});
  const simulation::Tool tool = MakeBallTool(kRadius_m);
  const auto make = [&] { return setting.make_engine(block, tool, Pose::Identity(), {}); };
  const auto plain = make();
  Ream(*plain, 0, frames);
  const simulation::CarvedState after_first = plain->Snapshot();
  Continue(*plain, after_first);
  Ream(*plain, 1, frames);
  const std::uint64_t hash = HashState(plain->Snapshot());
  bool complete = setting.GoesOn(0.3);

  // Returns how many of the two other sequences leave a different bone. @param restores  undoing a pass
  // restores the bone
  const auto count_different = [&](bool restores) {
    int different = 0;
    const auto undone = make();
    Ream(*undone, 0, frames);
    const simulation::CarvedState saved = undone->Snapshot();
    Continue(*undone, saved);
    Ream(*undone, 2, frames);
    if (restores) Continue(*undone, saved);
    Ream(*undone, 1, frames);
    different += HashState(undone->Snapshot()) == hash ? 0 : 1;
    const auto resumed = make();
    if (restores) Continue(*resumed, saved);
    Ream(*resumed, 1, frames);
    different += HashState(resumed->Snapshot()) == hash ? 0 : 1;
    return different;
  };
  result.baseline = count_different(false);
  complete = setting.GoesOn(0.7) && complete;
  result.ours = count_different(true);
  result.baseline_fails = result.baseline > 0.0;
  result.ours_passes = result.ours <= result.bound && complete;
  result.note =
      fmt::format("Undo and again; saved, and resumed by another engine. The bone's hash is {:016x}.", hash);
  result.plot = {
      .x_label = "1: undo and again, 2: resumed",
      .y_label = "another bone, up to there",
      .series = {{.name = "not restored", .x = {0.0, 1.0, 2.0}, .y = {0.0, 1.0, result.baseline}},
                 {.name = "restored", .x = {0.0, 1.0, 2.0}, .y = {0.0, 0.0, result.ours}, .ours = true}},
      .bound_is_on_y = true};
  return result;
}

}  // namespace osteon::studies
