#include <cassert>

#include <Eigen/Cholesky>

#include "kinematics/frame_turn.h"
#include "kinematics/serial_chain.h"

// Mass matrix, and the mobility of a point of the flange.

namespace osteon::kinematics {
namespace {

// Links i … N as one rigid body, in joint frame K(i) (serial_chain.h): mass, first moment h, second moments S
// = integral of r r^T dm.
struct Composite {
  double m{0.0};
  Triple<double> h{};
  Symmetric<double> S;

  // Expresses the body in the previous frame of the chain: rotates it, then moves it by p. With t the rotated
  // first moment and h' = t + m p the first moment after the move, the rotated S becomes S + t p^T + p h'^T.
  [[gnu::always_inline]] void ToParent(const FrameTurn& T, const Vector3& p) {
    S.ToParent(T);
    const Triple<double> t = T.ToParent(h);
    h = {t.x + m * p.x(), t.y + m * p.y(), t.z + m * p.z()};
    S.xx += p.x() * (t.x + h.x);
    S.yy += p.y() * (t.y + h.y);
    S.zz += p.z() * (t.z + h.z);
    S.xy += t.x * p.y() + p.x() * h.y;
    S.xz += t.x * p.z() + p.x() * h.z;
    S.yz += t.y * p.z() + p.y() * h.z;
  }
};

// Forces and torques for unit accelerations of the joints, all in one frame. Each Pair holds two joints.
struct Columns {
  Triple<Pair> f{}, t{};

  [[gnu::always_inline]] void ToParent(const FrameTurn& T, const Vector3& p) {
    f = T.ToParent(f);
    t = T.ToParent(t);
    t.x += p.y() * f.z - p.z() * f.y;
    t.y += p.z() * f.x - p.x() * f.z;
    t.z += p.x() * f.y - p.y() * f.x;
  }
};

}  // namespace

// Composite-rigid-body algorithm (CRBA), from the flange to the base. To accelerate joint i alone by 1
// rad/s^2, links i … N need the force z × h and the torque I z at the origin of link i, where z is the
// joint's axis, and h and I are first moment and inertia of these links. If this load is moved to a joint j
// nearer to the base, its torque about that joint's axis is M(j, i).
template <int N>
JointMatrixN<N> SerialChain<N>::MassMatrix(const Joints& q) const noexcept {
  assert(params_.has_masses);
  const SinCosN<kPadded> turn = SinCosOfTurns(q);
  std::array<Columns, kPadded / 2> columns;
  Composite body;
  JointMatrixN<N> M;
  for (std::size_t i = N; i-- > 0;) {
    const Body& link = bodies_[i];
    const Vector3& h = link.first_moment_kg_m;
    const Matrix3& S = link.second_moment_kg_m2;
    body.m += link.mass_kg;
    body.h = body.h + Triple<double>{h.x(), h.y(), h.z()};
    body.S.xx += S(0, 0);
    body.S.yy += S(1, 1);
    body.S.zz += S(2, 2);
    body.S.xy += S(0, 1);
    body.S.xz += S(0, 2);
    body.S.yz += S(1, 2);

    Columns& column = columns[i / 2];
    const std::size_t lane = i % 2;  // this joint's half of the pair
    column.f.x[lane] = -body.h.y;
    column.f.y[lane] = body.h.x;
    column.f.z[lane] = 0.0;
    column.t.x[lane] = -body.S.xz;
    column.t.y[lane] = -body.S.yz;
    column.t.z[lane] = body.S.xx + body.S.yy;
    for (std::size_t j = i; j < N; ++j)
      M(static_cast<int>(i), static_cast<int>(j)) = M(static_cast<int>(j), static_cast<int>(i)) =
          columns[j / 2].t.z[j % 2];
    M(static_cast<int>(i), static_cast<int>(i)) += params_.joints[i].rotor_inertia_kg_m2;
    if (i == 0) break;

    const Step& step = steps_[i];
    const FrameTurn T{step.cos_alpha, step.sin_alpha, turn.cos[i], turn.sin[i]};
    for (std::size_t pair = i / 2; pair < kPadded / 2; ++pair) columns[pair].ToParent(T, step.p);
    body.ToParent(T, step.p);
  }
  return M;
}

// With the Cholesky factor L, M = L L^T, and L Y = J^T, the mobility J M^-1 J^T is Y^T Y.
template <int N>
Eigen::Matrix<double, 6, 6> SerialChain<N>::Mobility(const Joints& q, const Vector3& p_B) const noexcept {
  Eigen::Matrix<double, N, 6> Y = JacobianAt(ComputePosture(q), p_B).transpose();
  Eigen::LLT<JointMatrixN<N>>(MassMatrix(q)).matrixL().solveInPlace(Y);
  return Y.transpose().lazyProduct(Y);
}

#define OSTEON_INSTANTIATE(N)                                                        \
  template JointMatrixN<N> SerialChain<N>::MassMatrix(const Joints&) const noexcept; \
  template Eigen::Matrix<double, 6, 6> SerialChain<N>::Mobility(const Joints&, const Vector3&) const noexcept;
OSTEON_INSTANTIATE(6)
OSTEON_INSTANTIATE(7)
#undef OSTEON_INSTANTIATE

}  // namespace osteon::kinematics
