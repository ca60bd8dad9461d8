#pragma once

#include <cmath>

#include "simulation/bone/bone.h"
#include "simulation/contact/contact_model.h"
#include "simulation/tools/tool.h"

// A strip of bone and a tool ball that moves along it. This is the smallest scene in which every pass of the
// engine has work.

namespace osteon::gpu {

/// Pose of a tool at p whose axis points down.
inline Pose Down(const Vector3& p) {
  Pose X = Pose::Identity();
  X.linear() = ExpRotation({M_PI, 0, 0});
  X.translation() = p;
  return X;
}

/// A tool of one cutting ball. The ball's surface touches the tool's origin (its apex).
inline simulation::Tool Ball(double radius_m) {
  simulation::Tool tool;
  tool.balls = {{.center_m = Vector3(0, 0, -radius_m), .radius_m = radius_m, .cutting = true}};
  return tool;
}

/// A strip of balls of 1 mm radius, 0.8 mm apart, with their tops at z = 0. Each ball has a mass point at its
/// centre.
inline simulation::Bone Strip(int count) {
  simulation::Bone bone;
  bone.materials = {{.name = "soft", .specific_cutting_energy_J_per_m3 = 1e6}};
  for (int i = 0; i < count; ++i) {
    const Vector3 c(0.8e-3 * (i - 0.5 * (count - 1)), 0, -1e-3);
    bone.balls.push_back({.center_m = c, .radius_m = 1e-3});
    bone.points.push_back({.p_m = c, .volume_m3 = 1e-9, .material = 0});
  }
  return bone;
}

/// Whether two models agree: the proxy within 10 um, and the force within 10 um at 20 N/mm. The tolerance is
/// needed because with single balls rounding decides which ball is met first.
inline bool HaveSameContact(const simulation::ContactModel& a, const simulation::ContactModel& b) {
  return b.status == simulation::EngineStatus::kOk &&
         (Vector3(a.X_WP.p) - Vector3(b.X_WP.p)).norm() <= 1e-5 &&
         (Vector3(a.F_T_W.f) - Vector3(b.F_T_W.f)).norm() <= 0.2;
}

/// Pose in frame i of a stroke of 150 frames along the strip. The tool is pressed 1 mm deep within 100
/// frames, then lifted.
inline Pose Stroke(int i) {
  return Down({1e-5 * i, 2e-6 * i, i < 100 ? 0.3e-3 - 1.3e-5 * i : -1e-3 + 3e-5 * (i - 100)});
}

}  // namespace osteon::gpu
