#include <cassert>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "kinematics/frame_turn.h"
#include "kinematics/serial_chain.h"

// Mass matrix and what the hand feels of it.

namespace osteon::kinematics {
namespace {

// Links i … N as one rigid body, in K(i): mass, first moment h, second moments S = integral of r r^T dm, its
// six elements.
struct Composite {
  double m{0.0};
  Vector3 h{Vector3::Zero()};
  double xx{0.0}, yy{0.0}, zz{0.0}, xy{0.0}, xz{0.0}, yz{0.0};

  // The same body in the frame before: turned about z, then about x, then moved.
  [[gnu::always_inline]] void ToParent(const FrameTurn& T, const Vector3& p) {
    Turn(T.cos_theta, T.sin_theta, xx, yy, xy, xz, yz);
    Turn(T.cos_alpha, T.sin_alpha, yy, zz, yz, xy, xz);
    const Vector3 turned = T.ToParent(h);
    h = turned + m * p;
    xx += p.x() * (turned.x() + h.x());
    yy += p.y() * (turned.y() + h.y());
    zz += p.z() * (turned.z() + h.z());
    xy += turned.x() * p.y() + p.x() * h.y();
    xz += turned.x() * p.z() + p.x() * h.z();
    yz += turned.y() * p.z() + p.y() * h.z();
  }

 private:
  // Turns a symmetric matrix in the plane of two axes a, b, the third being c.
  [[gnu::always_inline]] static void Turn(double cos, double sin, double& aa, double& bb, double& ab,
                                          double& ac, double& bc) {
    const double sum = aa + bb, cs = cos * sin, ss = sin * sin;
    const double shift = ss * (bb - aa) - 2.0 * cs * ab;  // c^2 aa - 2 c s ab + s^2 bb = aa + shift
    ab += cs * (aa - bb) - 2.0 * ss * ab;
    aa += shift;
    bb = sum - aa;
    const double before = ac;
    ac = cos * before - sin * bc;
    bc = sin * before + cos * bc;
  }
};

// Forces and torques that unit accelerations of the joints ask for, two joints at a time, in one frame.
struct Columns {
  Pair fx{}, fy{}, fz{}, tx{}, ty{}, tz{};

  [[gnu::always_inline]] void ToParent(const FrameTurn& T, const Vector3& p) {
    Turn(T, fx, fy, fz);
    Turn(T, tx, ty, tz);
    tx += p.y() * fz - p.z() * fy;
    ty += p.z() * fx - p.x() * fz;
    tz += p.x() * fy - p.y() * fx;
  }

 private:
  [[gnu::always_inline]] static void Turn(const FrameTurn& T, Pair& x, Pair& y, Pair& z) {
    const Pair tilted = T.sin_theta * x + T.cos_theta * y;
    x = T.cos_theta * x - T.sin_theta * y;
    y = T.cos_alpha * tilted - T.sin_alpha * z;
    z = T.sin_alpha * tilted + T.cos_alpha * z;
  }
};

}  // namespace

// Composite rigid bodies, inwards. Turning joint i alone with 1 rad/s^2 asks of link i, at its origin, the
// force z × h and the torque I z, which then are carried along to every joint further in: M(j, i) is the
// torque about z there.
template <int N>
JointMatrixN<N> SerialChain<N>::MassMatrix(const Joints& q) const noexcept {
  assert(params_.has_masses);
  const SinCosN<kPadded> turn = Turns(q);
  std::array<Columns, kPadded / 2> columns;
  Composite body;
  JointMatrixN<N> M;
  for (std::size_t i = N; i-- > 0;) {
    const Body& link = bodies_[i];
    body.m += link.mass_kg;
    body.h += link.first_moment_kg_m;
    body.xx += link.second_moment_kg_m2(0, 0);
    body.yy += link.second_moment_kg_m2(1, 1);
    body.zz += link.second_moment_kg_m2(2, 2);
    body.xy += link.second_moment_kg_m2(0, 1);
    body.xz += link.second_moment_kg_m2(0, 2);
    body.yz += link.second_moment_kg_m2(1, 2);

    Columns& own = columns[i / 2];
    const std::size_t lane = i % 2;
    own.fx[lane] = -body.h.y();
    own.fy[lane] = body.h.x();
    own.fz[lane] = 0.0;
    own.tx[lane] = -body.xz;
    own.ty[lane] = -body.yz;
    own.tz[lane] = body.xx + body.yy;
    for (std::size_t j = i; j < N; ++j)
      M(static_cast<int>(i), static_cast<int>(j)) = M(static_cast<int>(j), static_cast<int>(i)) =
          columns[j / 2].tz[j % 2];
    M(static_cast<int>(i), static_cast<int>(i)) += params_.joints[i].rotor_inertia_kg_m2;
    if (i == 0) break;

    const Step& step = steps_[i];
    const FrameTurn T{step.cos_alpha, step.sin_alpha, turn.cos[i], turn.sin[i]};
    for (std::size_t pair = i / 2; pair < kPadded / 2; ++pair) columns[pair].ToParent(T, step.p);
    body.ToParent(T, step.p);
  }
  return M;
}

// J M^-1 J^T = Y^T Y with L Y = J^T, M = L L^T.
template <int N>
Eigen::Matrix<double, 6, 6> SerialChain<N>::MobilityOf(const Joints& q,
                                                       const JacobianN<N>& J) const noexcept {
  Eigen::Matrix<double, N, 6> Y = J.transpose();
  Eigen::LLT<JointMatrixN<N>>(MassMatrix(q)).matrixL().solveInPlace(Y);
  return Y.transpose().lazyProduct(Y);
}

template <int N>
Eigen::Matrix<double, 6, 6> SerialChain<N>::Mobility(const Joints& q) const noexcept {
  return MobilityOf(q, Jacobian(Place(q)));
}

template <int N>
Eigen::Matrix<double, 6, 6> SerialChain<N>::Mobility(const Joints& q, const Vector3& p_B) const noexcept {
  return MobilityOf(q, JacobianAt(Place(q), p_B));
}

template <int N>
Eigen::Matrix<double, 6, 6> SerialChain<N>::OperationalInertia(const Joints& q) const noexcept {
  return Mobility(q).inverse();
}

template <int N>
Eigen::Matrix<double, 6, 6> SerialChain<N>::OperationalInertia(const Joints& q,
                                                               const Vector3& p_B) const noexcept {
  return Mobility(q, p_B).inverse();
}

template <int N>
double SerialChain<N>::FeltMass(const Joints& q, const Vector3& u_B) const noexcept {
  return FeltMass(q, u_B, Place(q).X_BF.translation());
}

template <int N>
double SerialChain<N>::FeltMass(const Joints& q, const Vector3& u_B, const Vector3& p_B) const noexcept {
  const JacobianN<N> J = JacobianAt(Place(q), p_B);
  Joints y = J.template topRows<3>().transpose() * u_B;
  Eigen::LLT<JointMatrixN<N>>(MassMatrix(q)).matrixL().solveInPlace(y);
  return 1.0 / y.squaredNorm();
}

#define OSTEON_INSTANTIATE(N)                                                                            \
  template JointMatrixN<N> SerialChain<N>::MassMatrix(const Joints&) const noexcept;                     \
  template Eigen::Matrix<double, 6, 6> SerialChain<N>::Mobility(const Joints&) const noexcept;           \
  template Eigen::Matrix<double, 6, 6> SerialChain<N>::Mobility(const Joints&, const Vector3&)           \
      const noexcept;                                                                                    \
  template Eigen::Matrix<double, 6, 6> SerialChain<N>::OperationalInertia(const Joints&) const noexcept; \
  template Eigen::Matrix<double, 6, 6> SerialChain<N>::OperationalInertia(const Joints&, const Vector3&) \
      const noexcept;                                                                                    \
  template double SerialChain<N>::FeltMass(const Joints&, const Vector3&) const noexcept;                \
  template double SerialChain<N>::FeltMass(const Joints&, const Vector3&, const Vector3&) const noexcept;
OSTEON_INSTANTIATE(6)
OSTEON_INSTANTIATE(7)
#undef OSTEON_INSTANTIATE

}  // namespace osteon::kinematics
