#include "kinematics/jacobi_svd.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace osteon::kinematics {
namespace {

// usually needed: five or six from the identity, one or two from the previous tick's U
constexpr int kMaxSweeps = 30;
constexpr double kOrthogonal = 4e-15;  // cosine below which two rows count as orthogonal
constexpr double kSmallTurn = 1e-4;    // for a smaller tangent t, t^4 is below a double's last bit
// a singular value below this fraction of the largest one determines no direction
constexpr double kNoDirection = 1e-14;
constexpr double kStillOrthogonal = 0x1p-40;  // if U^T U deviates from 1 by no more, `near` is used unchanged

// Fills the columns of V from number `from` on, so that V is orthonormal. Each column is made from the unit
// vector that is least contained in the columns before it, and orthogonalised twice to remove rounding
// errors.
template <int N>
void CompleteBasis(Eigen::Matrix<double, N, N>& V, int from) {
  for (int k = from; k < N; ++k) {
    int smallest = 0;
    double min_share = std::numeric_limits<double>::infinity();
    for (int i = 0; i < N; ++i) {
      const double share = V.row(i).head(k).squaredNorm();
      if (share >= min_share) continue;
      min_share = share;
      smallest = i;
    }
    Eigen::Matrix<double, N, 1> v = Eigen::Matrix<double, N, 1>::Unit(smallest);
    for (int twice = 0; twice < 2; ++twice)
      for (int j = 0; j < k; ++j) v -= V.col(j).dot(v) * V.col(j);
    V.col(k) = v.normalized();
  }
}

// Rotation that makes two columns orthogonal. a: dot product of the columns; b: difference of their squared
// lengths.
struct Turn {
  double c, s, tangent;
};
Turn TurnOf(double a, double b) {
  const double small = a / b;          // for small angles t = a / b (1 - (a / b)^2 + …)
  if (std::abs(small) < kSmallTurn) {  // the usual case with the previous tick's U: needs no square roots
    const double t = small - small * small * small, c = 1.0 - 0.5 * t * t;
    return {.c = c, .s = c * t, .tangent = t};
  }
  const double zeta = 0.5 * b / a;
  const double t = std::copysign(1.0 / (std::abs(zeta) + std::sqrt(1.0 + zeta * zeta)), zeta);
  const double c = 1.0 / std::sqrt(1.0 + t * t);
  return {.c = c, .s = c * t, .tangent = t};
}

// Restores the orthogonality of U to rounding, by Gram-Schmidt.
void MakeOrthonormal(Eigen::Matrix<double, 6, 6>& U) {
  for (int k = 0; k < 6; ++k) {
    for (int j = 0; j < k; ++j) U.col(k) -= U.col(j).dot(U.col(k)) * U.col(j);
    U.col(k).normalize();
  }
}

}  // namespace

template <int N>
JacobianSvd<N> ComputeJacobianSvd(const Eigen::Matrix<double, 6, N>& J,
                                  const Eigen::Matrix<double, 6, 6>& near) OSTEON_RT {
  JacobianSvd<N> out;
  Eigen::Matrix<double, 6, 6> U = near;
  if ((U.transpose() * U - Eigen::Matrix<double, 6, 6>::Identity()).cwiseAbs().maxCoeff() > kStillOrthogonal)
    MakeOrthonormal(U);
  Eigen::Matrix<double, N, 6> W = J.transpose() * U;  // columns sigma v
  Eigen::Matrix<double, 6, 1> squares;                // squared singular values

  bool turned = true;
  while (turned && out.sweeps < kMaxSweeps) {
    turned = false;
    ++out.sweeps;
    for (int k = 0; k < 6; ++k) squares[k] = W.col(k).squaredNorm();
    for (int p = 0; p < 5; ++p)
      for (int q = p + 1; q < 6; ++q) {
        const double dot = W.col(p).dot(W.col(q));
        if (!(dot * dot > kOrthogonal * kOrthogonal * squares[p] * squares[q])) continue;
        turned = true;
        const auto [c, s, tangent] = TurnOf(dot, squares[q] - squares[p]);
        const Eigen::Matrix<double, N, 1> w = W.col(p);
        W.col(p) = c * w - s * W.col(q);
        W.col(q) = s * w + c * W.col(q);
        const Eigen::Matrix<double, 6, 1> u = U.col(p);
        U.col(p) = c * u - s * U.col(q);
        U.col(q) = s * u + c * U.col(q);
        if (std::abs(tangent) < kSmallTurn) {
          squares[p] -= tangent * dot;
          squares[q] += tangent * dot;
        } else {
          squares[p] = W.col(p).squaredNorm();
          squares[q] = W.col(q).squaredNorm();
        }
      }
  }

  // sort the singular values in descending order; equal values keep their order
  std::array<int, 6> order{0, 1, 2, 3, 4, 5};
  for (std::size_t i = 1; i < 6; ++i)
    for (std::size_t k = i; k > 0 && squares[order[k]] > squares[order[k - 1]]; --k)
      std::swap(order[k], order[k - 1]);
  int known = 0;
  for (int k = 0; k < 6; ++k) {
    const int from = order[static_cast<std::size_t>(k)];
    out.U.col(k) = U.col(from);
    out.sigma[k] = std::sqrt(squares[from]);
    if (!(out.sigma[k] > kNoDirection * out.sigma[0])) continue;
    out.V.col(k) = W.col(from) / out.sigma[k];
    known = k + 1;
  }
  CompleteBasis<N>(out.V, known);
  return out;
}

template JacobianSvd<6> ComputeJacobianSvd<6>(const Eigen::Matrix<double, 6, 6>&,
                                              const Eigen::Matrix<double, 6, 6>&) OSTEON_RT;
template JacobianSvd<7> ComputeJacobianSvd<7>(const Eigen::Matrix<double, 6, 7>&,
                                              const Eigen::Matrix<double, 6, 6>&) OSTEON_RT;

}  // namespace osteon::kinematics
