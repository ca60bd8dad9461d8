#include "session/planning/plan_scene.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "base/interrupt.h"
#include "base/realtime_thread.h"
#include "base/text.h"
#include "session/planning/pack_source.h"
#include "session/planning/run_queue_watch.h"
#include "simulation/fidelity/frame_workload.h"
#include "simulation/packing/mass_points.h"
#include "simulation/removal/cut_metrics.h"

namespace osteon::session {
namespace {

// Engines are timed in turns of kTurn frames. The first kSettle frames of a turn are not counted, because on
// an H100 a frame takes 100 us longer directly after a frame of another engine.
constexpr std::size_t kTurn = 25, kSettle = 3;
constexpr double kFeed_m_per_s = 5e-3;  // assumed feed speed of a cutting tool

bool IsMesh(const std::string& input) {
  const std::string extension = base::Lower(std::filesystem::path(input).extension().string());
  return extension == ".stl" || extension == ".obj" || extension == ".ply";
}

/// Returns the scene that is cut, or whose solid the mesh replaces.
std::string SceneOf(const PlanChoice& choice) {
  if (!IsMesh(choice.scene)) return choice.scene;
  return choice.mesh_scene.empty() ? "acetabulum" : choice.mesh_scene;
}

/// Returns the chosen cell's file, else the file of the cell with the scene's name if there is one, else the
/// demo cell's file.
std::filesystem::path CellOf(const PlanChoice& choice) {
  if (!choice.cell.empty()) return choice.cell;
  const std::filesystem::path own =
      choice.config_root / "cells" / (std::filesystem::path(SceneOf(choice)).stem().string() + ".yaml");
  return std::filesystem::is_regular_file(own) ? own : choice.config_root / "cells" / "demo.yaml";
}

/// Returns the figures of the simulated arm that determine the error of the tool's pose.
simulation::ArmFigures ArmOf(const config::CellConfig& cell) {
  const hil::SimulatedCellParams& simulated = cell.simulated;
  simulation::ArmFigures arm{
      .bandwidth_hz = simulated.servo.bandwidth_hz,
      .damping_ratio = simulated.servo.damping_ratio,
      .dead_time_s = simulated.servo.dead_cycles * cell.servo.period_s,
      .stiffness_N_per_m = simulated.dynamic.mount ? simulated.dynamic.mount->stiffness_N_per_m : 0.0,
      .feed_m_per_s = kFeed_m_per_s};
  arm.force_N = std::visit([](const auto& script) { return script.push_force_N; }, cell.script);
  return arm;
}

}  // namespace

PlanScene MakePlanScene(const simulation::SceneSolid& solid, const simulation::SceneParams& scene,
                        const config::CellConfig& cell, const std::string& cell_name) {
  PlanScene made;
  made.name = solid.name;
  made.cell_name = cell_name;
  made.work = simulation::MakeSceneWorkload(solid, scene, cell.tool.tool, cell.cutting);
  made.materials = made.work.materials;
  made.points = simulation::BuildMassPoints(*solid.solid, *made.work.zone, scene.points);
  made.cut = simulation::ShapeOfCut(made.work, scene);
  made.zone_depth_m = simulation::ZoneDepthFor(made.cut, scene.zone.radius_m);
  made.arm = ArmOf(cell);
  made.max_turn_rad_per_s = cell.servo.twist.max_turn_rad_per_s;
  made.gives_way = config::CompliancePartsOf(cell);
  return made;
}

tl::expected<PlanScene, std::string> LoadPlanScene(const PlanChoice& choice) {
  SourceOptions options;
  const bool is_mesh = IsMesh(choice.scene);
  if (is_mesh && !choice.site)
    return tl::make_unexpected(fmt::format(
        "{}: found a mesh without its site, accepted with --cup X,Y,Z,NX,NY,NZ,R (where it is cut)",
        choice.scene));
  options.input = choice.scene;
  options.scenes_only = !is_mesh;
  options.config_root = choice.config_root;
  options.scene = is_mesh ? SceneOf(choice) : choice.mesh_scene;
  options.cup = choice.site;
  options.scale = choice.scale;
  PackSource source;
  if (auto loaded = LoadPackSource(options))
    source = std::move(*loaded);
  else
    return tl::make_unexpected(loaded.error());
  if (!source.warning.empty()) fmt::print(stderr, "osteon plan: warning: {}\n", source.warning);
  const std::filesystem::path cell_file = CellOf(choice);
  const config::CellConfig cell = config::LoadCell(cell_file, choice.tool);
  config::RequireSimulation(cell, cell_file);
  source.own->materials = source.materials;
  return MakePlanScene({.name = source.name, .solid = source.solid, .site = source.site}, *source.own, cell,
                       cell_file.stem().string());
}

tl::expected<std::vector<LevelRun>, std::string> RunLevels(const PlanScene& scene,
                                                           const std::vector<PackedLevel>& levels,
                                                           const simulation::Tool& tool,
                                                           const EngineChoice& choice, int rounds) {
  rt::KeepCpusAwake();
  std::vector<LevelRun> runs(levels.size());
  for (int round = 0; round < rounds; ++round) {
    std::vector<std::unique_ptr<simulation::CuttingEngine>> engines;
    for (const PackedLevel& packed : levels) {
      simulation::Bone bone;
      bone.name = scene.name;
      bone.balls = packed.balls;
      bone.points = scene.points;
      bone.materials = scene.materials;
      auto made = MakeEngine(choice, bone, tool, Pose::Identity(),
                             simulation::CuttingForLevel(packed.level, scene.cut, scene.work.cutting));
      if (!made) return tl::make_unexpected(made.error());
      engines.push_back(std::move(*made));
    }
    RunQueueWatch watch;
    for (LevelRun& run : runs) run.felt.clear();
    for (std::size_t begin = 0; begin < scene.work.frames.size(); begin += kTurn) {
      if (base::Interrupted()) return tl::make_unexpected("ended by Ctrl-C");
      const std::size_t end = std::min(begin + kTurn, scene.work.frames.size());
      for (std::size_t i = 0; i < engines.size(); ++i) {
        // rotate the order of the engines from round to round
        const std::size_t which = (i + begin / kTurn) % engines.size();
        simulation::CuttingEngine& engine = *engines[which];
        LevelRun& run = runs[which];
        for (std::size_t k = begin; k < end; ++k) {
          simulation::ContactModel model;
          watch.Restart();
          const double us = simulation::TimedStep(engine, scene.work.frames[k], model);
          const double waited_us = watch.Waited_us();
          if (model.status != simulation::EngineStatus::kOk)
            return tl::make_unexpected("a frame was refused, or the device is lost");
          if (model.contact_count > 0 && k < scene.work.cut_end && k >= begin + kSettle)
            run.frames.push_back({.us = us,
                                  .active_balls = ActiveBalls(engine, levels[which].balls.size()),
                                  .waited_us = waited_us});
          if (k >= scene.work.feel_begin)
            run.felt.push_back({.f_N = Vector3(model.F_T_W.f), .t_Nm = Vector3(model.F_T_W.t)});
        }
      }
    }
    for (std::size_t i = 0; i < engines.size(); ++i) {
      runs[i].engine = engines[i]->name();
      runs[i].device = engines[i]->device();
      runs[i].left = simulation::LiveBalls(engines[i]->Snapshot());
    }
  }
  for (const LevelRun& run : runs)
    if (run.frames.empty()) return tl::make_unexpected("the tool did not touch the bone on the scene's way");
  return runs;
}

simulation::CutAccuracy MeasureLevel(const PlanScene& scene, const PackedLevel& packed, const LevelRun& run,
                                     double probe_m) {
  const simulation::SweptTool swept(scene.work.tool, scene.work.CutPath());
  return simulation::MeasureCut(*scene.work.solid, simulation::BallUnion(packed.balls),
                                simulation::BallUnion(run.left), swept,
                                {.probe_radii_m = {probe_m}, .surface_cells = 20'000, .probe_samples = 3000});
}

double BallsInReach(const PlanScene& scene, const std::vector<simulation::Ball>& balls) {
  constexpr std::size_t kPoses = 12;  // number of poses, evenly spaced along the cut
  const double reach_m = scene.work.cutting.normal_enlargement_m;
  double sum = 0.0;
  for (std::size_t i = 0; i < kPoses; ++i) {
    const Pose X_GT = scene.work.frames[(2 * i + 1) * scene.work.cut_end / (2 * kPoses)].X_WT;
    std::vector<Vector3> centers;
    for (const simulation::ToolBall& ball : scene.work.tool.balls)
      centers.emplace_back(X_GT * Vector3(ball.center_m));
    for (const simulation::Ball& ball : balls) {
      double gap_m = std::numeric_limits<double>::infinity();
      for (std::size_t t = 0; t < centers.size(); ++t)
        gap_m = std::min(gap_m, (Vector3(ball.center_m) - centers[t]).norm() -
                                    scene.work.tool.balls[t].radius_m - ball.radius_m);
      // a ball that lies wholly within the tool has been cut away and does not count
      if (gap_m < reach_m && gap_m > -2.0 * ball.radius_m) sum += 1.0;
    }
  }
  return sum / kPoses;
}

}  // namespace osteon::session
