#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "app/plan.h"

// Twelve requests planned, carried out and measured, as `osteon plan --check` does one of them. CSV on
// standard output:
//
//     osteon_plan_table [DEVICE] > results/plan.csv

namespace osteon::app {
namespace {

struct Row {
  const char* scene;
  double error_mm, rate_hz;
};

constexpr Row kRows[] = {
    {"acetabulum", 0.2, 1000},    {"acetabulum", 0.1, 1000},   {"acetabulum", 0.05, 500},
    {"molar", 0.03, 1000},        {"molar", 0.015, 1000},      {"molar", 0.1, 50'000},
    {"thin_plate", 0.1, 500},     {"thin_plate", 0.04, 500},   {"sawbone_block", 0.08, 500},
    {"sawbone_block", 0.03, 500}, {"femoral_canal", 0.2, 500}, {"femoral_canal", 0.06, 500}};

int Main(const std::string& device) {
  const char* root = std::getenv("OSTEON_ROOT");
  const std::filesystem::path config_root = std::filesystem::path(root ? root : ".") / "config";
  std::printf(
      "scene,error_mm,rate_hz,packing,spheres,tool_spheres,arm_level,predicted_error_mm,measured_error_mm,"
      "standard_error_mm,predicted_frame_us,frame_us_by_others_in_turn,measured_frame_us,frame_us_p999,"
      "frames,"
      "frames_interrupted,given_up,missed\n");
  int missed = 0;
  for (const Row& row : kRows) {
    const auto scene = LoadPlanScene({.scene = row.scene, .cell = {}, .config_root = config_root});
    if (!scene) throw std::runtime_error(scene.error());
    const PlanRequest request{.error_m = 1e-3 * row.error_mm, .rate_hz = row.rate_hz, .device = device};
    const auto plan = MakePlan(*scene, request);
    if (!plan) throw std::runtime_error(plan.error());
    const auto check = CheckPlan(*scene, request, *plan);
    if (!check) throw std::runtime_error(check.error());
    std::string given;
    for (const GivenUp& each : plan->given_up) given += (given.empty() ? "" : " ") + each.what;
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
    return osteon::app::Main(argc > 1 ? argv[1] : "");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "osteon_plan_table: %s\n", error.what());
    return 1;
  }
}
