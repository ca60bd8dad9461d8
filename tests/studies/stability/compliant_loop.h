#pragma once

#include <optional>

#include "hil/loops/admittance_loop.h"

// Model B of docs/theory/stability.md (a hand at an admittance-controlled arm) with compliance between the
// virtual tool and the wall: a massless link, and a bone on its mount.
//
//     hand ── arm: w, z, dead time ◀── x_c ── virtual tool ── link e ── K ── wall ── mount d: m, k, zeta
//      └── felt force, df samples late ──▶ f                              (its planes late_ticks behind)

namespace osteon::hil {

/// A massless Kelvin-Voigt element (spring and damper in parallel) in series with the wall.
struct LoopLink {
  double compliance_m_per_N{0.0};
  double tau_s{0.020};  ///< time constant
};

/// A bone that moves on its mount.
struct LoopMount {
  double mass_kg{12.0};
  double frequency_hz{10.0};  ///< natural frequency of the bone on its mount, without contact
  double damping_ratio{0.05};
  int late_ticks{0};  ///< delay of the coupling's planes behind the bone [ticks]
};

struct CompliantLoopParams {
  AdmittanceLoopParams loop;  ///< its wall may only have a stiffness, and must act on the commanded pose
  std::optional<LoopLink> link{};
  std::optional<LoopMount> mount{};
  /// true: the hand's acceleration is the mean over the previous period, as in AdmittanceLoop; false: it is
  /// that at the period's beginning, as in the tables of docs/theory/compliance.md.
  bool mean_acceleration{false};
};

/// The linear loop around a wall that stays in contact:
///
///     wall    F = -K (x_c + e - d)
///     link    e+ by the shipped StepMassless, x_inf = c F
///     mount   d+ by the shipped StepMount, under F
///     law     the shipped StepAdmittance;  arm  one step of the shipped ServoArm
///     felt    f = -(k_h x_r + b_h x_r' + m_h x_r''), df ticks late
///             x_r'' = w^2 (x_c[k-dc] - x_r) - 2 z w x_r'
///
/// The dead time dc is counted in whole periods. With mean_acceleration, x_r'' = (x_r'[k] - x_r'[k-1]) / T
/// instead. The acceleration at the period's beginning adds m_h w^2 T / 2 to the hand's damping just after a
/// command's step.
class CompliantLoop {
 public:
  /// @throws std::invalid_argument naming the field, what was found and what is accepted.
  explicit CompliantLoop(const CompliantLoopParams& params);

  [[nodiscard]] int size() const { return size_; }
  /// The state one period later; linear in `state`.
  [[nodiscard]] Eigen::VectorXd Step(const Eigen::VectorXd& state) const;
  /// Factor by which the slowest mode changes in a period: below 1 it decays, above 1 it grows.
  [[nodiscard]] double SpectralRadius() const;

 private:
  CompliantLoopParams params_;
  Eigen::Matrix<double, 2, 3> arm_step_;
  int arm_, speed_, felt_, link_, mount_, before_, size_;  // first index in the state of each part
};

/// The shortest time constant of the link that is stable, by bisection between 10 us and 1 s.
[[nodiscard]] double MinLinkTime_s(CompliantLoopParams params);

}  // namespace osteon::hil
