#pragma once

#include <cstdint>
#include <vector>

#include "hil/injection/wire_faults.h"
#include "kinematics/spatial.h"

namespace osteon::hil {

/// What the controller does with what it has of the wall.
enum class WallMethod : std::uint8_t {
  kPlanes,  ///< ours: contact planes come over the wire, and every tick evaluates them
  kHeld,    ///< the force comes over the wire; the last one counts until another comes
  kZeroed,  ///< the same, but nothing counts in a tick in which nothing came
};

/// An admittance-controlled tool that a hand presses into a cup, with the cup's simulation and the arm each
/// behind a wire of two directions:
///
///     simulation ◀─pose── controller ──command─▶ arm and hand
///                ──wall─▶            ◀──force───
///
/// The shipped law (control/admittance_law.h) and coupling (control/virtual_coupling.h) in virtual time, 1
/// kHz at every station. The arm goes where the newest command says: a lag of its own would add to the hand's
/// age. The hand is a spring, the wall a spring, and nothing but the law's drag takes energy.
struct PacketRideParams {
  WallMethod method{WallMethod::kPlanes};
  WireFaults before{};  ///< of all four, until the step
  WireFaults after{};   ///< from the step on
  std::uint64_t seed{1};
  double step_s{2.0}, seconds{6.0};
  double mass_kg{3.0}, damping_Ns_per_m{80.0};
  double wall_N_per_m{20e3}, hand_N_per_m{500.0};
  double clearance_m{0.05};  ///< of the cup, by which the tool's centre can move sideways in it
  double push_N{30.0};
};

/// The hand taps the tool a second before the step, and at the step: 2 N down and sideways for 20 ms.
struct PacketRide {
  std::vector<Vector3> p_W_m;  ///< of the tool, one a tick
  double tap_m{0.0};           ///< swing in the half second after the first tap
  double end_m{0.0};           ///< swing in the last half second
  double wall_age_s{0.0};      ///< largest age of the pose that the wall's answer was made from
  double hand_age_s{0.0};      ///< the same of the hand's force
  double most_wall_N{0.0};

  [[nodiscard]] double Growth() const { return end_m / tap_m; }
};
[[nodiscard]] PacketRide RidePackets(const PacketRideParams& params);

/// D - sum a_max K over the two wires, with the ages that the ride saw [N s/m]. Above zero the motion can not
/// grow, whatever the ages do below their maximum. Of the wall K is what the age acts through: with its force
/// from beyond the wire all of its stiffness; with planes that this tick evaluates, what the planes turn by,
/// force over clearance. Source: control.md of the design, "Any age".
[[nodiscard]] double AgeMargin(const PacketRideParams& params, const PacketRide& ride);

}  // namespace osteon::hil
