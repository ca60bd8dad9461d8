#include "session/run/start_path.h"

#include "control/setup/check_path.h"

namespace osteon::session {
namespace {

// Approximate radii of balls that represent an arm's elbow, wrist and flange, and the joints at which elbow
// and wrist lie.
struct ArmShape {
  double elbow_m, wrist_m, flange_m;
  int elbow_joint, wrist_joint;
};
constexpr ArmShape kLbr{
    .elbow_m = 0.09, .wrist_m = 0.08, .flange_m = 0.065, .elbow_joint = 3, .wrist_joint = 5};
constexpr ArmShape kSixAxis{
    .elbow_m = 0.15, .wrist_m = 0.11, .flange_m = 0.065, .elbow_joint = 2, .wrist_joint = 4};

}  // namespace

std::string ValidateStartPath(const CellSetup& setup, const kinematics::JointVector& q_from) {
  const control::StartParams& start = *setup.config.servo.start;
  if ((q_from - start.q).cwiseAbs().maxCoeff() <= start.tolerance_rad) return {};
  const std::string blocked = ValidatePath(setup, q_from, start.q);
  return blocked.empty() ? blocked : "the way to the start: " + blocked;
}

std::string ValidatePath(const CellSetup& setup, const kinematics::JointVector& q_from,
                         const kinematics::JointVector& q_to) {
  const config::CellConfig& cell = setup.config;
  const config::SixAxisConfig* six_axis = cell.robot.six_axis();
  const ArmShape& shape = six_axis ? kSixAxis : kLbr;
  control::PathSurroundings around;
  around.X_WB = cell.X_WB;
  for (const simulation::ToolBall& ball : cell.tool.tool.balls)
    around.balls.push_back(
        {.name = "the tool", .center_m = cell.tool.X_FT * Vector3(ball.center_m), .radius_m = ball.radius_m});
  around.balls.push_back({.name = "the flange", .radius_m = shape.flange_m});
  around.balls.push_back({.name = "the wrist", .link = shape.wrist_joint, .radius_m = shape.wrist_m});
  around.balls.push_back({.name = "the elbow", .link = shape.elbow_joint, .radius_m = shape.elbow_m});
  const safety::WorkspaceParams& workspace = cell.servo.workspace;
  around.planes.push_back({.name = "the workspace's plane",
                           .normal_W = workspace.plane_normal_W,
                           .offset_m = workspace.plane_offset_m});
  for (const simulation::Ball& ball : setup.bone.balls)
    around.spheres.push_back({.center_W_m = setup.X_WG * Vector3(ball.center_m), .radius_m = ball.radius_m});
  around.position_margin_rad = cell.servo.joints.position_margin_rad;
  const auto found = six_axis
                         ? control::CheckPath<6>(six_axis->chain, q_from.head<6>(), q_to.head<6>(), around)
                         : control::CheckPath<7>(cell.robot.lbr()->chain, q_from, q_to, around);
  return found ? std::string() : found.error();
}

}  // namespace osteon::session
