#pragma once

#include "hil/arm/servo_arm.h"
#include "hil/loops/linear_loop.h"
#include "hil/loops/loop_arm.h"
#include "hil/operator/hand_grid.h"

// Model B of the design's stability page: a hand that holds an admittance-controlled arm, along one axis.
//
//     hand ── k, b, m ── arm: w, z, dead time ◀── x_c ── virtual tool m_v, b_v ◀── wall K
//      └─────── felt force, df samples late ────────────────▶ f

namespace osteon::hil {

/// The pose from which a wall's force is computed.
enum class WallOn {
  kCommanded,  ///< the commanded pose, age_ticks samples old; 0: planes evaluated in the tick
  kMeasured,   ///< the measured pose
};

struct LoopWall {
  double stiffness_N_per_m{0.0};  ///< 0: no wall
  double damping_Ns_per_m{0.0};   ///< on the velocity of the same pose
  WallOn on{WallOn::kCommanded};
  int age_ticks{0};
};

/// Every field has a usable default: the design's rows at 1 ms, for an arm of 15 Hz.
struct AdmittanceLoopParams {
  GridHand hand{"firm", 500.0, 20.0, 1.5};
  double mass_kg{3.0};            ///< m_v
  double damping_Ns_per_m{20.0};  ///< b_v
  LoopWall wall{};
  /// Bandwidth, damping ratio, and the command's dead time from the tick that sends it.
  ServoArmParams arm{};
  double felt_mass_kg{0.0};  ///< M: mass by which the hand's force moves the arm (LoopArm); 0: it does not
  int sensor_delay{1};       ///< df [ticks]: from the hand's force to the law's input
  double tool_mass_kg{0.0};  ///< m_t: the load of the sensor; its inertia feels like more hand mass
  /// Share of that inertia that the loop compensates (control/sensing/tool_inertia.h).
  double inertia_share{0.0};
  double acceleration_hz{15.0};  ///< corner frequency of the compensation's filters
  double period_s{0.001};        ///< T
};

/// @throws std::invalid_argument naming the field, what was found and what is accepted.
void Validate(const AdmittanceLoopParams& params);

/// The linear loop around its equilibrium:
///
///     arm     x_r'' = w^2 (x_c[k+1-dead] - x_r) - 2 z w x_r'
///             one step of the shipped ServoArm; its command in tick k is what the law computes in that tick
///     felt    f = -(k_h x_r + b_h x_r' + (m_h + m_t) (x_r'[k] - x_r'[k-1]) / T)
///             reaches the law df ticks later; the shipped StepMotion then adds share m_t x_r''. The
///             acceleration is the mean over the period that ends: its value just after a command's step
///             would add m_h w^2 T / 2 to the hand's damping
///     law     v+ = (v + T/m_v (f + F_wall)) / (1 + T b_v/m_v),  x_c+ = x_c + T v+
///             the shipped StepAdmittance
///     wall    F_wall = -K x - B x',  x by WallOn
///
/// The law runs along z of a rotated tool, so its changes of frame are in the loop too.
class AdmittanceLoop {
 public:
  explicit AdmittanceLoop(const AdmittanceLoopParams& params);

  /// Size of the state: x_c now and before, x_r, x_r', x_r' a period ago, v, earlier felt forces; with
  /// inertia compensation also the previous x_r and its filtered velocity and acceleration.
  [[nodiscard]] int size() const { return motion_ + (params_.inertia_share > 0.0 ? 3 : 0); }
  [[nodiscard]] Eigen::VectorXd Step(const Eigen::VectorXd& state) const;
  [[nodiscard]] Eigen::MatrixXd Matrix() const;
  [[nodiscard]] double SpectralRadius() const { return hil::SpectralRadius(Matrix()); }

 private:
  AdmittanceLoopParams params_;
  double command_gain_;  // HeldArm::command_gain of the arm that the hand moves aside
  LoopArm linear_arm_;
  // first indices in the state: of x_r, of v, of the earlier felt forces, of the compensation's filters
  int arm_, speed_, felt_, motion_;
};

/// The largest wall stiffness before the first crossing [N/m].
[[nodiscard]] Boundary MaxWallStiffness(AdmittanceLoopParams params,
                                        const BoundaryScan& scan = {.from = 100.0, .to = 2e6});
/// The smallest drag b_v [N s/m] above which the loop is stable up to scan.to. Scans downward from there, as
/// an upward scan could stop below a second unstable range. 0 if every drag of the scan is stable.
[[nodiscard]] double MinDrag(AdmittanceLoopParams params,
                             const BoundaryScan& scan = {.from = 1.0, .to = 2000.0});

}  // namespace osteon::hil
