#include "simulation/fidelity/frame_workload.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "base/percentile.h"
#include "simulation/packing/disjoint_packing.h"
#include "simulation/solids/cup_frame.h"
#include "simulation/tools/tool_kinds.h"

namespace osteon::simulation {
namespace {

constexpr double kAbove_m = 1e-3;               // height above first contact at which the hand starts
constexpr std::size_t kDisjointCount = 10'000;  // balls, unless another number is asked for

// The disjoint packing of the cutting paper: the largest ball that fits comes first, with the same radii near
// the cut and elsewhere.
std::vector<Ball> DisjointBalls(const Solid& solid, const CutZone& zone, std::size_t count) {
  return BuildDisjointPacking(solid, zone, {.count = count > 0 ? count : kDisjointCount});
}

// Height of the head's centre above the cup's, when the head (by radius) first meets the cup's rim or floor.
double MeetingHeight(double head_m, double cup_m) {
  return head_m > cup_m ? std::sqrt(head_m * head_m - cup_m * cup_m) : head_m - cup_m;
}

}  // namespace

FrameWorkloadParams CupWorkload() {
  FrameWorkloadParams params;
  params.scene.shape = AcetabulumShape{};
  params.scene.material_names = MaterialNames(params.scene.shape);
  params.scene.materials = DefaultBoneMaterials();
  params.scene.materials.resize(params.scene.material_names.size());
  params.tool = MakeReamer(ReamerParams{}).tool;
  return params;
}

FrameWorkload MakeFrameWorkload(const FrameWorkloadParams& params) {
  const SceneSolid scene = MakeSceneSolid(params.scene);
  const auto zone = MakeZone(params.scene.zone, scene.site, *scene.solid);
  FrameWorkload work;
  work.solid = scene.solid;
  work.tool = MakeShellTool(params.tool, params.tool_spheres, params.shell);
  work.cutting = params.cutting;
  work.bone.name = scene.name;
  work.bone.site = scene.site;
  work.bone.materials = params.scene.materials;
  if (params.disjoint)
    work.bone.balls = DisjointBalls(*scene.solid, *zone, params.spheres);
  else if (params.spheres > 0)
    work.bone.balls =
        BuildCountedPacking(*scene.solid, *zone, params.scene.packing, params.spheres, params.grade);
  else
    work.bone.balls = BuildPacking(*scene.solid, *zone, params.scene.packing);
  work.bone.points = BuildMassPoints(*scene.solid, *zone, params.scene.points);
  work.cutting_balls = static_cast<std::size_t>(std::count_if(work.tool.balls.begin(), work.tool.balls.end(),
                                                              [](const ToolBall& b) { return b.cutting; }));
  const std::vector<double>& levels = params.scene.packing.lattice.coarser_from_m;
  work.cut_zone_depth_m = levels.empty() ? scene.solid->Bounds().sizes().norm() : levels.front();
  work.cut_zone_m = MeanSpacing(work.bone, *zone, work.cut_zone_depth_m);
  if (params.motion) {
    work.motion.emplace(*params.motion, params.rate_hz);
    return work;
  }

  const ToolBall* head = CuttingHead(params.tool);
  if (head == nullptr)
    throw std::invalid_argument("workload: found a tool that cuts nothing, accepted one that does");
  const double above_m = MeetingHeight(head->radius_m, scene.site.radius_m) + kAbove_m;
  work.seat_m = above_m - std::min(0.0, head->radius_m - scene.site.radius_m);
  work.hand.force_N = params.force_N;
  work.hand.spindle_rad_per_s = params.spindle_rad_per_s;
  work.hand.dt_s = 1.0 / params.rate_hz;
  // T points against the cup's axis; the head's centre is on the cup's axis
  Pose X_CT = Pose::Identity();
  X_CT.linear() = Eigen::DiagonalMatrix<double, 3>(1, -1, -1);
  X_CT.translation() = Vector3(0, 0, above_m) - X_CT.linear() * Vector3(head->center_m);
  work.hand.X_WT = CupPose(scene.site) * X_CT;
  return work;
}

WorkloadPlayer::WorkloadPlayer(const FrameWorkload& workload) : workload_(&workload), hand_(workload.hand) {}

FrameInput WorkloadPlayer::Next(const ContactModel& last) {
  if (!workload_->motion) return hand_.Next(Vector3(last.F_T_W.f));
  return workload_->motion->Frame(std::min(frame_++, workload_->motion->frame_count() - 1));
}

bool WorkloadPlayer::Ready(const ContactModel& last) const {
  if (!workload_->motion) {
    const Pose X_WS = workload_->hand.X_WT, X_WP = last.X_WP;  // S: the hand's start
    return last.frame > 0 &&
           (X_WP.translation() - X_WS.translation()).dot(X_WS.linear().col(2)) >= workload_->seat_m;
  }
  return Vector3(last.F_T_W.f).squaredNorm() > 0.0;
}

bool WorkloadPlayer::AtEnd() const { return workload_->motion && frame_ >= workload_->motion->frame_count(); }

bool RunUntilReady(CuttingEngine& engine, WorkloadPlayer& player, ContactModel& last,
                   const std::function<bool()>& stop) {
  constexpr int kMaxFrames = 20'000;
  for (int k = 0; k < kMaxFrames && !player.Ready(last); ++k) {
    if (player.AtEnd() || (stop && stop())) return false;
    last = engine.Step(player.Next(last));
    if (last.status != EngineStatus::kOk) return false;
  }
  return player.Ready(last);
}

TimeFigures FiguresOf(std::vector<double> times_us) {
  if (times_us.empty()) return {};
  const auto at = [&](double share) { return base::Percentile(times_us, share); };
  return {.p50_us = at(0.5), .p95_us = at(0.95), .p99_us = at(0.99), .p999_us = at(0.999), .max_us = at(1.0)};
}

double TimedStep(CuttingEngine& engine, const FrameInput& input, ContactModel& model) {
  const auto start = std::chrono::steady_clock::now();
  model = engine.Step(input);
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace osteon::simulation
