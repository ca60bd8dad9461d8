#include "app/start_path.h"

#include "control/check_path.h"

namespace osteon::app {
namespace {

// An arm of the LBR's size: what its links fill about their joints, roughly.
constexpr double kElbow_m = 0.09, kWrist_m = 0.08, kFlange_m = 0.065;
constexpr int kElbowJoint = 3, kWristJoint = 5;

}  // namespace

std::string WhyNotToStart(const CellSetup& setup, const kinematics::JointVector& q_from) {
  const config::CellConfig& cell = setup.config;
  const control::StartParams& start = *cell.servo.start;
  if ((q_from - start.q).cwiseAbs().maxCoeff() <= start.there_rad) return {};

  control::PathSurroundings around;
  around.X_WB = cell.X_WB;
  for (const simulation::ToolBall& ball : cell.tool.tool.balls)
    around.balls.push_back(
        {.name = "the tool", .center_m = cell.tool.X_FT * Vector3(ball.center_m), .radius_m = ball.radius_m});
  around.balls.push_back({.name = "the flange", .radius_m = kFlange_m});
  around.balls.push_back({.name = "the wrist", .link = kWristJoint, .radius_m = kWrist_m});
  around.balls.push_back({.name = "the elbow", .link = kElbowJoint, .radius_m = kElbow_m});
  const safety::WorkspaceParams& workspace = cell.servo.workspace;
  around.planes.push_back({.name = "the workspace's plane",
                           .normal_W = workspace.plane_normal_W,
                           .offset_m = workspace.plane_offset_m});
  for (const simulation::Ball& ball : setup.bone.balls)
    around.spheres.push_back({.center_W_m = setup.X_WG * Vector3(ball.center_m), .radius_m = ball.radius_m});
  around.position_margin_rad = cell.servo.joints.position_margin_rad;
  const auto found = control::CheckPath<7>(cell.chain, q_from, start.q, around);
  return found ? std::string() : "the way to the start: " + found.error();
}

}  // namespace osteon::app
