#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "session/planning/plan.h"

// Plans twelve requests, carries out the plans and measures the results, as `osteon plan --check` does for
// one plan. Prints CSV:
//
//     osteon_plan_table [DEVICE] > results/plan.csv
//
// With --kinds, times graded balls and split balls in turn for the same requests. A plan's choice between the
// two kinds is based on these times:
//
//     osteon_plan_table --kinds [DEVICE] > results/packing_kinds.csv

namespace osteon::app {
namespace {

// A request to `osteon plan`.
struct Row {
  const char* scene;
  double error_mm, rate_hz;
};

constexpr Row kRows[] = {
    {"acetabulum", 0.2, 1000},    {"acetabulum", 0.1, 1000},   {"acetabulum", 0.05, 500},
    {"molar", 0.03, 1000},        {"molar", 0.015, 1000},      {"molar", 0.1, 50'000},
    {"thin_plate", 0.1, 500},     {"thin_plate", 0.04, 500},   {"sawbone_block", 0.08, 500},
    {"sawbone_block", 0.03, 500}, {"femoral_canal", 0.2, 500}, {"femoral_canal", 0.06, 500}};

// Loads a request's scene from a path relative to OSTEON_ROOT or to the current folder.
session::PlanScene Load(const Row& row) {
  const char* root = std::getenv("OSTEON_ROOT");
  auto scene = session::LoadPlanScene(
      {.scene = row.scene, .cell = {}, .config_root = std::filesystem::path(root ? root : ".") / "config"});
  if (!scene) throw std::runtime_error(scene.error());
  return std::move(*scene);
}

// Times graded and split spheres in turn for each request. Returns the exit code 0.
int CompareKinds(const session::EngineChoice& engine) {
  std::printf("scene,error_mm,packing,zone_spacing_mm,spheres,active_spheres,frame_us,frames\n");
  for (const Row& row : kRows) {
    const session::PlanScene scene = Load(row);
    const session::ModelChoice model = session::ChooseModel(scene, 1e-3 * row.error_mm);
    std::vector<session::PackedLevel> levels;
    for (const auto kind : {simulation::PackingKind::kGraded, simulation::PackingKind::kSplit}) {
      const auto level = simulation::CoarsestLevel(
          kind, session::RemovalShare(1e-3 * row.error_mm, model.tool_gap_m), scene.cut, scene.zone_depth_m);
      if (!level) continue;
      levels.push_back({.level = *level, .balls = PackLevel(*level, *scene.work.solid, *scene.work.zone)});
    }
    const auto runs = session::RunLevels(scene, levels, model.tool, engine, 1);
    if (!runs) throw std::runtime_error(runs.error());
    for (std::size_t i = 0; i < levels.size(); ++i) {
      const simulation::FrameGroup frames = simulation::GroupOf((*runs)[i].frames);
      std::printf("%s,%g,%s,%.4f,%zu,%.0f,%.1f,%zu\n", row.scene, row.error_mm,
                  std::string(simulation::KindName(levels[i].level.kind)).c_str(),
                  levels[i].level.fine.spacing_m * 1e3, levels[i].balls.size(), frames.active_balls,
                  frames.p50_us, frames.frames);
    }
    std::fflush(stdout);
  }
  return 0;
}

// Plans and checks each request. Returns the exit code: 1 if a result misses its plan's prediction.
int PlanAll(const session::EngineChoice& engine) {
  std::printf(
      "scene,error_mm,rate_hz,packing,spheres,tool_spheres,arm_level,predicted_error_mm,measured_error_mm,"
      "standard_error_mm,predicted_frame_us,frame_us_by_others_in_turn,measured_frame_us,frame_us_p999,"
      "frames,frames_interrupted,given_up,missed\n");
  int missed = 0;
  for (const Row& row : kRows) {
    const session::PlanScene scene = Load(row);
    const session::PlanRequest request{
        .error_m = 1e-3 * row.error_mm, .rate_hz = row.rate_hz, .engine = engine};
    const auto plan = session::MakePlan(scene, request);
    if (!plan) throw std::runtime_error(plan.error());
    const auto check = session::CheckPlan(scene, request, *plan);
    if (!check) throw std::runtime_error(check.error());
    std::string given;
    for (const session::UnmetDemand& each : plan->unmet) given += (given.empty() ? "" : " ") + each.what;
    std::printf("%s,%g,%g,%s,%zu,%zu,%s,%.4f,%.4f,%.4f,%.1f,%.1f,%.1f,%.1f,%zu,%zu,%s,%zu\n", row.scene,
                row.error_mm, row.rate_hz, std::string(simulation::KindName(plan->packed.level.kind)).c_str(),
                plan->packed.balls.size(), plan->tool.balls.size(),
                std::string(simulation::ArmFidelityName(plan->arm)).c_str(), plan->error_m * 1e3,
                check->error_m * 1e3, check->standard_error_m * 1e3, plan->frame_us, check->same_time_us,
                check->frames.p50_us, check->frames.p999_us, check->frames.frames, check->frames.interrupted,
                given.empty() ? "nothing" : given.c_str(), check->missed.size());
    std::fflush(stdout);
    if (!check->missed.empty()) ++missed;
  }
  return missed > 0 ? 1 : 0;
}

}  // namespace
}  // namespace osteon::app

int main(int argc, char** argv) {
  try {
    const bool kinds = argc > 1 && std::string(argv[1]) == "--kinds";
    const auto engine = osteon::session::ChooseEngine("auto", argc > 1 + kinds ? argv[1 + kinds] : "");
    return kinds ? osteon::app::CompareKinds(engine) : osteon::app::PlanAll(engine);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "osteon_plan_table: %s\n", error.what());
    return 1;
  }
}
