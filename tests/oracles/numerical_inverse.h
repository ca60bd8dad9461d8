#pragma once

#include "base/marker.h"
#include "kinematics/serial_chain.h"

// Iterative inverse kinematics for an arm of 6 or 7 joints whose axes allow no closed form: a wrist whose
// axes do not meet, links with lateral offsets. For all others use LbrArm and OrthoParallelArm: they give
// every solution, report by how much a pose is out of reach, and are a hundred times faster.

namespace osteon::kinematics {

struct NumericalInverseParams {
  double tolerance_m{1e-9};    ///< largest position error of a reached pose
  double tolerance_rad{1e-9};  ///< largest orientation error of a reached pose
  double length_m{0.5};        ///< weighs orientation against position: 1 rad counts as this length; > 0
  int max_iterations{60};      ///< maximum for one attempt
  int max_restarts{40};        ///< further attempts from other points if the one from the seed fails
};

/// Why the iteration ended.
enum class InverseStop {
  kReached,
  kHeldByLimits,   ///< a step that comes closer would take a joint out of its limits
  kLocalMinimum,   ///< no step comes closer: the pose is out of reach, or the elbow is on the wrong side
  kMaxIterations,  ///< the limit of iterations was reached while steps still came closer
  kNotFinite,      ///< the pose or the seed is not finite
};

[[nodiscard]] const char* Name(InverseStop stop) OSTEON_RT;

template <int N>
struct NumericalInverseResult {
  JointVectorN<N> q{JointVectorN<N>::Zero()};  ///< [rad], within the limits: the closest that was found
  InverseStop stop{InverseStop::kNotFinite};   ///< why the attempt that gave q ended
  double error_m{0.0};
  double error_rad{0.0};
  int iterations{0};  ///< in all attempts together
  int restarts{0};

  [[nodiscard]] bool reached() const noexcept { return stop == InverseStop::kReached; }
};

/// Levenberg-Marquardt on the logarithm of the pose's error, within the joint limits.
///
///     minimize  |p_FD|^2 + length^2 |log R_FD|^2        over lower <= q <= upper
///     (J^T J + mu I) dq = J^T e,   mu = factor cost
///
/// with e = (p_FD, length log R_FD) and J the geometric Jacobian, whose rotation rows are scaled by `length`
/// too. Position and rotation errors are separate, so J^T e is the exact gradient for any size of the error
/// (the derivative of the logarithm leaves its own vector unchanged). A minimum can therefore be recognised.
/// A joint at its limit stays there if the step would lead beyond the limit; the other joints' steps end at
/// their limits. The damping mu falls with the error, so that convergence is quadratic at the end, and rises
/// if a step fails. Further attempts begin at points of a Halton sequence within the limits. At most (1 +
/// max_restarts) max_iterations steps are made, which takes some milliseconds. The function is therefore for
/// set-up, not for a tick, although it does not allocate. Its result is deterministic.
/// @param seed where to begin; moved into the limits.
/// Source: Sugihara, Solvability-Unconcerned Inverse Kinematics by the Levenberg-Marquardt Method, IEEE
/// Trans. Robotics 27 (5), 2011, for the damping; Kanzow, Yamashita, Fukushima, J. Comput. Appl. Math. 172,
/// 2004, for the bounds.
template <int N>
[[nodiscard]] NumericalInverseResult<N> NumericalInverse(const SerialChain<N>& chain, const Pose& X_BF,
                                                         const JointVectorN<N>& seed,
                                                         const NumericalInverseParams& params = {}) OSTEON_RT;

extern template NumericalInverseResult<6> NumericalInverse(const SerialChain<6>&, const Pose&,
                                                           const JointVectorN<6>&,
                                                           const NumericalInverseParams&) OSTEON_RT;
extern template NumericalInverseResult<7> NumericalInverse(const SerialChain<7>&, const Pose&,
                                                           const JointVectorN<7>&,
                                                           const NumericalInverseParams&) OSTEON_RT;

}  // namespace osteon::kinematics
