#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <Eigen/SVD>

#include "config/reading/load.h"
#include "control/loop/servo_loop.h"
#include "tests/kinematics/iiwa14.h"

// Tests the shipped demo cell: its figures against their sources, its values in the loop, and its reach for
// reaming.

namespace osteon::config {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

class DemoCellTest : public ::testing::Test {
 protected:
  const CellConfig cell_ = LoadCell(std::string(OSTEON_SOURCE_DIR) + "/config/cells/demo.yaml");
};

TEST_F(DemoCellTest, FilesHaveTheFiguresOfTheirSources) {
  const kinematics::LbrParams sources = kinematics::Iiwa14();
  EXPECT_DOUBLE_EQ(cell_.robot.lbr()->params.base_to_shoulder_m, sources.base_to_shoulder_m);
  EXPECT_DOUBLE_EQ(cell_.robot.lbr()->params.shoulder_to_elbow_m, sources.shoulder_to_elbow_m);
  EXPECT_DOUBLE_EQ(cell_.robot.lbr()->params.elbow_to_wrist_m, sources.elbow_to_wrist_m);
  EXPECT_DOUBLE_EQ(cell_.robot.lbr()->params.wrist_to_flange_m, sources.wrist_to_flange_m);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_DOUBLE_EQ(cell_.robot.lbr()->params.limits[i].lower_rad, sources.limits[i].lower_rad);
    EXPECT_DOUBLE_EQ(cell_.robot.lbr()->params.limits[i].upper_rad, sources.limits[i].upper_rad);
    EXPECT_DOUBLE_EQ(cell_.robot.lbr()->params.limits[i].velocity_rad_per_s,
                     sources.limits[i].velocity_rad_per_s);
    EXPECT_DOUBLE_EQ(cell_.robot.lbr()->params.limits[i].acceleration_rad_per_s2,
                     sources.limits[i].acceleration_rad_per_s2);
    EXPECT_DOUBLE_EQ(cell_.robot.lbr()->params.limits[i].torque_Nm, sources.limits[i].torque_Nm);
  }
  EXPECT_DOUBLE_EQ(cell_.tool.tool.balls.front().radius_m, 0.025);
  EXPECT_NEAR(cell_.tool.spindle_rad_per_s, 26.18, 0.01);
  ASSERT_EQ(cell_.scene.materials.size(), 3u);
  EXPECT_EQ(cell_.scene.materials[1].name, "cortical");
  EXPECT_DOUBLE_EQ(cell_.scene.materials[1].density_kg_per_m3, 1850.0);
  EXPECT_DOUBLE_EQ(cell_.scene.materials[1].specific_cutting_energy_J_per_m3, 1.3e9);
  EXPECT_TRUE(cell_.scene.materials[2].cutting_energy_source.assumed);
  EXPECT_DOUBLE_EQ(cell_.cutting.stiffness_N_per_m, 20e3);
  EXPECT_DOUBLE_EQ(cell_.cutting.max_force_N, 200.0);
  EXPECT_DOUBLE_EQ(cell_.servo.period_s, 0.001);
  EXPECT_DOUBLE_EQ(cell_.servo.spindle_rad_per_s, cell_.tool.spindle_rad_per_s);
  EXPECT_DOUBLE_EQ(cell_.servo.joints.limits[6].upper_rad, 175.0 * kDegree);
  EXPECT_EQ(cell_.simulated.servo.dead_cycles, 3);
  EXPECT_DOUBLE_EQ(cell_.cutting.max_slide_m, simulation::CuttingParams{}.max_slide_m);
  EXPECT_EQ(cell_.tool.tool.name, "hemispherical reamer 50 mm");
  EXPECT_EQ(cell_.tool.tool.balls.size(), 16u) << "a head and 120 mm of shaft";
  EXPECT_EQ(cell_.tool.X_FT.translation(), Vector3(0, 0, 180e-3))
      << "bit for bit: the demo's hash hangs on it";
  EXPECT_NEAR(cell_.tool.tool.mass_kg, 0.9, 0.05);
  EXPECT_LT(Vector3(cell_.tool.tool.center_of_mass_m).z(), -0.05) << "behind the head";
  EXPECT_EQ(cell_.simulated.fri.quality.end_after_lost_in_a_row, 20) << "Franka's figure";
  EXPECT_EQ(cell_.simulated.fri.quality.end_after_lost_per_s, 200);
  EXPECT_EQ(hil::QualityPolicyParams{}.end_after_lost_in_a_row, 5) << "the library's own stay the design's";
  EXPECT_EQ(hil::QualityPolicyParams{}.end_after_lost_per_s, 25);
  EXPECT_DOUBLE_EQ(std::get<hil::ReamingScriptParams>(cell_.script).hand_stiffness_N_per_m,
                   cell_.simulated.hand.stiffness_N_per_m);
}

TEST_F(DemoCellTest, MaterialsAndSceneEqualTheDefaultsInTheCode) {
  const simulation::AcetabulumParams sources;
  ASSERT_LE(cell_.scene.materials.size(), sources.materials.size());
  for (std::size_t i = 0; i < cell_.scene.materials.size(); ++i) {
    const simulation::Material &found = cell_.scene.materials[i], &known = sources.materials[i];
    EXPECT_EQ(found.name, known.name);
    EXPECT_DOUBLE_EQ(found.density_kg_per_m3, known.density_kg_per_m3);
    EXPECT_DOUBLE_EQ(found.specific_cutting_energy_J_per_m3, known.specific_cutting_energy_J_per_m3);
    EXPECT_DOUBLE_EQ(found.cutting_force_ratio, known.cutting_force_ratio);
    EXPECT_DOUBLE_EQ(found.friction, known.friction);
    EXPECT_EQ(found.density_source.text, known.density_source.text);
    EXPECT_EQ(found.density_source.assumed, known.density_source.assumed);
    EXPECT_EQ(found.cutting_energy_source.text, known.cutting_energy_source.text);
    EXPECT_EQ(found.cutting_energy_source.assumed, known.cutting_energy_source.assumed);
    EXPECT_EQ(found.cutting_force_source.text, known.cutting_force_source.text);
    EXPECT_EQ(found.cutting_force_source.assumed, known.cutting_force_source.assumed);
    EXPECT_EQ(found.friction_source.text, known.friction_source.text);
    EXPECT_EQ(found.friction_source.assumed, known.friction_source.assumed);
  }
  EXPECT_DOUBLE_EQ(std::get<simulation::AcetabulumShape>(cell_.scene.shape).cup_radius_m,
                   sources.shape.cup_radius_m);
  EXPECT_DOUBLE_EQ(cell_.scene.packing.lattice.finest_m, sources.packing.lattice.finest_m);
  EXPECT_DOUBLE_EQ(cell_.scene.packing.surface_gap_m, sources.packing.surface_gap_m);
  EXPECT_DOUBLE_EQ(cell_.scene.points.cells.finest_m, sources.points.cells.finest_m);
}

TEST_F(DemoCellTest, ServoLoopAndSceneAcceptTheCell) {
  const kinematics::LbrArm arm(cell_.robot.lbr()->params);
  EXPECT_NO_THROW(
      control::ServoLoop(cell_.servo, arm, cell_.X_WB, cell_.tool.X_FT, cell_.start.arm_angle_rad));
  const hil::HandScript script = hil::MakeScript(cell_.script);
  EXPECT_NO_THROW(hil::SimulatedCell(cell_.simulated, script));
  const simulation::Bone bone = simulation::PackScene(simulation::MakeSceneSolid(cell_.scene), cell_.scene);
  EXPECT_GT(bone.balls.size(), 20'000u);
  EXPECT_LT(bone.balls.size(), 40'000u);
}

TEST_F(DemoCellTest, ToolStartsAboveTheCupPointingIntoIt) {
  const Vector3 feed_W = cell_.start.X_WT.linear().col(2), cup_axis_W = cell_.X_WG.linear().col(2);
  EXPECT_NEAR(feed_W.dot(cup_axis_W), -1.0, 1e-12);
  const Vector3 p_GT = cell_.X_WG.inverse() * cell_.start.X_WT.translation();
  EXPECT_NEAR(std::hypot(p_GT.x(), p_GT.y()), 0.0, 1e-12);
  EXPECT_GT(p_GT.z(), 0.0);
  // the operator's script begins exactly at the arm's start
  const Pose X_script = hil::MakeScript(cell_.script).Sample(0.0).X_WT;
  EXPECT_LT((X_script.matrix() - cell_.start.X_WT.matrix()).cwiseAbs().maxCoeff(), 1e-12);
  // forward kinematics of the start's joints, along the whole chain of frames: world, base, flange, tool
  const kinematics::LbrArm arm(cell_.robot.lbr()->params);
  const Pose X_WT = cell_.X_WB * arm.FlangePose(cell_.start.q) * cell_.tool.X_FT;
  EXPECT_LT((X_WT.matrix() - cell_.start.X_WT.matrix()).cwiseAbs().maxCoeff(), 1e-12);
}

// Reaming needs the following poses. The head's centre moves from 100 mm above the cup's centre to 40 mm
// below it, and 20 mm to each side. The tool tilts about the head's centre by up to 15 deg in any direction.
// In each pose, the joints must be far from their limits, and the arm must be able to move the tool in every
// direction. The measure of the latter is the smallest singular value of the apex's Jacobian, with rotation
// weighted by 0.1 m/rad.
TEST_F(DemoCellTest, ArmReachesAllReamingPosesFarFromLimitsAndSingularities) {
  const kinematics::LbrArm arm(cell_.robot.lbr()->params);
  const double head_m = cell_.tool.tool.balls.front().radius_m;
  double least_margin_rad = 10.0, least_singular = 10.0;
  int poses = 0;
  for (double z_m = -0.04; z_m <= 0.1001; z_m += 0.02)
    for (const double x_m : {-0.02, 0.0, 0.02})
      for (const double y_m : {-0.02, 0.0, 0.02})
        for (int direction = 0; direction <= 12; ++direction) {
          const double tilt = direction == 12 ? 0.0 : 15.0 * kDegree, toward = direction * 30.0 * kDegree;
          Pose X_WT = Pose::Identity();
          X_WT.linear() = Eigen::AngleAxisd(tilt, Vector3(std::cos(toward), std::sin(toward), 0.0)) *
                          cell_.start.X_WT.linear();
          X_WT.translation() = cell_.X_WG * Vector3(x_m, y_m, z_m) + head_m * X_WT.linear().col(2);
          kinematics::JointVector q;
          ASSERT_TRUE(arm.Inverse(cell_.X_WB.inverse() * X_WT * cell_.tool.X_FT.inverse(),
                                  cell_.start.arm_angle_rad, cell_.start.q, q));
          EXPECT_LT((q - cell_.start.q).cwiseAbs().maxCoeff(), 90.0 * kDegree)
              << "another branch of the inverse";
          for (int i = 0; i < 7; ++i)
            least_margin_rad = std::min(
                least_margin_rad,
                cell_.robot.lbr()->params.limits[static_cast<std::size_t>(i)].upper_rad - std::abs(q[i]));
          kinematics::Jacobian J = arm.JacobianAt(q, cell_.tool.X_FT.translation());
          J.bottomRows<3>() *= 0.1;
          least_singular =
              std::min(least_singular, Eigen::JacobiSVD<kinematics::Jacobian>(J).singularValues()[5]);
          EXPECT_LE((X_WT.translation() - cell_.servo.workspace.sphere_center_W_m).norm(),
                    cell_.servo.workspace.sphere_radius_m);
          EXPECT_GE(cell_.servo.workspace.plane_normal_W.dot(X_WT.translation()),
                    cell_.servo.workspace.plane_offset_m);
          ++poses;
        }
  RecordProperty("least_margin_deg", std::to_string(least_margin_rad / kDegree));
  RecordProperty("least_singular_value", std::to_string(least_singular));
  EXPECT_EQ(poses, 8 * 9 * 13);
  EXPECT_GE(least_margin_rad, 20.0 * kDegree);
  // the value found is 0.0384. With 0.035, a motion at 0.25 m/s in the worst direction takes at most
  // 0.25/0.035 = 7.1 rad/s (norm over all joints)
  EXPECT_GE(least_singular, 0.035);
}

}  // namespace
}  // namespace osteon::config
