#pragma once

#include <cstdint>

#include "io/engine/engine_setup.h"
#include "io/engine/messages.h"

// Sample messages between controller and simulation engine. Each field has a different value.

namespace osteon::io::test {

inline PlainPose SamplePose() {
  Pose X = Pose::Identity();
  X.linear() = ExpRotation(Vector3(0.1, -0.2, 0.3));
  X.translation() = Vector3(0.4, -0.5, 0.6);
  return X;
}

inline EngineCommand SampleCommand() {
  return {.command = {.X_WT = SamplePose(), .spindle_rad_per_s = -31.4, .stamp = 123'456'789}, .dt_s = 0.002};
}

/// A command with a tool pose and this time stamp.
inline simulation::ToolCommand CommandAt(rt::Nanoseconds stamp) {
  return {.X_WT = SamplePose(), .spindle_rad_per_s = 3.0, .stamp = stamp};
}

inline EngineFrame SampleFrame() {
  EngineFrame frame{.model = {}, .spindle_rad_per_s = 31.4, .duration_ns = 230'000};
  simulation::ContactModel& m = frame.model;
  m.X_WP = SamplePose();
  m.contact_count = 2;
  for (int i = 0; i < m.contact_count; ++i) {
    simulation::Contact& c = m.contacts[static_cast<std::size_t>(i)];
    const double d = 0.1 * (i + 1);
    c = {.p_TP_m = {d, 2 * d, 3 * d},
         .p_W_m = {-d, d, 0.5 * d},
         .n_W = {0.0, 0.6, 0.8},
         .gap_m = -1e-4 * d,
         .stiffness_N_per_m = 20e3 + d,
         .mu = 0.3 + 0.1 * d,
         .advance_m_per_s = 1e-3 * d,
         .weight = d,
         .material = static_cast<simulation::MaterialIndex>(i)};
  }
  m.n_W = {0.0, 0.0, 1.0};
  m.contact_fraction = 0.75;
  m.p_WS_m = {0.11, 0.12, 0.13};
  m.F_T_W.f = {1.0, -2.0, 3.0};
  m.F_T_W.t = {0.1, -0.2, 0.3};
  m.advance_m_per_s = 0.01;
  m.engaged_area_m2 = 2e-4;
  m.spindle_torque_Nm = 1.5;
  m.removed_volume_m3 = 3e-6;
  m.removed_mass_kg = 4e-3;
  m.cutting_work_J = 55.0;
  m.balls_not_split = 7;
  m.pose_stamp = 123'456'789;
  m.frame = 42;
  return frame;
}

/// A set-up with a small bone of one material and a tool of one ball.
inline EngineSetup SampleSetup() {
  EngineSetup setup;
  setup.bone.name = "block";
  setup.bone.materials = {{.name = "cortical", .edge_force_N_per_m = 21e3, .measured_chip_m = 48e-6}};
  for (int i = 0; i < 5; ++i) {
    const double x = 1e-3 * i;
    setup.bone.balls.push_back({.center_m = {x, 0.0, 0.0}, .radius_m = 1e-3});
    setup.bone.points.push_back({.p_m = {x, 1e-4, 0.0}, .volume_m3 = 1e-9, .material = 0});
  }
  setup.tool.name = "ball";
  setup.tool.balls = {{.center_m = {0.0, 0.0, -2e-3}, .radius_m = 2e-3, .cutting = true, .edges = 2}};
  setup.cutting.edge_force = true;
  setup.X_WG = SamplePose();
  return setup;
}

}  // namespace osteon::io::test
