#pragma once

#include <memory>
#include <vector>

#include "studies/stability/measured_loop.h"
#include "studies/stability/overlay_loop.h"

// Judges the loop of the impedance law by a measured response of the arm along one axis.

namespace osteon::studies {

/// The measured response of an arm to a force that FRI's wrench or torque overlay adds, along one axis.
struct MeasuredOverlayParams {
  Vector3 axis_T{Vector3::UnitZ()};  ///< direction of force and motion in the tool's frame, unit
  double dead_time_s{0.0};           ///< from a force to its first effect
  std::vector<PlantLine> lines{};    ///< x / f [m/N], sampled: the dead time is included
};

/// The arm's seven joints as in the model, with a correction that makes the response along the measured axis
/// equal to the measured one:
///
///     C' = C + (G / h - a^T C a) (C a a^T C) / (a^T C a)^2
///
/// with the model's compliance C of the joints, a = J^T axis, and the measured response G = x / f. The factor
/// h stands for the delay and the zero-order hold of a sent force: G contains them, C' does not.
///
/// The loop is stable if det(I + C' D) does not encircle 0. D is the dynamic stiffness of the hand, the law,
/// the wall, and the arm's own equilibrium, which follows the measured joints. Friction is included to the
/// extent that the measured G contains it.
class MeasuredOverlay {
 public:
  /// @param model  the arm, its own impedance and the period; its hand and wall are not used
  /// @throws std::invalid_argument if the lines are not a valid response
  MeasuredOverlay(const OverlayLoopParams& model, const MeasuredOverlayParams& measured);

  /// Judges the loop with the hand, law and wall of `loop`; the wall's normal is the measured axis. For the
  /// margins the loop is opened at the force that the wall and the law's damping exert along this axis, while
  /// all other loops are closed. LoopMargins::gain is then a factor on wall and damping together.
  /// @param late_s  additional delay of each command, beyond the measured delay
  [[nodiscard]] LoopMargins Judge(const OverlayLoopParams& loop, double late_s) const;
  [[nodiscard]] bool IsStable(const OverlayLoopParams& loop, double late_s) const;
  /// The Nyquist curve that Judge() uses.
  [[nodiscard]] std::vector<NyquistPoint> Curve(const OverlayLoopParams& loop, double late_s) const;

 private:
  using Matrix7c = Eigen::Matrix<std::complex<double>, 7, 7>;
  struct Point {
    double hz{0.0};
    std::complex<double> z;  // e^(j w T)
    // delay of a sent force, including half of the period for which the force is held
    std::complex<double> delay;
    Matrix7c compliance;  // compliance C' of the joints
    Matrix7c slope;       // change of C' per relative change of G
    double share{0.0};    // standard deviation of G, divided by its size
  };
  struct Evaluation {  // result for a loop, at all points
    std::vector<NyquistPoint> curve;
    int unstable_poles{0};
  };
  [[nodiscard]] Evaluation Evaluate(const OverlayLoopParams& loop, double late_s) const;

  double period_s_;
  Vector3 axis_T_;
  Eigen::Matrix<double, 6, 7> J_;
  Matrix3 R_BT_{Matrix3::Identity()};
  Eigen::Matrix<double, 7, 1> along_;   // a = J^T axis
  Eigen::Matrix<double, 7, 7> follow_;  // stiffness of the equilibrium's spring: the inverse of C' at rest
  std::vector<Point> points_;
};

}  // namespace osteon::studies
