#pragma once

#include <cstdint>
#include <vector>

#include "hil/injection/wire_faults.h"
#include "kinematics/spatial.h"

namespace osteon::studies {

/// How the controller obtains the wall's force.
enum class WallMethod : std::uint8_t {
  kPlanes,  ///< ours: contact planes come over the wire, and every tick evaluates them
  kHeld,    ///< the force comes over the wire and is held until the next one
  kZeroed,  ///< the force comes over the wire, and is zero in a tick in which none came
};

/// A hand presses an admittance-controlled tool into a cup. The cup's simulation and the arm are each behind
/// a wire with two directions:
///
///     simulation ◀─pose── controller ──command─▶ arm and hand
///                ──wall─▶            ◀──force───
///
/// The shipped law (control/laws/admittance_law.h) and coupling (control/coupling/virtual_coupling.h) in
/// virtual time, 1 kHz at every station. The arm is exactly at the newest command: a lag of its own would add
/// to the age of the hand's force. The hand is a spring, the wall a spring, and only the law's drag
/// dissipates energy.
struct PacketRideParams {
  WallMethod method{WallMethod::kPlanes};
  hil::WireFaults before{};  ///< of all four directions, until the step
  hil::WireFaults after{};   ///< from the step on
  std::uint64_t seed{1};
  double step_s{2.0}, seconds{6.0};
  double mass_kg{3.0}, damping_Ns_per_m{80.0};
  double wall_N_per_m{20e3}, hand_N_per_m{500.0};
  double clearance_m{0.05};  ///< distance by which the tool's centre can move sideways in the cup
  double push_N{30.0};       ///< steady push of the hand, down
};

/// Result of a ride. The hand taps the tool a second before the step, and at the step: 2 N down and sideways
/// for 20 ms.
struct PacketRide {
  std::vector<Vector3> p_W_m;  ///< position of the tool in each tick
  double tap_m{0.0};           ///< swing in the half second after the first tap
  double end_m{0.0};           ///< swing in the last half second
  double wall_age_s{0.0};      ///< largest age of the pose that the wall's answer was computed from
  double hand_age_s{0.0};      ///< largest age of the hand's force
  double max_wall_N{0.0};      ///< largest force of the wall

  /// Above 1 the tool swings more at the end than after the first tap.
  [[nodiscard]] double Growth() const { return end_m / tap_m; }
};
/// Simulates the ride. Deterministic for a seed.
[[nodiscard]] PacketRide RidePackets(const PacketRideParams& params);

/// D - sum a_max K over the two wires, with the largest ages of the ride [N s/m]. Above zero the motion
/// cannot grow, however the ages vary below their maximum. The wall's K is the stiffness that the age acts
/// through: all of it if the wall's force comes over the wire; force over clearance, by which planes turn, if
/// this tick evaluates planes. Source: control.md of the design, "Any age".
[[nodiscard]] double AgeMargin(const PacketRideParams& params, const PacketRide& ride);

}  // namespace osteon::studies
