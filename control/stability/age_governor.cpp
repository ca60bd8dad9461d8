#include "control/stability/age_governor.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parameter_check.h"

namespace osteon::control {
namespace {

constexpr double kMargin = 1.02;    // factor on the aged stiffness
constexpr double kMinPivot = 1e-9;  // pivot of the normals' Gram matrix below which a normal counts as
                                    // linearly dependent on the others
constexpr double kDone = 1e-4;      // a factor this near to 1 counts as 1
constexpr int kMaxRows = 4;         // worst case: 2 normals, and 1 tangent for each of 2 planes

using Vector6 = Eigen::Matrix<double, 6, 1>;

// Columns d = sqrt(w) a, with a scaled force direction a and its weight w (age × stiffness). The sum of d d^T
// is the aged stiffness divided by the damping.
struct Rows {
  Eigen::Matrix<double, 6, kMaxRows> d{Eigen::Matrix<double, 6, kMaxRows>::Zero()};
  int count{0};

  void Add(const Vector6& direction, double weight) OSTEON_RT {
    if (count < kMaxRows) d.col(count++) = std::sqrt(weight) * direction;
  }
};

// Six-axis direction (force, torque) of a unit force along u that acts at lever_W. The torque is about the
// damping's centre. Each component is divided by the square root of its axis' damping.
Vector6 ScaledForceDirection(const Vector3& u_W, const Vector3& lever_W, const Matrix3& R_WT,
                             const AxisDamping& root) OSTEON_RT {
  Vector6 a;
  const Vector3 u_T = R_WT.transpose() * u_W;
  const Vector3 lever_T = R_WT.transpose() * lever_W - root.centre_T_m;
  a << u_T.cwiseQuotient(root.Ns_per_m), lever_T.cross(u_T).cwiseQuotient(root.Nms_per_rad);
  return a;
}

// Orthonormal basis of the active planes' normals; e holds the scaled force direction of each basis vector.
struct NormalBasis {
  std::array<Vector3, 3> normal;
  std::array<Vector6, 3> e;
  int rank{0};
  double stiffness_N_per_m{0.0};  // stiffness of the stiffest of these planes, with the coupling's fade
};

// Gram-Schmidt orthogonalisation of the normals together with their levers: A (N^T N)^-1 A^T = sum e e^T.
NormalBasis OrthogonalNormals(const CouplingOutput& coupling, const Matrix3& R_WT,
                              const AxisDamping& root) OSTEON_RT {
  NormalBasis basis;
  auto& [normal, e, rank, stiffness_N_per_m] = basis;
  for (int j = 0; j < coupling.active_planes && rank < 3; ++j) {
    const ActivePlane& plane = coupling.active[static_cast<std::size_t>(j)];
    const auto r = static_cast<std::size_t>(rank);
    Vector3 n = plane.n_W;
    Vector6 a = ScaledForceDirection(plane.n_W, plane.lever_W, R_WT, root);
    for (std::size_t i = 0; i < r; ++i) {
      const double along = normal[i].dot(plane.n_W);
      n -= along * normal[i];
      a -= along * e[i];
    }
    const double remaining2 = n.squaredNorm();
    if (!(remaining2 > kMinPivot)) continue;
    const double scale = 1.0 / std::sqrt(remaining2);
    normal[r] = scale * n;
    e[r] = scale * a;
    ++rank;
    stiffness_N_per_m = std::max(stiffness_N_per_m, plane.stiffness_N_per_m);
  }
  stiffness_N_per_m *= coupling.fade;
  return basis;
}

// Upper bound of the largest eigenvalue of sum d d^T: the sixteenth root of the trace of the sixteenth power
// of the columns' Gram matrix. The Gram matrix is divided by its trace first, to avoid overflow and
// underflow.
double EigenvalueBound(const Rows& rows) OSTEON_RT {
  Eigen::Matrix4d gram;
  gram.noalias() = rows.d.transpose().lazyProduct(rows.d);
  const double trace = gram.trace();
  // the trace is a coarser bound, which suffices here: a ratio up to 1 needs no action
  if (!(trace > 1.0)) return trace;
  gram /= trace;
  for (int i = 0; i < 4; ++i) gram = (gram.lazyProduct(gram)).eval();
  return trace * std::sqrt(std::sqrt(std::sqrt(std::sqrt(gram.trace()))));
}

}  // namespace

void Validate(const AgeGovernorParams& params) {
  const base::ParameterCheck require("age governor ");
  require("max_damping_factor", params.max_damping_factor, 1.0, 1000.0);
  require("release_s", params.release_s, 1e-3, 10.0);
  require("tool_radius_m", params.tool_radius_m, 1e-5, 1.0);
  require("arm_damping_Ns_per_m", params.arm_damping_Ns_per_m, 0.0, 1e4);
  require("arm_damping_Nms_per_rad", params.arm_damping_Nms_per_rad, 0.0, 1e3);
}

double AgeRatio(const CouplingOutput& coupling, const Matrix3& R_WT, const AxisDamping& D,
                const StiffnessAges& ages, double radius_m) OSTEON_RT {
  if (coupling.active_planes == 0) return 0.0;
  const AxisDamping root{.Ns_per_m = D.Ns_per_m.cwiseSqrt(),
                         .Nms_per_rad = D.Nms_per_rad.cwiseSqrt(),
                         .centre_T_m = D.centre_T_m};

  const NormalBasis basis = OrthogonalNormals(coupling, R_WT, root);
  const std::array<Vector3, 3>& normal = basis.normal;
  const int rank = basis.rank;
  Rows rows;
  if (ages.pose_s > 0.0)
    for (int i = 0; i < rank; ++i)
      rows.Add(basis.e[static_cast<std::size_t>(i)], kMargin * ages.pose_s * basis.stiffness_N_per_m);

  // K_2: the rotation of the planes' normals acts along the tangents, which exist only if rank < 3
  if (rank < 3) {
    std::array<Vector3, 2> tangent;
    if (rank == 1) {
      tangent[0] = normal[0].unitOrthogonal();
      tangent[1] = normal[0].cross(tangent[0]);
    } else {
      tangent[0] = normal[0].cross(normal[1]);
    }
    // Attribute the force of the remaining planes to the first `rank` planes (for example walls that press
    // from both sides).
    double total_N = 0.0, counted_N = 0.0;
    for (int j = 0; j < coupling.active_planes; ++j) {
      const double force_N = coupling.active[static_cast<std::size_t>(j)].force_N;
      total_N += force_N;
      if (j < rank) counted_N += force_N;
    }
    const double force_factor = counted_N > 0.0 ? total_N / counted_N : 0.0;
    for (int j = 0; j < rank; ++j) {
      const ActivePlane& plane = coupling.active[static_cast<std::size_t>(j)];
      const double turning_N_per_m =
          std::min(force_factor * plane.force_N / radius_m, coupling.fade * plane.stiffness_N_per_m);
      for (int i = 0; i < 3 - rank; ++i)
        rows.Add(ScaledForceDirection(tangent[static_cast<std::size_t>(i)],
                                      plane.lever_W + radius_m * plane.n_W, R_WT, root),
                 kMargin * ages.planes_s * turning_N_per_m);
    }
  }
  return EigenvalueBound(rows);
}

AgeGovernor::AgeGovernor(const AgeGovernorParams& params, double period_s)
    : params_(params), release_(period_s / (period_s + params.release_s)) {
  Validate(params);
}

void AgeGovernor::Reset() OSTEON_RT {
  damping_factor_ = 1.0;
  wrench_scale_ = 1.0;
}

void AgeGovernor::Step(const CouplingOutput& coupling, const Matrix3& R_WT, const AxisDamping& law,
                       const StiffnessAges& ages) OSTEON_RT {
  if (!params_.acts) return;
  // the law's damping times a factor, plus the arm's own
  const auto with_arm = [&](double factor) {
    return AxisDamping{
        .Ns_per_m = factor * law.Ns_per_m + Vector3::Constant(params_.arm_damping_Ns_per_m),
        .Nms_per_rad = factor * law.Nms_per_rad + Vector3::Constant(params_.arm_damping_Nms_per_rad),
        .centre_T_m = law.centre_T_m};
  };
  double factor = 1.0, scale = 1.0;
  const AxisDamping D = with_arm(1.0);
  const double ratio = AgeRatio(coupling, R_WT, D, ages, params_.tool_radius_m);
  if (ratio > 1.0) {
    // The factor acts on the law's damping only, but law and arm together must reach the ratio. The axis on
    // which the law has the smallest part of the sum decides.
    double max_sum_over_law = 1.0;
    for (int i = 0; i < 3; ++i)
      max_sum_over_law = std::max(
          {max_sum_over_law, D.Ns_per_m[i] / law.Ns_per_m[i], D.Nms_per_rad[i] / law.Nms_per_rad[i]});
    factor = std::min(1.0 + (ratio - 1.0) * max_sum_over_law, params_.max_damping_factor);
    if (factor == params_.max_damping_factor) {
      const double remaining_ratio = AgeRatio(coupling, R_WT, with_arm(factor), ages, params_.tool_radius_m);
      if (remaining_ratio > 1.0) scale = 1.0 / remaining_ratio;
    }
  }
  // Values move away from 1 immediately and return to 1 slowly.
  const auto released = [&](double value) {
    const double next = value + release_ * (1.0 - value);
    return std::abs(next - 1.0) < kDone ? 1.0 : next;
  };
  damping_factor_ = std::max(factor, released(damping_factor_));
  wrench_scale_ = std::min(scale, released(wrench_scale_));
}

}  // namespace osteon::control
