#include "plugin/include/osteon_host.h"

#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/plugin/plugin_objects.h"

// Axes and units of the hosts (game engines), and sessions that use them.

namespace osteon::plugin {
namespace {

using host::Axes;
using host::Pose;
using host::Quaternion;
using host::Vector;

struct NamedAxes {
  const char* name;
  Axes axes;
};
const std::array<NamedAxes, 4> kHosts{
    {{"Osteon", host::kOsteon}, {"Godot", host::kGodot}, {"Unity", host::kUnity}, {"Unreal", host::kUnreal}}};

Vector Cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// The vector turned by the quaternion, by the formula that every host applies to its own components.
Vector Rotated(const Quaternion& q, const Vector& v) {
  const Vector u{q[1], q[2], q[3]};
  const Vector t = host::Scaled(Cross(u, v), 2.0), ut = Cross(u, t);
  return {v[0] + q[0] * t[0] + ut[0], v[1] + q[0] * t[1] + ut[1], v[2] + q[0] * t[2] + ut[2]};
}

// Vectors with normally distributed components, and unit quaternions.
class RandomValues {
 public:
  Vector NextVector() { return {normal_(random_), normal_(random_), normal_(random_)}; }
  Quaternion NextRotation() {
    Quaternion q{normal_(random_), normal_(random_), normal_(random_), normal_(random_)};
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (double& value : q) value /= length;
    return q;
  }

 private:
  std::mt19937 random_{5};
  std::normal_distribution<double> normal_;
};

void ExpectNear(const Vector& a, const Vector& b, double tolerance, const char* what) {
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << what << ", axis " << i;
}

TEST(HostAxes, ConvertPositionsAsDocumented) {
  const Vector p{1.0, 2.0, 3.0};
  ExpectNear(host::PositionToHost(host::kGodot, p), {1.0, 3.0, -2.0}, 0.0, "Godot");
  ExpectNear(host::PositionToHost(host::kUnity, p), {1.0, 3.0, 2.0}, 0.0, "Unity");
  ExpectNear(host::PositionToHost(host::kUnreal, p), {100.0, -200.0, 300.0}, 0.0, "Unreal");
  EXPECT_EQ(host::kGodot.Determinant(), 1);
  EXPECT_EQ(host::kUnity.Determinant(), -1);
  EXPECT_EQ(host::kUnreal.Determinant(), -1);
  EXPECT_TRUE(host::kGodot.TurnsTrianglesOver());
  EXPECT_TRUE(host::kUnity.TurnsTrianglesOver());
  EXPECT_FALSE(host::kUnreal.TurnsTrianglesOver());
}

TEST(HostAxes, ConvertThereAndBackWithoutChange) {
  for (const auto& [name, axes] : kHosts) {
    RandomValues values;
    for (int i = 0; i < 100; ++i) {
      const Vector p = values.NextVector(), v = values.NextVector();
      const Quaternion q = values.NextRotation();
      const OsteonPose back =
          host::PoseFromHost(axes, host::PoseToHost(axes, {{p[0], p[1], p[2]}, {q[0], q[1], q[2], q[3]}}));
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(back.position_m[k], p[k], 1e-14) << name;
      for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(back.orientation_wxyz[k], q[k]) << name;
      ExpectNear(host::DirectionFromHost(axes, host::DirectionToHost(axes, v)), v, 0.0, name);
      ExpectNear(host::AxialFromHost(axes, host::AxialToHost(axes, v)), v, 0.0, name);
    }
  }
}

TEST(HostAxes, RotateVectorsAlikeInEveryHost) {
  for (const auto& [name, axes] : kHosts) {
    RandomValues values;
    for (int i = 0; i < 100; ++i) {
      const Vector v = values.NextVector();
      const Quaternion q = values.NextRotation();
      ExpectNear(Rotated(host::RotationToHost(axes, q), host::DirectionToHost(axes, v)),
                 host::DirectionToHost(axes, Rotated(q, v)), 1e-13, name);
      // a torque computed as r × f in the host's components is the converted torque
      const Vector r = values.NextVector();
      ExpectNear(Cross(host::DirectionToHost(axes, r), host::DirectionToHost(axes, v)),
                 host::AxialToHost(axes, Cross(r, v)), 1e-13, name);
    }
  }
}

TEST(HostAxes, FindTheRotationOfAScaledMatrix) {
  RandomValues values;
  for (int i = 0; i < 200; ++i) {
    const Quaternion q = values.NextRotation();
    std::array<Vector, 3> rows = host::RowsOf(q);
    for (Vector& row : rows) row = {2.0 * row[0], 0.5 * row[1], 3.0 * row[2]};  // a scale of the columns
    const Quaternion found = host::RotationOf(rows);
    const double sign =
        found[0] * q[0] + found[1] * q[1] + found[2] * q[2] + found[3] * q[3] < 0.0 ? -1.0 : 1.0;
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(sign * found[k], q[k], 1e-12);
  }
  const Quaternion none{};
  EXPECT_EQ(host::RotationOf({}), none) << "a scale of 0";
  EXPECT_EQ(host::RotationOf({Vector{-1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}), none) << "mirrored";
  EXPECT_EQ(host::RotationOf({Vector{1.0, 1.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}), none) << "sheared";
  EXPECT_EQ(host::RotationOf({Vector{std::nan(""), 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}), none);
}

host::SessionParams LockstepParams(const char* scene = "thin_plate") {
  host::SessionParams params;
  params.scene = scene;
  params.config_folder = ConfigFolder().c_str();
  params.lockstep = true;
  params.engine = OSTEON_ENGINE_CPU;
  return params;
}

TEST(HostSession, FindsAToolThatMovesAlongEachAxis) {
  for (const auto& [name, axes] : kHosts) {
    host::Session session(axes);
    ASSERT_OK(session.Open(LockstepParams()));
    Pose up, none;
    EXPECT_EQ(session.Proxy(&none), OSTEON_EMPTY) << "before the first frame";
    ASSERT_OK(session.Approach(0.1, &up));
    ExpectNear(up.position, host::PositionToHost(axes, {0.0, 0.0, 0.1}), 1e-12, name);
    ASSERT_OK(session.Step(up, 0.0, 0.001));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Pose moved = up;
      moved.position[axis] += 0.001 * axes.units_per_m;
      for (int i = 0; i < 20; ++i) ASSERT_OK(session.Step(moved, 0.0, 0.001));
      Pose proxy;
      ASSERT_OK(session.Proxy(&proxy));
      ExpectNear(proxy.position, moved.position, 1e-9 * axes.units_per_m, name);
    }
  }
}

// All hosts must get the same force, each in its own axes, and the same mesh with its faces outwards.
TEST(HostSession, FeelsAndShowsTheSameInAllAxes) {
  host::Wrench reference;
  std::size_t triangles = 0;
  for (const auto& [name, axes] : kHosts) {
    host::Session session(axes);
    ASSERT_OK(session.Open(LockstepParams("acetabulum")));
    host::Wrench wrench;
    for (int ms = 0; ms < 2000; ++ms) {
      Pose pose;
      ASSERT_OK(session.Approach(-0.017 - 0.004e-3 * ms, &pose));
      const Vector aside = host::PositionToHost(axes, {0.4e-3, 0.2e-3, 0.0});
      for (std::size_t i = 0; i < 3; ++i) pose.position[i] += aside[i];
      ASSERT_OK(session.Step(pose, session.spindle_rad_per_s(), 0.001));
      ASSERT_OK(session.Evaluate(pose, &wrench));
    }
    if (axes.units_per_m == 1.0 && axes.front == 1 && axes.Determinant() == 1) reference = wrench;
    EXPECT_GT(std::hypot(wrench.force_N[0], wrench.force_N[1], wrench.force_N[2]), 5.0) << name;
    // poses in other axes differ in their last bit, and rounding grows while cutting
    ExpectNear(wrench.force_N, host::DirectionToHost(axes, reference.force_N), 0.5, name);
    ExpectNear(wrench.torque_Nm, host::AxialToHost(axes, reference.torque_Nm), 0.02, name);

    ASSERT_OK(osteon_session_surface_wait(session.session()));
    std::vector<host::Brick> bricks;
    ASSERT_OK(session.TakeChangedBricks(&bricks));
    std::size_t all = 0, front = 0;
    for (const host::Brick& brick : bricks) {
      ASSERT_EQ(brick.colors.size(), brick.positions.size());
      const auto at = [](const std::vector<float>& values, std::int32_t i) {
        return Vector{values[3 * static_cast<std::size_t>(i)], values[3 * static_cast<std::size_t>(i) + 1],
                      values[3 * static_cast<std::size_t>(i) + 2]};
      };
      for (std::size_t i = 0; i + 2 < brick.indices.size(); i += 3) {
        const Vector a = at(brick.positions, brick.indices[i]), b = at(brick.positions, brick.indices[i + 1]),
                     c = at(brick.positions, brick.indices[i + 2]), n = at(brick.normals, brick.indices[i]);
        const Vector ab{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, ac{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
        const Vector across = Cross(ab, ac);
        const double along = across[0] * n[0] + across[1] * n[1] + across[2] * n[2];
        front += along * axes.front > 0.0 ? 1 : 0;
        ++all;
      }
    }
    EXPECT_GT(static_cast<double>(front), 0.98 * static_cast<double>(all)) << name;
    if (triangles == 0) triangles = all;
    EXPECT_NEAR(static_cast<double>(all), static_cast<double>(triangles),
                0.01 * static_cast<double>(triangles))
        << name;
    EXPECT_GT(all, 1000U);
  }
}

TEST(HostSession, ReportsWhyACallFailed) {
  host::Session session(host::kGodot);
  host::SessionParams params = LockstepParams();
  params.tool = "no_such_tool";
  EXPECT_EQ(session.Open(params), OSTEON_ERROR_FILE);
  EXPECT_FALSE(session.IsOpen());
  EXPECT_NE(std::string(osteon_last_error()).find("no_such_tool"), std::string::npos) << osteon_last_error();
  host::Wrench wrench;
  EXPECT_EQ(session.Evaluate(Pose(), &wrench), OSTEON_ERROR_ARGUMENT) << "none is open";
  EXPECT_EQ(wrench.force_N, Vector{});
  params.tool = nullptr;
  ASSERT_OK(session.Open(params));
  ASSERT_OK(session.Open(params)) << "what was open is closed first";
  Pose nowhere;
  nowhere.orientation = {};
  EXPECT_EQ(session.Step(nowhere, 0.0, 0.001), OSTEON_ERROR_ARGUMENT);
}

}  // namespace
}  // namespace osteon::plugin
