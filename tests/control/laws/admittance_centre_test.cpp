#include <bit>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "control/laws/admittance_law.h"
#include "tests/base/checked_no_alloc_scope.h"

// Tests the admittance law for a virtual tool whose centre of mass C is away from the tool's origin To: full
// mass and damping matrices, locked axes, and masses that differ by axis.

namespace osteon::control {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kDt_s = 0.001;

// Draws random vectors and parameters.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}
  double Within(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Vector3 Box(double half) { return {Within(-half, half), Within(-half, half), Within(-half, half)}; }
  Vector3 Positive(double low, double high) {
    return {Within(low, high), Within(low, high), Within(low, high)};
  }
  AdmittanceParams Params() {
    AdmittanceParams params;
    params.mass_kg = Positive(0.5, 20.0);
    params.inertia_kg_m2 = Positive(0.01, 2.0);
    params.damping_Ns_per_m = Positive(1.0, 500.0);
    params.damping_Nms_per_rad = Positive(0.05, 20.0);
    params.centre_T_m = Box(0.4);
    return params;
  }

 private:
  std::mt19937_64 random_;
};

// A vector of six: `first` above `second`.
Vector6d Stacked(const Vector3& first, const Vector3& second) {
  Vector6d both;
  both << first, second;
  return both;
}

// The matrix A^T diag(linear, angular) A at To, computed independently of the code under test. A maps the
// twist of To to the twist of C, so its columns follow from v + w × c.
Matrix6 FullMatrix(const Vector3& linear, const Vector3& angular, const Vector3& c) {
  Matrix6 A;
  for (int i = 0; i < 3; ++i) {
    A.col(i) = Stacked(Vector3::Unit(i), Vector3::Zero());
    A.col(i + 3) = Stacked(Vector3::Unit(i).cross(c), Vector3::Unit(i));
  }
  return A.transpose() * Stacked(linear, angular).asDiagonal() * A;
}

// A pose that rotates by the vector r [rad] and has no translation.
Pose Turned(const Vector3& r) {
  Pose X = Pose::Identity();
  X.linear() = ExpRotation(r);
  return X;
}

// Kinetic energy [J] of the virtual tool.
double Energy(const AdmittanceParams& params, const Matrix3& R_WT, const Twist& V_WT) {
  const Vector6d V_T = Stacked(R_WT.transpose() * V_WT.v, R_WT.transpose() * V_WT.w);
  return 0.5 * V_T.dot(MassMatrix(params) * V_T);
}

// Oracle: the implicit step, solved with dense matrices by Eigen's pivoted LU.
TEST(AdmittanceCentre, EqualsTheSolutionWithDenseMatrices) {
  Draw draw(11);
  for (int run = 0; run < 500; ++run) {
    const AdmittanceParams own = draw.Params();
    const double mass_factor = draw.Within(1.0, 3.0), damping_factor = draw.Within(1.0, 100.0);
    const AdmittanceParams params = ScaleLaw(own, mass_factor, damping_factor);
    const Matrix6 M = mass_factor * FullMatrix(own.mass_kg, own.inertia_kg_m2, own.centre_T_m);
    const Matrix6 D =
        damping_factor * FullMatrix(own.damping_Ns_per_m, own.damping_Nms_per_rad, own.centre_T_m);
    EXPECT_LT((MassMatrix(params) - M).norm(), 1e-13 * M.norm());
    EXPECT_LT((DampingMatrix(params) - D).norm(), 1e-13 * D.norm());

    const Pose X_WT = Turned(draw.Box(2.0));
    const Matrix3 R = X_WT.linear();
    const Twist V{.v = draw.Box(0.3), .w = draw.Box(2.0)};
    const Wrench F{.f = draw.Box(200.0), .t = draw.Box(20.0)};
    Twist next;
    ASSERT_TRUE(NextTwist(params, {.X_WT = X_WT, .V_WT = V, .F_T_W = F, .dt_s = kDt_s}, next));

    // the law keeps the velocity that the centre had one step earlier, when the tool was rotated less
    const Vector3 c_W = R * own.centre_T_m, c_before_W = ExpRotation(-kDt_s * V.w) * c_W;
    const Vector3 v_W = V.v + V.w.cross(c_before_W) - V.w.cross(c_W);
    const Vector6d V_T = Stacked(R.transpose() * v_W, R.transpose() * V.w);
    const Vector6d F_T = Stacked(R.transpose() * F.f, R.transpose() * F.t);
    const Vector6d wanted = (M + kDt_s * D).fullPivLu().solve(M * V_T + kDt_s * F_T);
    const Vector6d found = Stacked(R.transpose() * next.v, R.transpose() * next.w);
    // the lever, and the ratio of mass to inertia, cause a condition number of about 1e4
    EXPECT_LT((found - wanted).norm(), 1e-11 * wanted.norm()) << "run " << run;
  }
}

// With the centre at To, the step must equal the simple law for each axis, bit for bit.
TEST(AdmittanceCentre, AtTheOriginEqualsTheLawByAxisBitForBit) {
  Draw draw(12);
  for (int run = 0; run < 200; ++run) {
    AdmittanceParams params = draw.Params();
    params.centre_T_m.setZero();
    const Pose X_WT = Turned(draw.Box(2.0));
    const Matrix3 R = X_WT.linear();
    const Twist V{.v = draw.Box(0.3), .w = draw.Box(2.0)};
    const Wrench F{.f = draw.Box(200.0), .t = draw.Box(20.0)};
    Twist next;
    ASSERT_TRUE(NextTwist(params, {.X_WT = X_WT, .V_WT = V, .F_T_W = F, .dt_s = kDt_s}, next));
    const auto by_axis = [&](const Vector3& v_W, const Vector3& f_W, const Vector3& m,
                             const Vector3& b) -> Vector3 {
      const Vector3 v = R.transpose() * v_W, f = R.transpose() * f_W;
      Vector3 out;
      for (int i = 0; i < 3; ++i) out[i] = (v[i] + kDt_s / m[i] * f[i]) / (1.0 + kDt_s * b[i] / m[i]);
      return R * out;
    };
    const Vector3 v = by_axis(V.v, F.f, params.mass_kg, params.damping_Ns_per_m);
    const Vector3 w = by_axis(V.w, F.t, params.inertia_kg_m2, params.damping_Nms_per_rad);
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(std::bit_cast<std::uint64_t>(next.v[i]), std::bit_cast<std::uint64_t>(v[i]));
      EXPECT_EQ(std::bit_cast<std::uint64_t>(next.w[i]), std::bit_cast<std::uint64_t>(w[i]));
    }
  }
}

// A rigid body that is pushed at its centre C does not turn, and resists with the mass m of the axis. If it
// is pushed at To, at the lever L, it also turns, and its felt mass follows from 1 / m_felt = 1/m + L² / I
// with the inertia I.
TEST(AdmittanceCentre, APushAtTheCentreFeelsTheMassAndAtTheApexAlsoTheLever) {
  AdmittanceParams params;
  params.mass_kg = {2.0, 3.0, 7.0};
  params.inertia_kg_m2 = {0.2, 0.3, 0.4};
  params.damping_Ns_per_m.setConstant(1e-6);
  params.damping_Nms_per_rad.setConstant(1e-6);
  params.centre_T_m = {0.0, 0.0, -0.25};
  const Pose X_WT = Turned({0.3, -0.5, 1.1});
  const Matrix3 R = X_WT.linear();
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 f_W = 10.0 * R.col(axis);
    const Vector3 c_W = R * params.centre_T_m;
    Twist V;
    ASSERT_TRUE(
        NextTwist(params, {.X_WT = X_WT, .F_T_W = {.f = f_W, .t = c_W.cross(f_W)}, .dt_s = kDt_s}, V));
    EXPECT_LT(V.w.norm(), 1e-15) << axis;
    const double a = R.col(axis).dot(V.v) / kDt_s;
    EXPECT_NEAR(10.0 / a, params.mass_kg[axis], 1e-8 * params.mass_kg[axis]) << axis;
  }
  Twist V;
  ASSERT_TRUE(NextTwist(
      params, {.X_WT = X_WT, .F_T_W = {.f = 10.0 * R.col(0), .t = Vector3::Zero()}, .dt_s = kDt_s}, V));
  const double felt_kg = 10.0 / (R.col(0).dot(V.v) / kDt_s);
  EXPECT_NEAR(1.0 / felt_kg, 1.0 / 2.0 + 0.25 * 0.25 / 0.3, 1e-8) << "turns about y";
}

// A free body rotates about its centre. The centre must stay in place while To moves on a circle around it,
// and the body must not gain energy.
TEST(AdmittanceCentre, AFreeBodyKeepsItsEnergyAndItsCentreWhileItTurns) {
  AdmittanceParams params;
  params.mass_kg.setConstant(3.0);
  params.inertia_kg_m2.setConstant(0.15);
  params.damping_Ns_per_m.setConstant(1e-9);
  params.damping_Nms_per_rad.setConstant(1e-9);
  params.centre_T_m = {0.05, 0.0, -0.25};
  const Vector3 w(0.4, 1.2, -0.3);
  AdmittanceState state{.X_WT = Turned({0.2, 0.1, 0.0}), .V_WT = {}};
  // the law assumes that the velocity of To belongs to the orientation one step earlier
  state.V_WT = {.v = -w.cross(ExpRotation(-kDt_s * w) * (state.X_WT.linear() * params.centre_T_m)), .w = w};
  const Vector3 centre = state.X_WT * params.centre_T_m;
  double energy = 0.5 * 0.15 * w.squaredNorm();
  const double first = energy;
  for (int i = 0; i < 20'000; ++i) {
    const Matrix3 R = state.X_WT.linear();
    Twist V;
    ASSERT_TRUE(NextTwist(params, {.X_WT = state.X_WT, .V_WT = state.V_WT, .dt_s = kDt_s}, V));
    const double now = Energy(params, R, V);
    ASSERT_LE(now, energy * (1.0 + 1e-14)) << "tick " << i;
    energy = now;
    state = {.X_WT = IntegratePose(state.X_WT, V, kDt_s), .V_WT = V};
  }
  EXPECT_NEAR(energy, first, 1e-6 * first) << "the drag is 1e-9";
  // IntegratePose moves To along a straight line instead of its arc. That shifts the centre by w² c dt² / 2
  // per tick
  EXPECT_LT((state.X_WT * params.centre_T_m - centre).norm(), 1e-3);
}

// For each axis at C and any step dt, the speed v+ after the step obeys |v+| <= max(|v|, |F|/b), with the
// speed v before, the force F and the damping b. This gives the bound of the energy below.
TEST(AdmittanceCentre, TheEnergyIsBoundedForAnyStep) {
  Draw draw(13);
  for (const double dt_s : {1e-4, 1e-3, 0.1, 10.0}) {
    for (int run = 0; run < 200; ++run) {
      const AdmittanceParams params = draw.Params();
      const Pose X_WT = Turned(draw.Box(2.0));
      const Matrix3 R = X_WT.linear();
      const Twist V{.v = draw.Box(0.3), .w = Vector3::Zero()};
      const Wrench F{.f = draw.Box(200.0), .t = draw.Box(20.0)};
      Twist next;
      ASSERT_TRUE(NextTwist(params, {.X_WT = X_WT, .V_WT = V, .F_T_W = F, .dt_s = dt_s}, next));
      const Vector3 f_T = R.transpose() * F.f, v_T = R.transpose() * V.v;
      const Vector3 t_C = R.transpose() * F.t - params.centre_T_m.cross(f_T);
      double max_J = 0.0;
      for (int i = 0; i < 3; ++i) {
        const double v = std::max(std::abs(v_T[i]), std::abs(f_T[i]) / params.damping_Ns_per_m[i]);
        const double w = std::abs(t_C[i]) / params.damping_Nms_per_rad[i];
        max_J += 0.5 * (params.mass_kg[i] * v * v + params.inertia_kg_m2[i] * w * w);
      }
      ASSERT_LE(Energy(params, R, next), max_J * (1.0 + 1e-12)) << dt_s << " run " << run;
    }
  }
}

TEST(AdmittanceCentre, ALockedAxisDoesNotMoveAndPassesNoForceToOtherAxes) {
  Draw draw(14);
  for (int run = 0; run < 200; ++run) {
    AdmittanceParams params = draw.Params();
    params.locked = {true, true, false, true, true, true};
    const Pose X_WT = Turned(draw.Box(2.0));
    const Matrix3 R = X_WT.linear();
    const Twist V{.v = 0.2 * R.col(2), .w = Vector3::Zero()};
    const Vector3 along = draw.Within(-100.0, 100.0) * R.col(2);
    const auto next_of = [&](const Wrench& F) {
      Twist next;
      EXPECT_TRUE(NextTwist(params, {.X_WT = X_WT, .V_WT = V, .F_T_W = F, .dt_s = kDt_s}, next));
      return next;
    };
    // a force across z, the only free axis, or a torque must change nothing
    const Twist plain = next_of({.f = along, .t = Vector3::Zero()});
    const Twist pressed = next_of({.f = along + 80.0 * R.col(0) - 150.0 * R.col(1), .t = draw.Box(20.0)});
    EXPECT_EQ(plain.w, Vector3::Zero());
    EXPECT_EQ(pressed.w, Vector3::Zero());
    const Vector3 v_T = R.transpose() * pressed.v;
    EXPECT_LT(std::hypot(v_T.x(), v_T.y()), 1e-15) << "the turn of axes rounds";
    EXPECT_NEAR((pressed.v - plain.v).norm(), 0.0, 1e-14);
    params.locked = {};
    EXPECT_GT(next_of({.f = 80.0 * R.col(0), .t = Vector3::Zero()}).w.norm(), 1e-6) << "unlocked it would";
  }
}

TEST(AdmittanceCentre, ALockedAxisMovesWithTheVelocityGivenForIt) {
  AdmittanceParams params;
  params.centre_T_m = {0.0, 0.1, -0.2};
  params.locked = {true, false, false, false, false, true};
  Twist V;
  ASSERT_TRUE(NextTwist(
      params,
      {.X_WT = Pose::Identity(), .dt_s = kDt_s, .V_held_C = {.v = {0.01, 9.0, 9.0}, .w = {9.0, 9.0, 0.05}}},
      V));
  const Vector3 v_C = V.v + V.w.cross(params.centre_T_m);
  EXPECT_LT((v_C - Vector3(0.01, 0.0, 0.0)).norm(), 1e-15) << "free axes are not held";
  EXPECT_EQ(V.w, Vector3(0.0, 0.0, 0.05));
}

TEST(AdmittanceCentre, AChangeOfMassAddsNoEnergyAndLighterAxesKeepTheirVelocity) {
  Draw draw(15);
  for (int run = 0; run < 500; ++run) {
    const AdmittanceParams before = draw.Params();
    AdmittanceParams after = draw.Params();
    after.centre_T_m = before.centre_T_m;
    const Matrix3 R = ExpRotation(draw.Box(2.0));
    const Twist V{.v = draw.Box(0.3), .w = draw.Box(2.0)};
    const Twist next = AfterMassChange(before, after, R, V);
    EXPECT_LE(Energy(after, R, next), Energy(before, R, V) * (1.0 + 1e-12));
    const Vector3 w_T = R.transpose() * V.w, w_next_T = R.transpose() * next.w;
    for (int i = 0; i < 3; ++i)
      if (after.inertia_kg_m2[i] < before.inertia_kg_m2[i]) {
        EXPECT_NEAR(w_next_T[i], w_T[i], 1e-14);
      }
  }
}

TEST(AdmittanceCentre, DoesNotAllocate) {
  AdmittanceParams params;
  params.centre_T_m = {0.1, 0.2, -0.3};
  params.locked[0] = true;
  Twist V;
  rt::CheckedNoAllocScope no_alloc;
  const bool ok = NextTwist(params,
                            {.X_WT = Turned({0.1, 0.2, 0.3}),
                             .V_WT = {.v = {0.1, 0.0, 0.0}, .w = {0.0, 1.0, 0.0}},
                             .F_T_W = {.f = {1.0, 2.0, 3.0}, .t = {0.1, 0.2, 0.3}},
                             .dt_s = kDt_s},
                            V);
  no_alloc.End();
  EXPECT_TRUE(ok);
}

}  // namespace
}  // namespace osteon::control
