#include "studies/validate/cell_trial.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "base/clock.h"
#include "base/interrupt.h"
#include "base/work_folder.h"
#include "config/reading/load.h"
#include "config/reading/strict/overlay.h"
#include "procedure/assessment/cavity_result.h"
#include "session/planning/planned_cell.h"
#include "session/run/cell_run.h"
#include "session/setup/cell_setup.h"
#include "session/summary/each_fault.h"
#include "session/summary/summary.h"
#include "simulation/tools/tool.h"

namespace osteon::studies {
namespace {

// The hand presses in full if its force is at least this share of the script's push force.
constexpr double kFullShare = 0.95;

// Gives tissues of the scene the figures of materials in sawbone.yaml. A tissue keeps its name.
// @returns an error that names the missing material or tissue
tl::expected<void, std::string> ReplaceTissues(const std::filesystem::path& config_root,
                                               const std::vector<TissueFigures>& tissues,
                                               simulation::SceneParams& scene) {
  if (tissues.empty()) return {};
  const auto file = config_root / "materials" / "sawbone.yaml";
  const std::vector<simulation::Material> found = config::LoadMaterials(file);
  for (const TissueFigures& wanted : tissues) {
    const auto from = std::ranges::find(found, wanted.material, &simulation::Material::name);
    const auto to = std::ranges::find(scene.materials, wanted.tissue, &simulation::Material::name);
    if (from == found.end())
      return tl::make_unexpected(fmt::format("{}: no material {}", file.string(), wanted.material));
    if (to == scene.materials.end())
      return tl::make_unexpected(fmt::format("the scene has no tissue {}", wanted.tissue));
    *to = *from;
    to->name = wanted.tissue;
  }
  return {};
}

// Feed per turn, and difference between hand and rendered force, from the ticks in which the hand presses in
// full.
class PressFigures {
 public:
  explicit PressFigures(const session::CellSetup& setup)
      : axis_W_(setup.config.X_WG.linear().col(2)),
        push_N_(std::visit([](const auto& script) { return script.push_force_N; }, setup.config.script)),
        period_s_(setup.config.servo.period_s) {
    if (const simulation::ToolBall* head = simulation::CuttingHead(setup.config.tool.tool))
      p_T_head_ = head->center_m;
  }

  void Tick(const control::TickRecord& tick) {
    const Vector3 hand_N = Wrench(tick.F_operator_T_W).f, rendered_N = Wrench(tick.F_coupling_T_W).f;
    const double height_m = axis_W_.dot(Pose(tick.X_WT_cmd) * p_T_head_);
    const bool full = tick.phase == control::Phase::kHaptic && -axis_W_.dot(hand_N) >= kFullShare * push_N_ &&
                      rendered_N.norm() > 0.0;
    if (full && was_full_) {
      feed_m_ += last_height_m_ - height_m;
      turned_rad_ += std::abs(tick.input.spindle_meas_rad_per_s) * period_s_;
      difference_ += (hand_N + rendered_N).norm() / rendered_N.norm();
      ++ticks_;
    }
    was_full_ = full;
    last_height_m_ = height_m;
  }

  void Fill(CellTrial& trial) const {
    trial.pressed_s = static_cast<double>(ticks_) * period_s_;
    if (ticks_ == 0) return;
    trial.force_difference = difference_ / static_cast<double>(ticks_);
    if (turned_rad_ > 0.0) trial.feed_per_turn_m = feed_m_ / turned_rad_ * 2.0 * std::numbers::pi;
  }

 private:
  Vector3 axis_W_, p_T_head_{Vector3::Zero()};
  double push_N_, period_s_;
  bool was_full_{false};
  double last_height_m_{0.0};
  // sums over the ticks in which the hand presses in full
  double feed_m_{0.0}, turned_rad_{0.0}, difference_{0.0};
  std::int64_t ticks_{0};  // number of these ticks
};

// Fits a sphere to the balls that were cut, and compares it with the planned cup. If the fit fails,
// fit_refused says why.
void FitCavity(const session::CellSetup& setup, const simulation::CarvedState& after, CellTrial& trial) {
  const simulation::ToolBall* head = simulation::CuttingHead(setup.config.tool.tool);
  if (head == nullptr || setup.config.scene.zone.kind != simulation::ZoneParams::Kind::kCup) {
    trial.fit_refused = "the scene has no cup";
    return;
  }
  const simulation::CutSite& site = setup.bone.site;
  const auto fit =
      procedure::FitSphere(procedure::CutBalls(setup.bone, after), site.axis, site.center_m, head->radius_m);
  if (!fit) {
    trial.fit_refused = fit.error();
    return;
  }
  trial.fit = *fit;
  trial.seated_m = Vector3(site.axis).dot(Vector3(site.center_m) - fit->centre_m);
  trial.centre_shift_m = (fit->centre_m - Vector3(site.center_m)).norm();
}

// Prepares and packs the cell with the overrides and tissues of the trial.
tl::expected<session::CellSetup, std::string> SetUp(const std::filesystem::path& config_root,
                                                    const CellTrialParams& params) {
  const std::filesystem::path cell = config_root / "cells" / (params.cell + ".yaml");
  config::Overlay overlay(cell);
  for (const std::string& assignment : params.set) overlay.Set(assignment, "osteon validate");
  auto setup = session::PrepareCell(cell, std::nullopt);
  overlay.Finish();
  if (!setup) return setup;
  if (auto replaced = ReplaceTissues(config_root, params.tissues, setup->config.scene); !replaced)
    return tl::make_unexpected(replaced.error());
  // Pack with closed forms only, because their results are the same on every machine.
  if (const auto packed = session::PackCell(
          *setup, {.as_packed = params.as_packed, .error_m = params.error_m, .rate_hz = {}}, {}, false);
      !packed)
    return tl::make_unexpected(packed.error());
  return setup;
}

}  // namespace

std::string CellTrialParams::Key() const {
  std::string key = fmt::format("{} {} s packed {}", cell, seconds, as_packed ? -1.0 : error_m.value_or(0.0));
  for (const std::string& assignment : set) key += " " + assignment;
  for (const TissueFigures& tissue : tissues) key += fmt::format(" {}:{}", tissue.tissue, tissue.material);
  return key;
}

tl::expected<CellTrial, std::string> RunCellTrial(const std::filesystem::path& config_root,
                                                  const CellTrialParams& params) {
  const double begun_s = rt::ToSeconds(rt::MonotonicNow());
  auto setup = SetUp(config_root, params);
  if (!setup) return tl::make_unexpected(setup.error());
  const auto engine = session::MakeEngine(*setup, {.engine = "cpu"});
  if (!engine) return tl::make_unexpected(engine.error());
  const base::WorkFolder folder("validate");
  if (folder.path().empty())
    return tl::make_unexpected(std::filesystem::temp_directory_path().string() +
                               ": cannot make a temporary folder");
  PressFigures press(*setup);
  const auto run = session::RunCell(*setup, **engine,
                                    {.seconds = params.seconds,
                                     .virtual_time = true,
                                     .at_rest_s = 0.0,
                                     .recording = folder.path() / "recording.mcap",
                                     .stop = &base::Interrupted(),
                                     .ticked = [&](const control::TickRecord& record,
                                                   const simulation::ContactModel&) { press.Tick(record); }});
  if (!run) return tl::make_unexpected(run.error().what);
  CellTrial trial;
  trial.ended =
      std::string(session::EndText(run->end)) + (run->diagnosis.empty() ? "" : ": " + run->diagnosis);
  session::ForEachFault(run->faults, [&](safety::Fault, const safety::FaultText& text) {
    trial.faults.emplace_back(text.name);
  });
  trial.removed_m3 = run->after.removed_volume_m3;
  trial.peak_hand_N = run->statistics.peak_sensor_force_N;
  trial.peak_rendered_N = run->statistics.peak_coupling_force_N;
  press.Fill(trial);
  FitCavity(*setup, run->after, trial);
  trial.seconds_wall = rt::ToSeconds(rt::MonotonicNow()) - begun_s;
  return trial;
}

}  // namespace osteon::studies
