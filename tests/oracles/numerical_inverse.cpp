#include "tests/oracles/numerical_inverse.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

namespace osteon::kinematics {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double kMinFactor = 1e-6;    // smallest ratio of the damping to the cost
constexpr double kMinDamping = 1e-14;  // keeps the matrix positive definite at a singularity [m^2]
constexpr double kMaxDamping = 1e3;    // a thousand arms squared: steepest descent with a tiny step [m^2]
constexpr double kFlat = 1e-9;         // gradient over error below which there is no progress [m/rad]

// Point of the Halton sequence in the unit cube.
double Halton(int index, int dimension) {
  constexpr std::array<int, 7> kBase{2, 3, 5, 7, 11, 13, 17};
  const int base = kBase[static_cast<std::size_t>(dimension)];
  double digit = 1.0, value = 0.0;
  for (int rest = index; rest > 0; rest /= base) {
    digit /= base;
    value += digit * (rest % base);
  }
  return value;
}

// A posture of the iteration, with its error from the wanted pose X_BD.
template <int N>
struct IterationState {
  JointVectorN<N> q;
  typename SerialChain<N>::Posture posture;
  Vector6 error;  // position [m], then rotation times length_m [m], in B
  double cost;

  IterationState(const SerialChain<N>& chain, const Pose& X_BD, double length_m, const JointVectorN<N>& at)
      : q(at), posture(chain.ComputePosture(at)) {
    const Matrix3 R_BF = posture.X_BF.linear();
    error.head<3>() = X_BD.translation() - posture.X_BF.translation();
    error.tail<3>() = length_m * (R_BF * LogRotation(R_BF.transpose() * X_BD.linear()));
    cost = error.squaredNorm();
  }
};

template <int N>
JointVectorN<N> ClampToLimits(const ChainParams<N>& params, JointVectorN<N> q) {
  for (int i = 0; i < N; ++i) {
    const JointLimits& limit = params.joints[static_cast<std::size_t>(i)].limits;
    q[i] = std::clamp(q[i], limit.lower_rad, limit.upper_rad);
  }
  return q;
}

// Runs one attempt from `at`, leaves the best posture there, and counts the iterations.
template <int N>
InverseStop Iterate(const SerialChain<N>& chain, const Pose& X_BD, const NumericalInverseParams& params,
                    IterationState<N>& at, int& iterations) {
  double factor = 1.0;
  for (int n = 0; n < params.max_iterations; ++n, ++iterations) {
    if (at.error.template head<3>().norm() <= params.tolerance_m &&
        at.error.template tail<3>().norm() <= params.tolerance_rad * params.length_m)
      return InverseStop::kReached;

    // compute the step of the free joints: the row and column of a joint that stays at its limit are those of
    // the identity
    JacobianN<N> J = chain.Jacobian(at.posture);
    J.template bottomRows<3>() *= params.length_m;
    JointVectorN<N> downhill = J.transpose() * at.error;
    bool held = false;
    for (int i = 0; i < N; ++i) {
      const JointLimits& limit = chain.params().joints[static_cast<std::size_t>(i)].limits;
      const bool outwards = (at.q[i] <= limit.lower_rad && downhill[i] < 0.0) ||
                            (at.q[i] >= limit.upper_rad && downhill[i] > 0.0);
      if (!outwards) continue;
      held = true;
      downhill[i] = 0.0;
      J.col(i).setZero();
    }
    const InverseStop stuck = held ? InverseStop::kHeldByLimits : InverseStop::kLocalMinimum;
    if (downhill.norm() <= kFlat * std::sqrt(at.cost)) return stuck;

    // increase the damping until the error falls
    const JointMatrixN<N> normal = J.transpose() * J;
    while (true) {
      JointMatrixN<N> damped = normal;
      damped.diagonal().array() += factor * at.cost + kMinDamping;
      const JointVectorN<N> step = damped.ldlt().solve(downhill);
      const IterationState<N> next(chain, X_BD, params.length_m,
                                   ClampToLimits<N>(chain.params(), at.q + step));
      if (next.cost < at.cost) {
        at = next;
        factor = std::max(kMinFactor, 0.2 * factor);
        break;
      }
      factor *= 5.0;
      if (!(factor * at.cost < kMaxDamping)) return stuck;
    }
  }
  return InverseStop::kMaxIterations;
}

}  // namespace

const char* Name(InverseStop stop) OSTEON_RT {
  switch (stop) {
    case InverseStop::kReached:
      return "reached";
    case InverseStop::kHeldByLimits:
      return "held by joint limits";
    case InverseStop::kLocalMinimum:
      return "no nearer from here";
    case InverseStop::kMaxIterations:
      return "iterations used up";
    case InverseStop::kNotFinite:
      return "not finite";
  }
  return "unknown";
}

template <int N>
NumericalInverseResult<N> NumericalInverse(const SerialChain<N>& chain, const Pose& X_BF,
                                           const JointVectorN<N>& seed,
                                           const NumericalInverseParams& params) OSTEON_RT {
  NumericalInverseResult<N> result;
  result.q = seed;
  if (!seed.allFinite() || !std::isfinite(X_BF.linear().sum() + X_BF.translation().sum())) return result;

  double least = std::numeric_limits<double>::infinity();
  for (int attempt = 0; attempt <= params.max_restarts; ++attempt) {
    JointVectorN<N> start = ClampToLimits<N>(chain.params(), seed);
    for (int i = 0; i < N && attempt > 0; ++i) {
      const JointLimits& limit = chain.params().joints[static_cast<std::size_t>(i)].limits;
      start[i] = limit.lower_rad + (limit.upper_rad - limit.lower_rad) * Halton(attempt, i);
    }
    IterationState<N> at(chain, X_BF, params.length_m, start);
    const InverseStop stop = Iterate(chain, X_BF, params, at, result.iterations);
    result.restarts = attempt;
    if (stop == InverseStop::kReached || at.cost < least) {
      least = at.cost;
      result.q = at.q;
      result.stop = stop;
      result.error_m = at.error.template head<3>().norm();
      result.error_rad = at.error.template tail<3>().norm() / params.length_m;
    }
    if (stop == InverseStop::kReached) break;
  }
  return result;
}

template NumericalInverseResult<6> NumericalInverse(const SerialChain<6>&, const Pose&,
                                                    const JointVectorN<6>&,
                                                    const NumericalInverseParams&) OSTEON_RT;
template NumericalInverseResult<7> NumericalInverse(const SerialChain<7>&, const Pose&,
                                                    const JointVectorN<7>&,
                                                    const NumericalInverseParams&) OSTEON_RT;

}  // namespace osteon::kinematics
