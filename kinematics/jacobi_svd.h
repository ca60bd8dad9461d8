#pragma once

#include "base/marker.h"
#include "kinematics/spatial.h"

namespace osteon::kinematics {

/// Singular value decomposition J = U diag(sigma) V^T of a Jacobian, 6 x N with N >= 6.
template <int N>
struct JacobianSvd {
  Eigen::Matrix<double, 6, 6> U{Eigen::Matrix<double, 6, 6>::Identity()};  ///< columns: left singular vectors
  Eigen::Matrix<double, 6, 1> sigma{Eigen::Matrix<double, 6, 1>::Zero()};  ///< descending, >= 0
  /// Columns: right singular vectors; those after the sixth span the null space.
  Eigen::Matrix<double, N, N> V{Eigen::Matrix<double, N, N>::Identity()};
  int sweeps{0};  ///< number of sweeps over all pairs of rows until the rows were orthogonal
};

/// Computes the decomposition by one-sided Jacobi rotations: pairs of rows of U^T J are rotated against
/// each other until all are orthogonal. Small singular values are as accurate as large ones. Right
/// singular vectors with a sigma below 1e-14 of the largest can't be computed from J: they are chosen so that
/// V stays orthogonal. The rotations start from `near`: the U of a similar Jacobian (that of the tick before)
/// saves most of the sweeps; any other orthogonal matrix gives the same singular values.
///
/// Source: Hestenes, Inversion of Matrices by Biorthogonalization, J. SIAM 6, 1958; Demmel and Veselić,
/// Jacobi's Method Is More Accurate than QR, SIAM J. Matrix Anal. 13, 1992.
/// @pre J and `near` are finite, and the columns of `near` are orthonormal within 1e-9.
template <int N>
[[nodiscard]] JacobianSvd<N> ComputeJacobianSvd(const Eigen::Matrix<double, 6, N>& J,
                                                const Eigen::Matrix<double, 6, 6>& near) OSTEON_RT;

}  // namespace osteon::kinematics
