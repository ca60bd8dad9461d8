#include "studies/regress/plane_engine.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace osteon::studies {
namespace {

constexpr double kRadius_m = 0.025, kStiffness_N_per_m = 20e3;

simulation::Tool Reamer() { return simulation::MakeReamer(kRadius_m, 0.008, 0.13, 1.0, Vector3::Zero()); }

// An engine with the plane z = 0.1 of W, whose normal points up.
PlaneEngine MakePlaneEngine() {
  return {Reamer(),
          Vector3(0.3, -0.2, 0.1),
          Vector3::UnitZ(),
          {.stiffness_N_per_m = kStiffness_N_per_m, .normal_enlargement_m = 0.24e-3}};
}

// Pose of the tool that points down, tilted about x, with its head's lowest point at height_m above the
// plane.
Pose PoseAbove(double height_m, double tilt_rad = 0.0) {
  Pose X_WT = Pose::Identity();
  X_WT.linear() = Eigen::AngleAxisd(3.14159265358979 + tilt_rad, Vector3::UnitX()).toRotationMatrix();
  // the head's centre is a radius behind the apex
  X_WT.translation() = Vector3(0.5, 0.1, 0.1 + kRadius_m + height_m) + kRadius_m * X_WT.linear().col(2);
  return X_WT;
}

TEST(PlaneEngine, PushesAtTheBallsDeepestPointWithStiffnessTimesDepth) {
  PlaneEngine engine = MakePlaneEngine();
  for (const double tilt_rad : {0.0, 0.3}) {
    const double depth_m = 2e-3;
    const Pose X_WT = PoseAbove(-depth_m, tilt_rad);
    const simulation::ContactModel model = engine.Step({.X_WT = X_WT, .stamp = 7});
    ASSERT_EQ(model.contact_count, 1);
    EXPECT_EQ(model.pose_stamp, 7);
    const simulation::Contact& contact = model.contacts.front();
    EXPECT_NEAR(contact.gap_m, -depth_m, 1e-12);
    EXPECT_NEAR((Vector3(contact.n_W) - Vector3::UnitZ()).norm(), 0.0, 1e-15);
    // the contact's point must be the head's lowest point, a radius below the centre
    const Vector3 touching = X_WT * Vector3(contact.p_TP_m), center = X_WT * Vector3(0, 0, -kRadius_m);
    EXPECT_NEAR((touching - (center - kRadius_m * Vector3::UnitZ())).norm(), 0.0, 1e-12);
    EXPECT_NEAR(Vector3(contact.p_W_m).z(), 0.1, 1e-12);
    EXPECT_NEAR((Vector3(model.F_T_W.f) - Vector3(0, 0, kStiffness_N_per_m * depth_m)).norm(), 0.0, 1e-9);
    EXPECT_NEAR(
        (Vector3(model.F_T_W.t) - (touching - X_WT.translation()).cross(Vector3(model.F_T_W.f))).norm(), 0.0,
        1e-9);
    // the proxy lies on the plane
    EXPECT_NEAR(Pose(model.X_WP).translation().z() - X_WT.translation().z(), depth_m, 1e-12);
  }
}

TEST(PlaneEngine, ReportsANearPlaneWithoutAForce) {
  PlaneEngine engine = MakePlaneEngine();
  const auto near = engine.Step({.X_WT = PoseAbove(0.2e-3)});
  EXPECT_EQ(near.contact_count, 1);
  EXPECT_NEAR(near.contacts.front().gap_m, 0.2e-3, 1e-12);
  EXPECT_EQ(Vector3(near.F_T_W.f).norm(), 0.0);
  EXPECT_EQ(engine.Step({.X_WT = PoseAbove(0.3e-3)}).contact_count, 0);
  EXPECT_EQ(engine.Snapshot().frame, 2u);
}

TEST(PlaneEngine, RefusesAnInvalidPoseToolOrNormal) {
  PlaneEngine engine = MakePlaneEngine();
  Pose X_WT = PoseAbove(0.0);
  X_WT.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(engine.Step({.X_WT = X_WT}).status, simulation::EngineStatus::kBadInput);
  EXPECT_EQ(engine.Snapshot().frame, 0u) << "the frame changed nothing";
  EXPECT_THROW(PlaneEngine({}, Vector3::Zero(), Vector3::UnitZ(), {}), std::invalid_argument);
  EXPECT_THROW(PlaneEngine(Reamer(), Vector3::Zero(), Vector3(0, 0, 2), {}), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::studies
