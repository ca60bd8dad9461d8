// The guard with a controller whose code is wrong. The controller keeps its limits with the servo loop's
// code: LbrArm, which uses SerialChain, and Workspace, which uses ZoneBounds. Both are linked here from
// copies of the sources, in which plant_faults.cmake has planted a fault for each function. A guard that
// shared one of these functions would be wrong in the same way and let the command pass.

#include <ostream>
#include <random>

#include <gtest/gtest.h>

#include "guard_bench.h"
#include "planted_fault.h"

namespace osteon::safety {
namespace {

using kinematics::JointVector;
using planted::Fault;

constexpr int kEpisodes = 40;  // motions in random directions, per fault
constexpr int kMinCaught = 2;  // some faults show in some directions only, and stop the arm early in others
constexpr int kTicks = 600;    // length of an episode
constexpr double kSpeed_m_per_s = 0.15;  // the controller's limit; the guard's is a quarter higher
constexpr double kTurn_rad_per_s = 1.0;
constexpr double kReach_m = 0.06;   // radius of the workspace's sphere: the tool reaches it within kTicks
constexpr double kStart_m = 0.012;  // distance from the start to the bound of a zone

const Pose& ToolOnFlange() {
  static const Pose X_FT = [] {
    Pose X = Pose::Identity();
    X.translation() = Vector3(0.06, 0.0, 0.2);  // beside the axis of A7, so that A7's angle matters
    return X;
  }();
  return X_FT;
}

// Plants a fault in the controller's code for the lifetime of the object.
class Plant {
 public:
  explicit Plant(Fault fault) { planted::fault = fault; }
  ~Plant() { planted::fault = Fault::kNone; }
  Plant(const Plant&) = delete;
  Plant& operator=(const Plant&) = delete;
};

JointVector ToVector(const GuardJoints& q) { return Eigen::Map<const JointVector>(q.data()); }

// Places of apex, flange and elbow in the arm's base, in the order of ZonePoint.
std::array<Vector3, 3> PointsAt(const kinematics::LbrArm& arm, const JointVector& q) {
  const kinematics::LbrArm::ArmPoints points = arm.Points(q);
  return {points.X_BF * Vector3(ToolOnFlange().translation()), points.X_BF.translation(), points.p_BElbow};
}

// Moves along a direction in joint space at the tool's speed limit, and brakes before the workspace's bounds
// as the servo loop does (Workspace::Share). It does not check its own commands.
class Controller {
 public:
  Controller(const GuardParams& limits, const JointVector& direction)
      : limits_(limits), arm_(kinematics::Iiwa14()), workspace_(limits.workspace), direction_(direction) {}

  /// The next command [rad], from the joints of the previous one.
  [[nodiscard]] GuardJoints Next(const GuardJoints& from) const {
    const JointVector q = ToVector(from);
    const Eigen::Matrix<double, 6, 1> V = arm_.JacobianAt(q, ToolOnFlange().translation()) * direction_;
    double rate = std::min(kSpeed_m_per_s / V.head<3>().norm(), kTurn_rad_per_s / V.tail<3>().norm());
    for (int i = 0; i < 7; ++i)
      rate = std::min(rate, 0.5 * limits_.joint_speed_share *
                                limits_.arm.joints[static_cast<std::size_t>(i)].limits.velocity_rad_per_s /
                                std::abs(direction_[i]));
    JointVector step = rate * limits_.period_s * direction_;
    const std::array<Vector3, 3> here = PointsAt(arm_, q);
    for (int tries = 0; tries < 3; ++tries) {  // the points' paths are curved
      const std::array<Vector3, 3> there = PointsAt(arm_, q + step);
      double share = 1.0;
      for (std::size_t i = 0; i < here.size(); ++i)
        if (const auto point = static_cast<ZonePoint>(i); workspace_.Has(point))
          share = std::min(share, workspace_.Share(point, here[i], there[i], limits_.period_s));
      step *= share;
    }
    GuardJoints next{};
    Eigen::Map<JointVector>(next.data()) = q + step;
    return next;
  }

 private:
  GuardParams limits_;
  kinematics::LbrArm arm_;
  Workspace workspace_;
  JointVector direction_;
};

// A planted fault and, if the fault is in the code of zones, the zone that reveals it.
struct Row {
  Fault fault;
  const char* name;
  std::optional<ZoneShape> shape{};  // none: a fault of the kinematics
  ZoneSide side{ZoneSide::kKeepIn};
};
void PrintTo(const Row& row, std::ostream* out) { *out << row.name; }

constexpr Row kKinematics[] = {
    {Fault::kJointSign, "JointSign"},       {Fault::kJointAxis, "JointAxis"},
    {Fault::kJointOrigin, "JointOrigin"},   {Fault::kJointZero, "JointZero"},
    {Fault::kFlangeOrigin, "FlangeOrigin"}, {Fault::kFlangeAxis, "FlangeAxis"},
    {Fault::kJacobianSign, "JacobianSign"}, {Fault::kJacobianOffset, "JacobianOffset"},
    {Fault::kJacobianAxis, "JacobianAxis"},
};
constexpr ZoneSide kIn = ZoneSide::kKeepIn, kOut = ZoneSide::kKeepOut;
constexpr Row kZones[] = {
    {Fault::kZoneSign, "ZoneSign", ZoneShape::kHalfSpace, kIn},
    {Fault::kZoneOrigin, "ZoneOriginOfABox", ZoneShape::kBox, kIn},
    {Fault::kZoneOrigin, "ZoneOriginOfASphere", ZoneShape::kSphere, kOut},
    {Fault::kZoneAxis, "ZoneAxis", ZoneShape::kHalfSpace, kIn},
    {Fault::kZoneAxis, "ZoneAxisOfACylinder", ZoneShape::kCylinder, kOut},
    {Fault::kZoneDirection, "ZoneDirection", ZoneShape::kHalfSpace, kOut},
    {Fault::kInHalfSpaceSign, "InHalfSpaceSign", ZoneShape::kHalfSpace, kIn},
    {Fault::kInBoxOffset, "InBoxOffset", ZoneShape::kBox, kIn},
    {Fault::kInCylinderOffset, "InCylinderOffset", ZoneShape::kCylinder, kIn},
    {Fault::kInCylinderEndSign, "InCylinderEndSign", ZoneShape::kCylinder, kIn},
    {Fault::kInSphereOffset, "InSphereOffset", ZoneShape::kSphere, kIn},
    {Fault::kAxisOffset, "InCapsuleOffset", ZoneShape::kCapsule, kIn},
    {Fault::kOutHalfSpaceSign, "OutHalfSpaceSign", ZoneShape::kHalfSpace, kOut},
    {Fault::kOutBoxOffset, "OutBoxOffset", ZoneShape::kBox, kOut},
    {Fault::kOutCylinderOffset, "OutCylinderOffset", ZoneShape::kCylinder, kOut},
    {Fault::kOutSphereOffset, "OutSphereOffset", ZoneShape::kSphere, kOut},
    {Fault::kOutSphereOffset, "OutCapsuleOffset", ZoneShape::kCapsule, kOut},
    {Fault::kOutSphereSign, "OutSphereSign", ZoneShape::kSphere, kOut},
    {Fault::kGapsSign, "OutBoxSign", ZoneShape::kBox, kOut},
    {Fault::kMaxOfAll, "LargestOfAll", ZoneShape::kBox, kIn},
};

class GuardFaults : public testing::TestWithParam<Row> {
 protected:
  double Within(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
  Vector3 AnyDirection() {
    std::normal_distribution<double> normal;
    return Vector3(normal(random_), normal(random_), normal(random_)).normalized();
  }

  // Limits of a cell whose start is well inside them, placed by correct kinematics.
  GuardParams Limits() {
    GuardParams limits{.arm = kinematics::ChainFrom(kinematics::Iiwa14())};
    limits.X_FT = ToolOnFlange();
    limits.max_speed_m_per_s = limits.max_start_path_speed_m_per_s = kSpeed_m_per_s;
    limits.max_turn_rad_per_s = kTurn_rad_per_s;
    limits.workspace.sphere_center_W_m = PointsAt(arm_, q_)[0];
    limits.workspace.sphere_radius_m = kReach_m;
    return limits;
  }

  // Adds a zone for one of the three points. Returns the joint direction that leads the point to its bound.
  JointVector AddZone(const Row& row, GuardParams& limits) {
    const auto at = static_cast<std::size_t>(std::uniform_int_distribution(0, 2)(random_));
    ZoneParams zone{.shape = *row.shape, .side = row.side, .point = static_cast<ZonePoint>(at)};
    zone.R_W = Eigen::Quaterniond(Within(-1, 1), Within(-1, 1), Within(-1, 1), Within(-1, 1))
                   .normalized()
                   .toRotationMatrix();
    zone.half_edge_m = Vector3(0.02, 0.03, 0.015);
    zone.radius_m = 0.02;
    zone.half_length_m = 0.025;
    const Vector3 p = PointsAt(arm_, q_)[at];
    Vector3 toward = AnyDirection();
    if (row.side == ZoneSide::kKeepIn) {
      // the point starts at the zone's middle; in a half-space, it starts kStart_m from the bound
      if (zone.shape == ZoneShape::kHalfSpace) toward = -zone.R_W.col(2);
      zone.p_W_m = zone.shape == ZoneShape::kHalfSpace ? Vector3(p + kStart_m * toward) : p;
    } else if (zone.shape == ZoneShape::kHalfSpace) {
      toward = zone.R_W.col(2);
      zone.p_W_m = p + kStart_m * toward;
    } else {
      // the zone's surface lies inside its bounding sphere, so the distance from the start to the bound is at
      // least kStart_m
      zone.p_W_m = p + (zone.half_edge_m.norm() + zone.radius_m + kStart_m) * toward;
    }
    limits.workspace.zones = {zone};
    limits.workspace.sphere_radius_m = 1.0;
    return JointsToward(at, toward);
  }

  // Direction in joint space that moves a point of the arm in the direction `way`. It is computed by finite
  // differences, with correct kinematics.
  JointVector JointsToward(std::size_t point, const Vector3& way) {
    constexpr double kStep_rad = 1e-6;
    JointVector direction;
    for (int i = 0; i < 7; ++i) {
      const JointVector step = kStep_rad * JointVector::Unit(i);
      direction[i] = (PointsAt(arm_, q_ + step)[point] - PointsAt(arm_, q_ - step)[point]).dot(way);
    }
    return direction.normalized();
  }

  JointVector AnyJoints() {
    JointVector direction;
    for (int i = 0; i < 7; ++i) direction[i] = Within(-1, 1);
    return direction;
  }

  // Runs the controller with a fault. Returns in how many episodes the guard withheld a command.
  int Caught(const Row& row, Fault fault) {
    int caught = 0;
    for (int episode = 0; episode < kEpisodes; ++episode) {
      GuardParams limits = Limits();
      const JointVector direction = row.shape ? AddZone(row, limits) : AnyJoints();
      GuardBench bench(limits);
      EXPECT_TRUE(bench.RunUntilArmFollows());
      const Plant plant(fault);
      const Controller controller(limits, direction);
      for (int tick = 0; tick < kTicks && !bench.monitor.latched(); ++tick) {
        bench.Message(GuardSession::kActive);
        (void)bench.Answer(controller.Next(bench.arm.q_meas));
      }
      if (!bench.monitor.latched()) continue;
      ++caught;
      const GuardFinding found = bench.monitor.reason().finding;
      const bool of_place = found == GuardFinding::kWorkspace || found == GuardFinding::kZone,
                 of_speed = found == GuardFinding::kToolSpeed || found == GuardFinding::kToolTurn;
      EXPECT_TRUE(of_place || of_speed) << Describe(bench.monitor.reason());
    }
    return caught;
  }

 private:
  std::mt19937_64 random_{33};
  const kinematics::LbrArm arm_{kinematics::Iiwa14()};
  const JointVector q_ = ToVector(GuardBench::StartJoints());
};

TEST_P(GuardFaults, EachIsCaught) {
  EXPECT_GE(Caught(GetParam(), GetParam().fault), kMinCaught) << "of " << kEpisodes << " episodes";
}

// The same controller with correct code: the guard must find nothing.
TEST_P(GuardFaults, CorrectCodeIsNeverStopped) { EXPECT_EQ(Caught(GetParam(), Fault::kNone), 0); }

INSTANTIATE_TEST_SUITE_P(Kinematics, GuardFaults, testing::ValuesIn(kKinematics),
                         [](const auto& row) { return row.param.name; });
INSTANTIATE_TEST_SUITE_P(Zones, GuardFaults, testing::ValuesIn(kZones),
                         [](const auto& row) { return row.param.name; });

// For each joint, sends the torques of the largest allowed force in the direction in which this joint has its
// longest lever, by the controller's Jacobian. Returns whether the guard withheld any of them.
bool CatchesTorques(Fault fault) {
  bool caught = false;
  for (int joint = 0; joint < 7; ++joint) {
    GuardBench bench;
    EXPECT_TRUE(bench.RunUntilArmFollows());
    const GuardJoints q = GuardBench::StartJoints();
    GuardCommand command{.q = q};
    {
      const Plant plant(fault);
      const kinematics::LbrArm arm(kinematics::Iiwa14());
      const kinematics::Jacobian J = arm.JacobianAt(ToVector(q), Vector3(0.0, 0.0, 0.2));
      const Vector3 lever = J.col(joint).head<3>();
      Eigen::Matrix<double, 6, 1> F = Eigen::Matrix<double, 6, 1>::Zero();
      if (lever.norm() > 1e-3) F.head<3>() = 200.0 * lever.normalized();
      Eigen::Map<JointVector>(command.tau.emplace().data()) = J.transpose() * F;
    }
    bench.Message(GuardSession::kActive);
    (void)bench.Answer(command);
    caught |= bench.monitor.reason().finding == GuardFinding::kJointTorque;
  }
  return caught;
}

TEST(GuardJacobian, TorquesFromLeversThatAreTooLongAreCaught) {
  EXPECT_TRUE(CatchesTorques(Fault::kJacobianOffset));
  EXPECT_FALSE(CatchesTorques(Fault::kNone));
}

// The guard computes the hand's force from the arm's external torques. A fault in the controller's Jacobian
// must not change it: 2 % below the guard's limit (250 N plus a quarter) passes, 2 % above is found.
TEST(GuardJacobian, TheHandsForceIsMeasuredWithoutTheControllersJacobian) {
  for (const Fault fault :
       {Fault::kNone, Fault::kJacobianSign, Fault::kJacobianOffset, Fault::kJacobianAxis, Fault::kJointSign})
    for (const double ratio : {0.98, 1.02}) {
      const kinematics::LbrArm arm(kinematics::Iiwa14());
      GuardBench bench;
      ASSERT_TRUE(bench.RunUntilArmFollows());
      const GuardJoints q = GuardBench::StartJoints();
      Eigen::Matrix<double, 6, 1> F = Eigen::Matrix<double, 6, 1>::Zero();
      F.head<3>() = ratio * 1.25 * 250.0 * Vector3(2.0, -1.0, 2.0) / 3.0;
      Eigen::Map<JointVector>(bench.arm.tau_ext.emplace().data()) =
          arm.JacobianAt(ToVector(q), Vector3::Zero()).transpose() * F;
      const Plant plant(fault);
      for (int i = 0; i < 10; ++i) {
        bench.Message(GuardSession::kActive);
        (void)bench.Answer(q);
      }
      EXPECT_EQ(bench.monitor.reason().finding, ratio > 1.0 ? GuardFinding::kHandForce : GuardFinding::kNone)
          << static_cast<int>(fault);
    }
}

}  // namespace
}  // namespace osteon::safety
