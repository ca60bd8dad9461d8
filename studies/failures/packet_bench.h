#pragma once

#include <cstdint>
#include <vector>

#include "hil/injection/wire_faults.h"
#include "kinematics/spatial.h"

namespace osteon::studies {

/// How the controller obtains the wall's force.
enum class WallMethod : std::uint8_t {
  kPlanes,  ///< ours: contact planes come over the wire; every tick evaluates the newest ones
  kHeld,    ///< the force comes over the wire; a missing force is replaced by the one before
  kZeroed,  ///< the force comes over the wire; a missing force is replaced by zero
};

/// A run in which a hand presses an admittance-controlled tool into a cup. The cup's simulation and the arm
/// are each behind a wire with two directions:
///
///     simulation ◀─pose── controller ──command─▶ arm and hand
///                ──wall─▶            ◀──force───
///
/// The shipped law (control/laws/admittance_law.h) and coupling (control/coupling/virtual_coupling.h) run in
/// virtual time; simulation, controller and arm each work at 1 kHz. The arm is exactly at the newest command:
/// a lag of its own would add to the age of the hand's force. Hand and wall are springs, and only the law's
/// drag dissipates energy.
struct PacketTrialParams {
  WallMethod method{WallMethod::kPlanes};
  hil::WireFaults before{};  ///< faults of all four directions, until the step
  hil::WireFaults after{};   ///< from the step on
  std::uint64_t seed{1};
  double step_s{2.0}, seconds{6.0};
  double mass_kg{3.0}, damping_Ns_per_m{80.0};
  double wall_N_per_m{20e3}, hand_N_per_m{500.0};
  double clearance_m{0.05};  ///< distance by which the tool's centre can move sideways in the cup
  double push_N{30.0};       ///< steady push of the hand, down
};

/// Result of a run. The hand taps the tool with 2 N, down and sideways, for 20 ms: once a second before the
/// step, and once at the step.
struct PacketTrial {
  std::vector<Vector3> p_W_m;  ///< position of the tool in each tick
  double tap_m{0.0};           ///< swing in the half second after the first tap
  double end_m{0.0};           ///< swing in the last half second
  double wall_age_s{0.0};      ///< largest age of the pose for which the wall's answer was computed
  double hand_age_s{0.0};      ///< largest age of the hand's force
  double max_wall_N{0.0};      ///< largest force of the wall

  /// Ratio of the swing at the end to the swing after the first tap; above 1 the swing has grown.
  [[nodiscard]] double Growth() const { return end_m / tap_m; }
};
/// Simulates the run. Deterministic for a seed.
[[nodiscard]] PacketTrial RunPacketTrial(const PacketTrialParams& params);

/// D - sum a_max K over the two wires, with the law's drag D and the largest age a_max of the run [N s/m]. If
/// it is above zero the motion cannot grow, however the ages vary below their maximum. K is the stiffness
/// through which a force's age acts. For the hand it is the hand's stiffness. For the wall it is the whole
/// stiffness if the wall's force comes over the wire; if the tick evaluates planes, it is the force divided
/// by the clearance, since an old plane is only turned. Source: control.md of the design, "Any age".
[[nodiscard]] double AgeMargin(const PacketTrialParams& params, const PacketTrial& trial);

}  // namespace osteon::studies
