#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "config/reading/load_robot.h"
#include "report/heat_map.h"
#include "studies/capability/base_placement.h"
#include "studies/capability/capability_map.h"
#include "studies/capability/capability_result.h"

namespace osteon::studies {
namespace {

constexpr double kPi = std::numbers::pi;

/// The demo cell's configuration.
config::CellConfig LoadDemoCell() {
  return config::LoadCell(std::filesystem::path(OSTEON_SOURCE_DIR) / "config/cells/demo.yaml");
}

kinematics::ChainParams<7> Robot(const std::string& name) {
  const auto model =
      config::LoadRobot(std::filesystem::path(OSTEON_SOURCE_DIR) / "config/robots" / (name + ".yaml"));
  return std::get<kinematics::ChainParams<7>>(model.chain);
}

double Angle(const Vector3& a, const Vector3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

TEST(CapabilityTask, ComesFromTheCellsSiteToolAndScript) {
  const config::CellConfig cell = LoadDemoCell();
  const TaskVolume task = TaskOf(cell);
  EXPECT_NEAR(task.radius_m, 0.025, 1e-12) << "the head's radius";
  EXPECT_NEAR(task.bottom_m, -0.010, 1e-12) << "where the push ends, not where the hand's spring would pull";
  EXPECT_NEAR(task.top_m, 0.040, 1e-12);
  EXPECT_NEAR(task.tilt_rad, 10.0 * kPi / 180.0, 1e-12);
  EXPECT_NEAR(TaskOf(cell, 0.06).radius_m, 0.06, 1e-12);
  const CapabilityNeed need = NeedOf(cell);
  EXPECT_EQ(need.axial_N, 200.0);
  EXPECT_NEAR(need.lateral_N, 200.0 * std::sin(10.0 * kPi / 180.0), 0.5)
      << "of a push along the site's axis, seen by a tool tilted as far as the script does";
}

TEST(CapabilityTask, PosesFillTheVolumeAndTheTiltConeTowardTheBase) {
  const config::CellConfig cell = LoadDemoCell();
  const TaskVolume task = TaskOf(cell);
  // angle about the site's axis at which the base lies
  const double toward = DirectionOf(task, cell.X_WB.translation());
  EXPECT_NEAR(std::remainder(toward - kPi, 2.0 * kPi), 0.0, 1e-12)
      << "the demo's base stands at -x of its site";
  const std::vector<Pose> poses = TaskPoses(task, {}, toward);
  ASSERT_EQ(poses.size(), 3u * 9u * 9u);
  const Vector3 feed = -cell.X_WG.linear().col(2), site = cell.X_WG.translation();
  double tilted = 0.0, highest = -1.0, lowest = 1.0, toward_base = 0.0;
  for (const Pose& X_WT : poses) {
    const Vector3 axis = X_WT.linear().col(2);
    const Vector3 p_head = X_WT.translation() - task.head_radius_m * axis - site;
    EXPECT_LE(std::hypot(p_head.x(), p_head.y()), 0.025 + 1e-12);
    highest = std::max(highest, p_head.z());
    lowest = std::min(lowest, p_head.z());
    EXPECT_LE(Angle(axis, feed), task.tilt_rad + 1e-12);
    if (Angle(axis, feed) > task.tilt_rad - 1e-12) tilted += 1.0;
    toward_base = std::min(toward_base, axis.x());
  }
  EXPECT_NEAR(highest, 0.040, 1e-12);
  EXPECT_NEAR(lowest, -0.010, 1e-12);
  EXPECT_EQ(tilted, 3.0 * 9.0 * 8.0);
  EXPECT_NEAR(toward_base, -std::sin(task.tilt_rad), 1e-12) << "one pose leans straight toward the base";
  // the start of the script is among the poses, with the same yaw
  const Pose& start = cell.start.X_WT;
  EXPECT_TRUE(std::any_of(poses.begin(), poses.end(),
                          [&](const Pose& X) { return (X.matrix() - start.matrix()).norm() < 1e-9; }));
}

TEST(CapabilityTask, PosesOutsideTheWorkspaceAreOmitted) {
  config::CellConfig cell = LoadDemoCell();
  // a floor 25 mm below the site excludes the deepest poses
  cell.servo.workspace.plane_offset_m = cell.X_WG.translation().z() - 0.025;
  const TaskVolume task = TaskOf(cell);
  for (const Pose& X_WT : TaskPoses(task, {}, 0.0))
    EXPECT_GE(X_WT.translation().z(), cell.servo.workspace.plane_offset_m);
  EXPECT_LT(TaskPoses(task, {}, 0.0).size(), 243u);
}

// If the base turns about its own axis and joint A1 turns back by the same angle, the arm has the same
// posture as before and must hold the same forces. The test does this with a base on the floor and with one
// on a wall.
TEST(ArmForce, ABaseTurnedAboutItsAxisHoldsTheSame) {
  const kinematics::ChainParams<7> arm = Robot("lbr_iiwa_14_r820");
  const CapabilityNeed need{.axial_N = 200.0, .lateral_N = 40.0, .torque_Nm = 2.0, .lateral_from = ""};
  const Pose X_FT = Eigen::Translation3d(0.0, 0.0, 0.18) * Pose::Identity();
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int n = 0; n < 200; ++n) {
    const Matrix3 R_WB = ExpRotation(3.0 * Vector3(unit(random), unit(random), unit(random)));
    const double turn = 3.0 * unit(random);
    kinematics::JointVector q;
    for (int i = 0; i < 7; ++i) q[i] = 1.5 * unit(random);
    kinematics::JointVector q_back = q;
    q_back[0] -= turn;
    const ArmForce upright(arm, R_WB, X_FT, need),
        turned(arm, R_WB * ExpRotation({0.0, 0.0, turn}), X_FT, need);
    const ToolForce expected = upright.ForceAt(q), with_turned_base = turned.ForceAt(q_back),
                    with_turn_argument = upright.ForceAt(q_back, turn);
    ASSERT_NEAR(with_turned_base.factor, expected.factor, 1e-9 * expected.factor);
    ASSERT_NEAR(with_turn_argument.factor, expected.factor, 1e-9 * expected.factor);
    ASSERT_NEAR(with_turn_argument.axial_exact_N, expected.axial_exact_N, 1e-9 * expected.axial_exact_N);
    ASSERT_EQ(upright.NeedFactor(q), expected.factor);
    ASSERT_GE(expected.axial_exact_N, expected.axial_N * (1.0 - 1e-12));
  }
}

TEST(ArmForce, ElbowAndWristAreTheLinksLengthsApart) {
  const kinematics::ChainParams<7> arm = Robot("lbr_iiwa_14_r820");
  const ArmForce force(arm, Matrix3::Identity(), Pose::Identity(), {});
  kinematics::JointVector q;
  q << 0.3, 0.7, -0.4, -1.2, 0.5, 0.8, 0.1;
  const ArmForce::ElbowAndWrist centers = force.ElbowAndWristAt(q);
  EXPECT_NEAR((centers.p_B_elbow - Vector3(0, 0, 0.360)).norm(), 0.420, 1e-12);
  EXPECT_NEAR((centers.p_B_wrist - centers.p_B_elbow).norm(), 0.400, 1e-12);
}

// docs/capability.md states that the smaller arm, the iiwa 7, holds 200 N axially in more than 95 % of its
// postures.
TEST(ArmForce, TheIiwa7Holds200NewtonAxiallyInAlmostEveryPosture) {
  const kinematics::ChainParams<7> arm = Robot("lbr_iiwa_7_r800");
  const ArmForce force(arm, Matrix3::Identity(), Pose::Identity(), {.axial_N = 200.0, .lateral_from = ""});
  std::mt19937_64 random(2);
  int enough = 0, cautious = 0;
  constexpr int kPostures = 10'000;
  for (int n = 0; n < kPostures; ++n) {
    kinematics::JointVector q;
    for (int i = 0; i < 7; ++i) {
      const kinematics::JointLimits& limits = arm.joints[static_cast<std::size_t>(i)].limits;
      q[i] = std::uniform_real_distribution<double>(limits.lower_rad, limits.upper_rad)(random);
    }
    const ToolForce held = force.ForceAt(q);
    if (held.axial_exact_N >= 200.0) ++enough;
    if (held.axial_N >= 200.0) ++cautious;
  }
  EXPECT_GE(enough, 0.95 * kPostures);
  EXPECT_GE(cautious, 0.92 * kPostures) << "not counting on gravity's help";
}

// The guarantee is computed from samples of the volume. This test draws other poses at random in the volume
// and the tilt cone, and expects each to be held.
TEST(CapabilityMap, NoPoseWithinTheTaskHoldsLessThanTheGuarantee) {
  const config::CellConfig cell = LoadDemoCell();
  const TaskVolume task = TaskOf(cell);
  const CapabilityNeed need = NeedOf(cell);
  const CapabilityMap::Task own = CapabilityMap(cell, task, need, 2).AtOwnArmAngle();
  ASSERT_EQ(own.unreachable, 0u);
  const kinematics::LbrArm arm(cell.robot.lbr()->params);
  const ArmForce force(cell.robot.lbr()->chain, cell.X_WB.linear(), cell.tool.X_FT, need);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  double least_axial = HUGE_VAL, least_lateral = HUGE_VAL;
  for (int n = 0; n < 5000; ++n) {
    TaskVolume inside = task;
    inside.tilt_rad = task.tilt_rad * std::sqrt(unit(random));
    const double r = task.radius_m * std::sqrt(unit(random)), angle = 2.0 * kPi * unit(random);
    const Vector3 p_head = task.X_WC * Vector3(r * std::cos(angle), r * std::sin(angle),
                                               std::lerp(task.bottom_m, task.top_m, unit(random)));
    const Pose X_WT = TiltCone(inside, p_head, 1, 2.0 * kPi * unit(random)).back();
    kinematics::JointVector q;
    ASSERT_TRUE(arm.Inverse(cell.X_WB.inverse() * X_WT * cell.tool.X_FT.inverse(), cell.start.arm_angle_rad,
                            cell.start.q, q));
    const ToolForce held = force.ForceAt(q);
    // 0.5 %: the smallest value of a smooth field may lie between samples, which are a few centimetres apart
    ASSERT_GE(held.axial_N, 0.995 * own.force.axial_N);
    ASSERT_GE(held.lateral_N, 0.995 * own.force.lateral_N);
    ASSERT_GE(held.factor, 0.995 * own.force.factor);
    least_axial = std::min(least_axial, held.axial_N);
    least_lateral = std::min(least_lateral, held.lateral_N);
  }
  EXPECT_LT(least_axial, 1.05 * own.force.axial_N) << "and the guarantee is not far below what there is";
  EXPECT_LT(least_lateral, 1.05 * own.force.lateral_N);
}

TEST(CapabilityMap, TheBestArmAngleHoldsAtLeastWhatTheCellsOwnDoes) {
  const config::CellConfig cell = LoadDemoCell();
  const TaskVolume task = TaskOf(cell);
  const CapabilityMap map(cell, task, NeedOf(cell), 2);
  const CapabilityMap::Task best = map.AtBestArmAngle(), own = map.AtOwnArmAngle();
  EXPECT_EQ(best.unreachable, 0u);
  EXPECT_EQ(best.poses, 243u);
  EXPECT_GE(best.force.factor, own.force.factor * (1.0 - 1e-9));
  EXPECT_EQ(best.force.lateral_joint, 5) << "A6";
  // 40 N m of joint A6, less the tool's weight, over the lever of 306 mm to the apex of the 50 mm reamer
  EXPECT_LT(best.force.lateral_N, 40.0 / 0.306);
  EXPECT_GT(best.force.lateral_N, 35.0 / 0.306);
}

TEST(CapabilityMap, PanelNodesHoldTheLeastForceOfTheirTiltCone) {
  const config::CellConfig cell = LoadDemoCell();
  const TaskVolume task = TaskOf(cell);
  const CapabilityMap map(cell, task, NeedOf(cell), 2);
  const MapPanel panel = map.Panel(MapPlane::kHorizontal, 5, [] { return false; });
  ASSERT_EQ(panel.axial_N.size(), 36u);
  const kinematics::LbrArm arm(cell.robot.lbr()->params);
  const ArmForce force(cell.robot.lbr()->chain, cell.X_WB.linear(), cell.tool.X_FT, NeedOf(cell));
  int reached_nodes = 0;
  for (std::size_t i = 0; i < panel.axial_N.size(); ++i) {
    if (!std::isfinite(panel.own_axial_N[i])) continue;
    ++reached_nodes;
    EXPECT_TRUE(std::isfinite(panel.axial_N[i])) << "what one arm angle reaches, the best does";
    const Vector3 p_W = panel.origin_W +
                        (panel.u_from_m + static_cast<double>(i % 6) * panel.step_m) * panel.u_W +
                        (panel.v_from_m + static_cast<double>(i / 6) * panel.step_m) * panel.v_W;
    double least = HUGE_VAL;
    for (const Pose& X_WT : TiltCone(task, p_W, 8, DirectionOf(task, cell.X_WB.translation()))) {
      kinematics::JointVector q;
      ASSERT_TRUE(arm.Inverse(cell.X_WB.inverse() * X_WT * cell.tool.X_FT.inverse(), cell.start.arm_angle_rad,
                              cell.start.q, q));
      least = std::min(least, force.ForceAt(q).axial_N);
    }
    EXPECT_NEAR(panel.own_axial_N[i], least, 1e-6 * least);
  }
  EXPECT_GT(reached_nodes, 10);
}

/// A search range of bases around the cell's site, on a grid of 0.1 m.
BasePlacementParams SearchRangeNear(const config::CellConfig& cell) {
  const Vector3 site = cell.X_WG.translation();
  BasePlacementParams params;
  params.x_m = {site.x() - 0.8, site.x() - 0.3};
  params.y_m = {site.y() - 0.1, site.y() + 0.1};
  params.z_m = {site.z() - 0.4, site.z() + 0.4};
  params.step_m = 0.1;
  params.now_W_m = cell.X_WB.translation();
  return params;
}

/// The demo cell with its task, need and search range.
struct DemoSearch {
  config::CellConfig cell = LoadDemoCell();
  TaskVolume task = TaskOf(cell);
  CapabilityNeed need = NeedOf(cell);
  BasePlacementParams params = SearchRangeNear(cell);

  [[nodiscard]] BasePlacement Search() const {
    return {cell.robot.lbr()->chain, cell.X_WB.linear(), cell.tool.X_FT, task, need, params};
  }
};

const auto kNever = [] { return false; };

TEST(BasePlacement, FindsABaseThatNoRandomPlaceInTheRangeBeats) {
  const DemoSearch s;
  const BasePlacement search = s.Search();
  const auto best = search.Best(kNever);
  ASSERT_TRUE(best);
  EXPECT_GT(best->factor, 1.0) << "200 N and their lateral share, throughout";
  std::mt19937_64 random(4);
  const auto within = [&](const AxisRange& r) {
    return std::uniform_real_distribution<double>(r.from, r.to)(random);
  };
  int possible = 0;
  for (int n = 0; n < 300; ++n) {
    const Vector3 p_WB(within(s.params.x_m), within(s.params.y_m), within(s.params.z_m));
    const BaseFigure figure = search.Judge(p_WB);
    if (figure.configurations == 0) continue;
    ++possible;
    // 3 %: the task's samples are coarse, and the search may miss maxima over the arm angle that are narrower
    // than its first grid
    EXPECT_LT(figure.factor, 1.03 * best->factor) << p_WB.transpose();
  }
  EXPECT_GT(possible, 30);
  // the found base must be better than the demo's present base at its best arm angle
  EXPECT_GT(best->factor, search.Judge(s.cell.X_WB.translation()).factor);
}

TEST(BasePlacement, TheRoundedBaseThatIsWrittenKeepsTheStatedForces) {
  const DemoSearch s;
  const BasePlacement search = s.Search();
  const auto best = search.Best(kNever);
  ASSERT_TRUE(best);
  const BaseFigure base = search.Centred(*best);
  const ToolForce force = search.Forces(base);
  EXPECT_NEAR(force.factor, best->factor, 0.01 * best->factor) << "turning the base changes no force";

  // the base is rounded to whole millimetres and degrees, as the file states it
  const Vector3 p_mm = 1e3 * base.X_WB.translation(),
                rpy_deg = 180.0 / kPi * RollPitchYaw(base.X_WB.linear());
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(p_mm[i], std::round(p_mm[i]), 1e-9);
    EXPECT_NEAR(rpy_deg[i], std::round(rpy_deg[i]), 1e-9);
  }
  EXPECT_GE((p_mm.head<2>() * 1e-3 - s.cell.X_WG.translation().head<2>()).norm(),
            s.params.clearance_m - 1e-9);

  // With this base and the servo loop's inverse kinematics, every pose is reached without a jump, within the
  // joints' margin, and is held.
  config::CellConfig cell = s.cell;
  cell.X_WB = base.X_WB;
  const kinematics::LbrArm arm(cell.robot.lbr()->params);
  const ArmForce held(cell.robot.lbr()->chain, base.X_WB.linear(), cell.tool.X_FT, s.need);
  const std::vector<Pose> poses = TaskPoses(s.task, {}, DirectionOf(s.task, base.X_WB.translation()));
  kinematics::JointVector q = kinematics::JointVector::Zero();
  const auto reach = [&](const Pose& X_WT) {
    return arm.Solve(base.X_WB.inverse() * X_WT * cell.tool.X_FT.inverse(), base.arm_angle_rad)
        .configuration[static_cast<std::size_t>(std::countr_zero(base.configurations))];
  };
  double least = HUGE_VAL;
  for (const Pose& X_WT : poses) {
    const kinematics::LbrSolution solution = reach(X_WT);
    ASSERT_TRUE(solution.valid());
    if (X_WT.matrix() != poses.front().matrix()) {
      EXPECT_LT((solution.q - q).cwiseAbs().maxCoeff(), 1.0) << "one branch throughout";
    }
    q = reach(poses.front()).q;
    for (int i = 0; i < 7; ++i)
      EXPECT_LE(std::abs(solution.q[i]),
                cell.robot.lbr()->params.limits[static_cast<std::size_t>(i)].upper_rad -
                    s.params.joint_margin_rad + 0.01);
    least = std::min(least, held.ForceAt(solution.q).factor);
  }
  EXPECT_NEAR(least, force.factor, 1e-9);
}

TEST(BasePlacement, IsTheSameForAnyNumberOfThreads) {
  DemoSearch s;
  s.params.z_m = {s.params.z_m.from, s.params.z_m.from + 0.2};
  s.params.threads = 1;
  const auto one = s.Search().Best(kNever);
  s.params.threads = 3;
  const auto three = s.Search().Best(kNever);
  ASSERT_TRUE(one && three);
  EXPECT_EQ(one->X_WB.matrix(), three->X_WB.matrix());
  EXPECT_EQ(one->arm_angle_rad, three->arm_angle_rad);
  EXPECT_EQ(one->factor, three->factor);
}

TEST(BasePlacement, FindsNothingWhereTheArmCannotReach) {
  DemoSearch s;
  s.params.x_m = {5.0, 5.2};
  EXPECT_FALSE(s.Search().Best(kNever));
}

// The demo's cup faces up, so all bases at one distance and height must be equally good.
TEST(BasePlacement, BasesAllAroundAnUpwardCupAreEqual) {
  const DemoSearch s;
  const BasePlacement search = s.Search();
  const Vector3 site = s.cell.X_WG.translation();
  const BaseFigure from_behind = search.Judge(site + Vector3(-0.5, 0.0, 0.1));
  ASSERT_NE(from_behind.configurations, 0u);
  for (const double turn : {0.4, 1.3, 2.2}) {
    const BaseFigure figure = search.Judge(site + ExpRotation({0.0, 0.0, turn}) * Vector3(-0.5, 0.0, 0.1));
    // The centre of the workspace's sphere is not on the site's axis, but the sphere excludes no pose of this
    // task. Tolerance 0.2 %: the tool keeps its yaw in the room, so another configuration may be chosen,
    // whose centres of mass lie elsewhere.
    EXPECT_NEAR(figure.factor, from_behind.factor, 2e-3 * from_behind.factor);
  }
}

TEST(HeatMap, DrawsBandsContoursAndMarks) {
  report::HeatMap map{
      .title = "a < b",
      .x_label = "x [mm]",
      .y_label = "y [mm]",
      .x = {-100, 100},
      .y = {-100, 100},
      .nx = 21,
      .ny = 21,
      .values = {},
      .contours = {50.0},
      .lines = {},
      .marks = {{.x = 0.0, .y = 0.0, .marker = report::Marker::kCross, .color = "#d55e00", .label = "site"}}};
  for (int j = 0; j < 21; ++j)
    for (int i = 0; i < 21; ++i) map.values.push_back(i == 0 ? std::nan("") : 5.0 * i);
  const std::string svg = report::HeatMapSvg(
      {map}, 1, {{.label = "force [N]", .min = 0, .max = 100, .step = 10, .tick_step = 50}}, "Title", {});
  EXPECT_NE(svg.find("data:image/png;base64,"), std::string::npos);
  EXPECT_NE(svg.find(">50<"), std::string::npos) << "the contour's number";
  EXPECT_NE(svg.find("a &lt; b"), std::string::npos);
  EXPECT_NE(svg.find("site"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(report::ViridisColor(0.0), "#440154");
  EXPECT_EQ(report::ViridisColor(1.0), "#fde725");
}

TEST(RollPitchYaw, InvertsTheRotationsOfAFilesAngles) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int n = 0; n < 1000; ++n) {
    const Vector3 rpy(3.0 * unit(random), 1.5 * unit(random), 3.0 * unit(random));
    const auto turns = [](const Vector3& r) {
      return Matrix3(ExpRotation({0, 0, r.z()}) * ExpRotation({0, r.y(), 0}) * ExpRotation({r.x(), 0, 0}));
    };
    ASSERT_TRUE(turns(RollPitchYaw(turns(rpy))).isApprox(turns(rpy), 1e-12));
  }
  const Matrix3 up = ExpRotation({0, 0.5 * kPi, 0});
  EXPECT_TRUE(RollPitchYaw(up).isApprox(Vector3(0, 0.5 * kPi, 0), 1e-7));
}

}  // namespace
}  // namespace osteon::studies
