#pragma once

#include "hil/arm/servo_arm.h"
#include "hil/loops/linear_loop.h"
#include "hil/loops/loop_arm.h"
#include "hil/operator/hand_grid.h"

// Model B of the design's stability page: a hand holds an admittance-controlled arm; motion along one axis.
//
//     hand ── k, b, m ── arm: w, z, dead time ◀── x_c ── virtual tool m_v, b_v ◀── wall K
//      └─────── sensor's force, df samples late ────────────▶ f

namespace osteon::hil {

/// The pose from which a wall's force is computed.
enum class WallOn {
  kCommanded,  ///< the commanded pose, age_ticks samples old; age 0: the planes are evaluated at the present
               ///< commanded pose
  kMeasured,   ///< the measured pose
};

struct LoopWall {
  double stiffness_N_per_m{0.0};  ///< 0: no wall
  double damping_Ns_per_m{0.0};   ///< B: damping on the velocity of the pose of WallOn
  WallOn on{WallOn::kCommanded};
  int age_ticks{0};
};

/// Parameters of the loop. Every field has a usable default: the values of the design's table at 1 ms for an
/// arm of 15 Hz.
struct AdmittanceLoopParams {
  GridHand hand{"firm", 500.0, 20.0, 1.5};
  double mass_kg{3.0};            ///< m_v
  double damping_Ns_per_m{20.0};  ///< b_v
  LoopWall wall{};
  /// Bandwidth and damping ratio of the arm, and dead time of a command, counted from the tick that sends it.
  ServoArmParams arm{};
  double felt_mass_kg{0.0};  ///< M: apparent mass with which the arm yields to the hand's force (see
                             ///< HeldArm); 0: the arm does not yield
  int sensor_delay{1};       ///< df [ticks]: delay from the hand's force to the law's input
  double tool_mass_kg{0.0};  ///< m_t: mass that the sensor carries; its inertia adds to the hand's mass
  /// Share of the tool's inertia that the loop compensates (control/sensing/tool_inertia.h).
  double inertia_share{0.0};
  double acceleration_hz{15.0};  ///< corner frequency of the compensation's filters
  double period_s{0.001};        ///< T
};

/// @throws std::invalid_argument naming the field, what was found and what is accepted.
void Validate(const AdmittanceLoopParams& params);

/// The linear loop around its equilibrium:
///
///     arm     x_r'' = w^2 (x_c[k+1-dead] - x_r) - 2 z w x_r'
///             one step of the production code's ServoArm; its command in tick k is the law's result in that tick
///     felt    f = -(k_h x_r + b_h x_r' + (m_h + m_t) (x_r'[k] - x_r'[k-1]) / T)
///             force on the sensor; it reaches the law df ticks later, where StepMotion adds
/// ///             share m_t x_r''. The acceleration is the mean over the past period: the value
/// ///             just after a step of the command would add m_h w^2 T / 2 to the hand's damping
///     law     v+ = (v + T/m_v (f + F_wall)) / (1 + T b_v/m_v),  x_c+ = x_c + T v+
///             the production code's StepAdmittance
///     wall    F_wall = -K x - B x',  with x and x' by WallOn
///
/// The law runs along z of a rotated tool, so its transformations between frames are part of the loop.
class AdmittanceLoop {
 public:
  explicit AdmittanceLoop(const AdmittanceLoopParams& params);

  /// Size of the state. Its parts are: x_c now and of earlier ticks, x_r, x_r', x_r' one period ago, v,
  /// earlier forces on the sensor. With inertia compensation also: the previous x_r, its filtered velocity
  /// and its filtered acceleration.
  [[nodiscard]] int size() const { return motion_ + (params_.inertia_share > 0.0 ? 3 : 0); }
  [[nodiscard]] Eigen::VectorXd Step(const Eigen::VectorXd& state) const;
  [[nodiscard]] Eigen::MatrixXd Matrix() const;
  [[nodiscard]] double SpectralRadius() const { return hil::SpectralRadius(Matrix()); }

 private:
  AdmittanceLoopParams params_;
  double command_gain_;  // HeldArm::command_gain of the arm, which yields to the hand
  LoopArm linear_arm_;
  // first indices in the state: of x_r, of v, of the earlier forces on the sensor, of the compensation's
  // filters
  int arm_, speed_, felt_, motion_;
};

/// Finds the largest wall stiffness [N/m] up to which the loop is stable in the scanned range.
[[nodiscard]] Boundary MaxWallStiffness(AdmittanceLoopParams params,
                                        const BoundaryScan& scan = {.from = 100.0, .to = 2e6});
/// Returns the smallest drag b_v [N s/m] above which the loop is stable up to scan.to; infinite if it is
/// unstable at scan.to. It scans downward from scan.to, because an upward scan could end below a second
/// unstable range. 0 if every drag of the scan is stable.
[[nodiscard]] double MinDrag(AdmittanceLoopParams params,
                             const BoundaryScan& scan = {.from = 1.0, .to = 2000.0});

}  // namespace osteon::hil
