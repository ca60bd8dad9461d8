#include "studies/validate/constant_feed.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "config/reading/load.h"
#include "control/compliance/compliant_link.h"
#include "simulation/bone/scenes.h"
#include "simulation/engine_cpu/cpu_engine.h"

namespace osteon::studies {
namespace {

constexpr double kPeriod_s = 1e-3;        // of the engine's steps
constexpr double kMachine_N_per_m = 1e6;  // stiffness of the machine
constexpr double kNoBound_N = 1e5;        // a force limit that no drill reaches
constexpr double kClear_m = 0.2e-3;       // distance between tip and surface at the start

// Throws std::invalid_argument unless there is at least one step, every feed is positive, and the depths rise
// and stay within the block.
void ValidateSteps(const ConstantFeedParams& params) {
  double depth_m = 0.0;
  for (const FeedStep& step : params.steps) {
    if (!(step.feed_m_per_s > 0.0) || !(step.depth_m > depth_m) || step.depth_m >= kFeedBlock_m)
      throw std::invalid_argument(
          fmt::format("constant feed: found {:g} mm/s to a depth of {:g} mm, accepted a feed above 0 and a "
                      "depth beyond the last one's, {:g} mm, and below the block's, {:g} mm",
                      1e3 * step.feed_m_per_s, 1e3 * step.depth_m, 1e3 * depth_m, 1e3 * kFeedBlock_m));
    depth_m = step.depth_m;
  }
  if (params.steps.empty())
    throw std::invalid_argument("constant feed: found no step, accepted one at least");
}

// A block of the material around the drill's path. It is packed like the shipped plate.
simulation::Bone MakeFeedBlock(const ConstantFeedParams& params) {
  simulation::SceneParams scene = config::LoadScene(params.config_root / "scenes" / "thin_plate.yaml");
  const double width_m = 3.0 * params.diameter_m;
  scene.shape = simulation::BlockShape{
      .width_m = width_m, .depth_m = width_m, .height_m = kFeedBlock_m, .layers = {}, .core = 0};
  scene.site.radius_m = 0.5 * params.diameter_m;
  scene.zone.radius_m = 0.5 * params.diameter_m;
  scene.zone.path_C_m = {Vector3(0, 0, 0.003), Vector3(0, 0, -kFeedBlock_m)};
  scene.material_names = {params.material.name};
  scene.materials = {params.material};
  scene.packing.lattice.finest_m *= params.packing_scale;
  scene.packing.surface_gap_m *= params.packing_scale;
  scene.packing.max_surface_gap_m *= params.packing_scale;
  scene.packing.samples.finest_m *= params.packing_scale;
  scene.points.cells.finest_m *= params.packing_scale;
  return simulation::PackScene(simulation::MakeSceneSolid(scene), scene);
}

// Sums over the frames in the second half of the last section. way_m: distance that the drill is fed.
struct Sums {
  double thrust_N{0.0}, torque_Nm{0.0}, way_m{0.0}, removed_m3{0.0}, work_J{0.0}, bend_m{0.0};
  int frames{0};
};

// A drill that may bend. T is the frame of the chuck, E the frame of the drill's point. E is displaced by the
// wrench on the point, with a time constant. Without bending, E equals T.
class BentPoint {
 public:
  BentPoint(const config::ToolConfig& drill, bool bends) {
    if (!bends) return;
    if (!drill.bending) throw std::invalid_argument("constant feed: found a drill without `bending`");
    compliance_T_ = drill.bending->compliance.C_T;
    // rule 1 for a cell's compliance: T K c / tau is at most a half, with the period T, the machine's
    // stiffness K, the drill's compliance c and the time constant tau
    const double softest_m_per_N = compliance_T_.diagonal().head<3>().maxCoeff();
    tau_s_ = std::max(drill.bending->relaxation_s, 2.0 * kPeriod_s * kMachine_N_per_m * softest_m_per_N);
  }

  [[nodiscard]] Pose X_WE(const Pose& X_WT) const { return X_WT * control::BentHead(e_); }
  [[nodiscard]] double bend_m() const { return e_.head<3>().norm(); }

  void Step(const Wrench& F_E_W, const Pose& X_WE) {
    if (tau_s_ <= 0.0) return;
    const Matrix3 R_EW = X_WE.linear().transpose();
    control::Vector6 F_E;
    F_E << R_EW * F_E_W.f, R_EW * F_E_W.t;
    e_ = control::StepMassless<6>(e_, compliance_T_ * F_E, kPeriod_s, tau_s_);
  }

 private:
  control::Matrix6 compliance_T_{control::Matrix6::Zero()};
  double tau_s_{0.0};
  // displacement and rotation of the drill's point (frame E) relative to T
  control::Vector6 e_{control::Vector6::Zero()};
};

}  // namespace

ConstantFeedResult DrillAtConstantFeed(const ConstantFeedParams& params) {
  ValidateSteps(params);
  const config::ToolConfig drill =
      config::LoadTool(params.config_root / "tools" / "twist_drill.yaml", params.diameter_m);
  const simulation::Bone block = MakeFeedBlock(params);
  simulation::CuttingParams cutting;
  cutting.stiffness_N_per_m = kMachine_N_per_m;
  cutting.max_force_N = kNoBound_N;
  cutting.engaged_layer_m = 0.25e-3;  // as in the drilling cells
  cutting.edge_force = params.edge_force;
  simulation::CpuEngine engine(block, drill.tool, Pose::Identity(), cutting);

  Pose X_WT = Pose::Identity();
  X_WT.linear() = Vector3(1, -1, -1).asDiagonal();
  BentPoint point(drill, params.bends);
  double depth_m = -kClear_m, last_depth_m = -kClear_m;
  Sums sums;
  for (const FeedStep& step : params.steps) {
    const bool is_last = &step == &params.steps.back();
    const double sums_from_m = 0.5 * (std::max(last_depth_m, 0.0) + step.depth_m);
    double removed_m3 = 0.0;
    while (depth_m < step.depth_m) {
      depth_m += step.feed_m_per_s * kPeriod_s;
      X_WT.translation() = Vector3(0, 0, -depth_m);
      const Pose X_WE = point.X_WE(X_WT);
      const simulation::ContactModel model =
          engine.Step({.X_WT = X_WE, .spindle_rad_per_s = params.spindle_rad_per_s, .dt_s = kPeriod_s});
      point.Step(Wrench(model.F_T_W), X_WE);
      if (is_last && depth_m >= sums_from_m) {
        const double thrust_N = Vector3(Wrench(model.F_T_W).f).z();
        sums.thrust_N += thrust_N;
        sums.torque_Nm += model.spindle_torque_Nm;
        sums.way_m += step.feed_m_per_s * kPeriod_s;
        sums.work_J +=
            (model.spindle_torque_Nm * params.spindle_rad_per_s + thrust_N * step.feed_m_per_s) * kPeriod_s;
        sums.bend_m += point.bend_m();
        sums.removed_m3 += model.removed_volume_m3 - removed_m3;
        ++sums.frames;
      }
      removed_m3 = model.removed_volume_m3;
    }
    last_depth_m = step.depth_m;
  }
  const double section_m2 = 0.25 * std::numbers::pi * params.diameter_m * params.diameter_m;
  return {.thrust_N = sums.thrust_N / sums.frames,
          .torque_Nm = sums.torque_Nm / sums.frames,
          .energy_J_per_m3 = sums.removed_m3 > 0.0 ? sums.work_J / sums.removed_m3 : 0.0,
          .bend_m = sums.bend_m / sums.frames,
          .removed_share = sums.removed_m3 / (section_m2 * sums.way_m)};
}

}  // namespace osteon::studies
