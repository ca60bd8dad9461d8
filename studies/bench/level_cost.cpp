#include "studies/bench/level_cost.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "base/interrupt.h"
#include "config/reading/check_plan_in_cell.h"
#include "config/reading/load_surgical_plan.h"
#include "config/reading/sections/compliance_params.h"
#include "session/procedure/plan_guidance.h"

namespace osteon::studies {
namespace {

constexpr double kMountBelow_m = 0.08;  // the mount's distance below the cup

// Times the benches in turn; names[i] is that of benches[i].
std::vector<LevelCost> TimeNamed(std::span<TickBench> benches, const std::vector<std::string>& names,
                                 std::size_t ticks) {
  const std::vector<TickTimes> times = TimeInTurn(benches, ticks);
  std::vector<LevelCost> costs;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (times[i].tick.size() < ticks && !base::Interrupted())
      throw std::runtime_error(
          fmt::format("{}: {}", names[i], TooFewText(times[i].tick.size(), ticks, benches[i])));
    costs.push_back({.name = names[i],
                     .tick = simulation::FiguresOf(times[i].tick),
                     .loop = simulation::FiguresOf(times[i].stages[2]),  // TickTimes::kStages
                     .allocations = times[i].allocations,
                     .force_N = times[i].force_N,
                     .guided = times[i].guided,
                     .realtime = times[i].realtime});
  }
  return costs;
}

}  // namespace

std::vector<NamedLevels> LevelsOf(const config::CellConfig& cell) {
  if (!cell.tool.bending)
    throw std::invalid_argument("the cell's tool: found none that bends, accepted one with `bending`");
  control::ComplianceParams all;
  all.tool = config::ToolLinkOf(cell.tool.bending->compliance, cell.tool.bending->relaxation_s,
                                cell.compliance.push_N);
  all.layer = config::SurfaceLayerOf(cell.scene.materials, cell.tool.tool, cell.cutting.engaged_layer_m);
  if (!config::HasLayer(*all.layer))
    throw std::invalid_argument("the cell's scene: found no soft tissue, accepted one with layer_N_per_mm3");
  all.mount = control::BoneMountParams{.p_WMo_m = cell.X_WG * Vector3(0.0, 0.0, -kMountBelow_m)};
  return {{"off", {}},
          {"tool", {.tool = all.tool}},
          {"layer", {.layer = all.layer}},
          {"mount", {.mount = all.mount}},
          {"all", all}};
}

std::vector<LevelCost> TimeLevels(const std::filesystem::path& config_root, std::size_t ticks) {
  const config::CellConfig demo = BenchCell(config_root);
  const std::vector<NamedLevels> levels = LevelsOf(demo);
  std::vector<TickBench> benches;
  std::vector<std::string> names;
  for (const NamedLevels& level : levels) {
    config::CellConfig cell = demo;
    cell.servo.compliance = level.params;
    benches.emplace_back(cell, ScriptSeconds(cell, ticks));
    names.push_back(level.name);
  }
  return TimeNamed(benches, names, ticks);
}

std::vector<LevelCost> TimeGuidance(const std::filesystem::path& config_root,
                                    const std::filesystem::path& plan, std::size_t ticks) {
  const config::CellConfig cell = BenchCell(config_root);
  const config::SurgicalPlanConfig loaded = config::LoadSurgicalPlan(plan);
  auto guidance = session::GuidanceOf(loaded.plan, cell.tool.tool, config::BoneInWorld(cell, loaded.site));
  if (!guidance) throw std::invalid_argument(plan.string() + ": found no guidance, accepted a plan with it");
  const double seconds = ScriptSeconds(cell, ticks);
  std::vector<TickBench> benches;
  benches.emplace_back(cell, seconds);
  const double gain = guidance->gain;
  guidance->gain = 0.0;
  benches.emplace_back(cell, seconds, guidance);
  guidance->gain = gain;
  benches.emplace_back(cell, seconds, guidance);
  return TimeNamed(benches, {"none", "gain 0", "guided"}, ticks);
}

double AddedMedian_us(const LevelCost& level, const LevelCost& off) {
  return level.loop.p50_us - off.loop.p50_us;
}

std::string TooFewText(std::size_t pressed, std::size_t ticks, const TickBench& bench) {
  return fmt::format("the tool pressed in {} ticks of {}{}", pressed, ticks,
                     bench.faults().Any() ? ", then the loop stopped itself" : "");
}

}  // namespace osteon::studies
