#include "config/reading/load.h"
#include "control/loop/servo_loop.h"
#include "safety/workspace.h"
#include "tests/fuzz/targets/config_claims.h"

// Fuzz target: the YAML file of a whole cell. The files that the cell names are those of the repository. Its
// tool is always the reamer, which needs no slow fitting of balls. If the cell is accepted, it must be
// possible to make a servo loop from it.

namespace osteon::fuzz {
namespace {

// Claims that poses, limits and start of the cell are usable, and makes its servo loop.
void ClaimRuns(const config::CellConfig& cell) {
  const control::ServoParams& servo = cell.servo;
  Claim(servo.wrench.max_force_N > 0.0 && servo.wrench.max_force_N <= 200.0, "a cell gives at most 200 N");
  for (const Pose& X : {cell.X_WB, cell.X_WG, cell.tool.X_FT, cell.start.X_WT}) {
    Claim(X.matrix().allFinite(), "a pose is finite");
    Claim((X.linear() * X.linear().transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff() <= 1e-9,
          "and turns without shearing");
  }
  const auto joints = static_cast<Eigen::Index>(cell.robot.lbr() ? 7 : 6);
  for (Eigen::Index i = 0; i < joints; ++i) {
    const auto& limits = servo.joints.limits[static_cast<std::size_t>(i)];
    Claim(cell.start.q[i] >= limits.lower_rad && cell.start.q[i] <= limits.upper_rad,
          "a cell begins within the joints' limits");
  }
  Claim(safety::Workspace(servo.workspace).Distance(cell.start.X_WT.translation()) >= 0.0,
        "and within its workspace");
  if (const auto* lbr = cell.robot.lbr()) {
    const control::ServoLoop loop(servo, kinematics::LbrArm(lbr->params), cell.X_WB, cell.tool.X_FT,
                                  cell.start.arm_angle_rad);
    Claim(loop.max_force_N() <= servo.wrench.max_force_N, "a loop gives no more than its cell");
  } else {
    const kinematics::OrthoParallelArm arm(cell.robot.six_axis()->params);
    const control::ServoLoop loop(servo, arm, cell.X_WB, cell.tool.X_FT);
    Claim(loop.max_force_N() <= servo.wrench.max_force_N, "a loop gives no more than its cell");
  }
}

}  // namespace
}  // namespace osteon::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace osteon;
  static const fuzz::FuzzConfig files;
  const std::string text = fuzz::Text({data, size});
  files.Write(text);
  const config::ConfigFileTracker scope(files.scope());
  static const config::ToolChoice reamer{.file = files.Beside("tools/reamer.yaml"), .diameter_m = {}};
  const auto cell =
      fuzz::Loaded([&] { return config::LoadCell(files.path(), reamer); }, files.path().string(), text);
  if (cell) fuzz::ClaimRuns(*cell);
  return 0;
}
