#pragma once

#include <cmath>
#include <vector>

#include "procedure/plan/surgical_plan.h"
#include "simulation/bone/bone.h"
#include "simulation/bone/scenes.h"
#include "simulation/engine_cpu/cpu_engine.h"
#include "simulation/fidelity/recarve.h"
#include "simulation/tools/tool.h"

// For the tests of the assessment: the demo's cup, reamed by the shipped engine along exact poses.

namespace osteon::procedure {

/// The demo's cup of 48 mm, packed with this spacing.
inline simulation::Bone CupBone(double spacing_m = 1.5e-3) {
  simulation::AcetabulumParams params;
  params.packing.lattice.finest_m = spacing_m;
  return simulation::MakeAcetabulum(params);
}

/// The demo's plan: 50 mm at (0, 0, -2) mm along +z, radiographic 40/15.
inline SurgicalPlan DemoPlan() {
  SurgicalPlan plan;
  plan.pelvis = {.lateral = {0.682977826173, 0.384763454244, 0.620885153015},
                 .anterior = {0.284702682836, -0.923015213460, 0.258819045103},
                 .superior = {0.672670551862, 0.0, -0.739942111694}};
  plan.centre_m = {0.0, 0.0, -0.002};
  plan.cup_diameter_m = 0.052;
  plan.tools = {{0.044, -0.0015}, {0.046, -0.001}, {0.048, -0.0005}, {0.050, 0.0}};
  plan.guidance.cone.free_rad = 8.0 * M_PI / 180.0;
  plan.guidance.lateral = {.free_m = 1e-3, .stop_m = 3e-3, .widening_rad = 10.0 * M_PI / 180.0};
  return plan;
}

/// Pose of a tool whose head of this radius has its centre at `centre_m`, with this feed.
inline Pose PoseAt(const Vector3& centre_m, const Vector3& feed, double radius_m) {
  Pose X_GT = Pose::Identity();
  X_GT.linear() = RotationFromZTo(feed);
  X_GT.translation() = centre_m + radius_m * feed;
  return X_GT;
}

/// Reams with a head of this radius: straight along the feed to each centre in turn, from 30 mm before the
/// first one.
inline simulation::CarvedState Ream(const simulation::Bone& bone, double radius_m,
                                    const std::vector<Vector3>& centres_m,
                                    const Vector3& feed = -Vector3::UnitZ()) {
  // shaft of 8 mm radius and 120 mm length, 1 kg
  const simulation::Tool tool = simulation::MakeReamer(radius_m, 8e-3, 0.12, 1.0, {0.0, 0.0, -0.06});
  simulation::CpuEngine engine(bone, tool, Pose::Identity(), {.law = simulation::RemovalLaw::kImmediate});
  std::vector<PlainPose> places;
  for (int step = 30; step > 0; --step)
    places.push_back(PoseAt(centres_m.front() - 1e-3 * step * feed, feed, radius_m));
  for (const Vector3& centre_m : centres_m) places.push_back(PoseAt(centre_m, feed, radius_m));
  if (!simulation::CarveTrail(engine, places)) throw std::runtime_error("the engine refused a frame");
  return engine.Snapshot();
}

/// Centres on a circle about the axis, as a whirling tool takes them.
inline std::vector<Vector3> Whirl(const Vector3& centre_m, double radius_m, int count = 72) {
  std::vector<Vector3> centres_m{centre_m};
  for (int i = 0; i <= count; ++i) {
    const double angle = 2.0 * M_PI * i / count;
    centres_m.push_back(centre_m + radius_m * Vector3(std::cos(angle), std::sin(angle), 0.0));
  }
  return centres_m;
}

}  // namespace osteon::procedure
