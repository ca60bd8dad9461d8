#include "studies/stability/measured_overlay.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "kinematics/serial_chain.h"
#include "studies/stability/impedance_arm.h"

namespace osteon::studies {
namespace {

using Complex = std::complex<double>;
using Matrix7c = Eigen::Matrix<Complex, 7, 7>;
using Vector7c = Eigen::Matrix<Complex, 7, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr int kPoints = 500;  // number of frequencies of the curve, evenly spaced in the logarithm
// Lowest frequency of the curve: there every factor of the determinant is almost real.
constexpr double kLowest_hz = 1e-4;
constexpr double kTwoPi = 2.0 * std::numbers::pi;
// Radius of the disc that contains 95 % of a plane's normal distribution with standard deviation 1.
constexpr double k95 = 2.4477468306808161;

// Factor on a force at one frequency: it is sent at a tick, acts after the dead time, and is held for a
// period.
Complex HeldDelay(double hz, double dead_time_s, double period_s) {
  const double half = 0.5 * kTwoPi * hz * period_s;
  return std::polar(half > 0.0 ? std::sin(half) / half : 1.0, -kTwoPi * hz * dead_time_s - half);
}

// Displacement of the joints per torque on them, at one frequency [rad/N m].
Matrix7c ComplianceOf(const ImpedanceArm& arm, double hz) {
  const double w = kTwoPi * hz;
  const Matrix7c stiffness = arm.stiffness.cast<Complex>() + Complex(0.0, w) * arm.damping.cast<Complex>() -
                             w * w * arm.inertia.cast<Complex>();
  return stiffness.inverse();
}

// The law's damping matrix (v, w), rotated from the tool's axes into the base's.
Matrix6 DampingOf(const control::ImpedanceParams& law, const Matrix3& R_BT) {
  Matrix6 D = Matrix6::Zero();
  D.topLeftCorner<3, 3>() = R_BT * law.damping_Ns_per_m.asDiagonal() * R_BT.transpose();
  D.bottomRightCorner<3, 3>() = R_BT * law.damping_Nms_per_rad.asDiagonal() * R_BT.transpose();
  return D;
}

}  // namespace

MeasuredOverlay::MeasuredOverlay(const OverlayLoopParams& model, const MeasuredOverlayParams& measured)
    : period_s_(model.period_s), axis_T_(measured.axis_T) {
  ImpedanceArmParams arm_params{.chain = model.chain,
                                .arm = model.arm,
                                .X_FT = model.X_FT,
                                .q = model.q,
                                .gravity_B = model.gravity_B,
                                .torque = model.torque};
  for (kinematics::RevoluteJoint& joint : arm_params.chain.joints) joint.friction = {};
  const ImpedanceArm arm = ImpedanceArmAt(arm_params);
  J_ = arm.J;
  R_BT_ = (kinematics::SerialChain<7>(arm_params.chain, arm_params.gravity_B).FlangePose(arm_params.q) *
           arm_params.X_FT)
              .linear();
  along_ = J_.topRows<3>().transpose() * (R_BT_ * axis_T_);
  const Vector7c a = along_.cast<Complex>();
  const auto model_at = [&](double hz) {
    return HeldDelay(hz, measured.dead_time_s, period_s_) * (a.transpose() * ComplianceOf(arm, hz) * a)(0);
  };
  const MeasuredPlant plant(measured.lines, model_at, period_s_);

  for (int i = 0; i < kPoints; ++i) {
    const double hz =
        kLowest_hz * std::pow(0.5 / (period_s_ * kLowest_hz), static_cast<double>(i) / (kPoints - 1));
    const MeasuredPlant::RatioAt ratio = plant.RatioToModel(hz);
    // The response to a constant force is real. So below the lowest line its phase falls to 0.
    const Complex factor =
        std::polar(std::abs(ratio.value), std::arg(ratio.value) * std::min(1.0, hz / plant.lowest_hz()));
    const Matrix7c C = ComplianceOf(arm, hz);
    const Vector7c moved = C * a;
    // The part of the compliance C that acts along the measured axis.
    const Matrix7c along = moved * (a.transpose() * C) / (a.transpose() * moved)(0);
    points_.push_back({.hz = hz,
                       .z = std::polar(1.0, kTwoPi * hz * period_s_),
                       .delay = HeldDelay(hz, measured.dead_time_s, period_s_),
                       .compliance = C + (factor - 1.0) * along,
                       .slope = factor * along,
                       .share = ratio.share});
  }
  follow_ = points_.front().compliance.real().inverse();
}

MeasuredOverlay::Evaluation MeasuredOverlay::Evaluate(const OverlayLoopParams& loop, double late_s) const {
  const double T = period_s_, filter_share = T / (T + loop.law.twist_filter_s),
               follow_share = T / (T + loop.law.follow_s);
  const Vector7c a = along_.cast<Complex>();
  const double along_Ns_per_m = loop.law.damping_Ns_per_m.dot(axis_T_.cwiseAbs2());
  const Matrix6 D = DampingOf(loop.law, R_BT_);
  const Matrix7c damping =
                     (J_.transpose() * D * J_ - along_Ns_per_m * along_ * along_.transpose()).cast<Complex>(),
                 spring = follow_.cast<Complex>();
  const double lever2_m2 = OverlayLoop::lever2_m2();
  const Eigen::Matrix<double, 7, 7> by_hand = J_.transpose() * DiagonalOfTwist(1.0, lever2_m2) * J_;
  Evaluation evaluation;
  evaluation.curve.reserve(points_.size());
  double angle = 0.0;
  Complex last_determinant = 1.0;
  // At each frequency, `law` is the loop of the wall and of the damping along the axis. `other_stiffness` is
  // everything else that acts on the arm, with its loop closed. `by_ratio` is the change of L per relative
  // change of the measured G.
  for (const Point& at : points_) {
    const double w = kTwoPi * at.hz;
    const Complex one_tick_late = 1.0 / at.z;
    const Complex velocity =
                      filter_share / (1.0 - (1.0 - filter_share) * one_tick_late) * (1.0 - one_tick_late) / T,
                  equilibrium = follow_share / (1.0 - (1.0 - follow_share) * one_tick_late),
                  delay = at.delay * std::polar(1.0, -w * late_s),
                  hand(loop.hand.stiffness_N_per_m - w * w * loop.hand.mass_kg,
                       w * loop.hand.damping_Ns_per_m),
                  law = delay * (loop.wall.stiffness_N_per_m * std::pow(one_tick_late, loop.wall.age_ticks) +
                                 along_Ns_per_m * velocity);
    const Matrix7c other_stiffness =
        hand * by_hand.cast<Complex>() + delay * (velocity * damping - equilibrium * spring);
    const Eigen::PartialPivLU<Matrix7c> closed(Matrix7c::Identity() + at.compliance * other_stiffness);
    const Vector7c moved = closed.solve(at.compliance * a);
    const Complex L = law * (a.transpose() * moved)(0),
                  by_ratio =
                      law * (a.transpose() * closed.solve(at.slope * (a - other_stiffness * moved)))(0),
                  loop_determinant = closed.determinant() * (1.0 + L);
    evaluation.curve.push_back({.hz = at.hz, .loop = L, .radius = k95 * at.share * std::abs(by_ratio)});
    angle += std::arg(evaluation.curve.size() == 1 ? loop_determinant : loop_determinant / last_determinant);
    last_determinant = loop_determinant;
  }
  evaluation.unstable_poles = -static_cast<int>(std::lround(angle / std::numbers::pi));
  return evaluation;
}

LoopMargins MeasuredOverlay::Judge(const OverlayLoopParams& loop, double late_s) const {
  const Evaluation evaluation = Evaluate(loop, late_s);
  LoopMargins margins{.stable = evaluation.unstable_poles == 0, .unstable_poles = evaluation.unstable_poles};
  FindMargins(evaluation.curve, margins);
  return margins;
}

bool MeasuredOverlay::IsStable(const OverlayLoopParams& loop, double late_s) const {
  return Evaluate(loop, late_s).unstable_poles == 0;
}

std::vector<NyquistPoint> MeasuredOverlay::Curve(const OverlayLoopParams& loop, double late_s) const {
  return Evaluate(loop, late_s).curve;
}

}  // namespace osteon::studies
