#pragma once

#include <string>
#include <vector>

#include "hil/operator/operator_hand.h"

namespace osteon::hil {

/// A human arm, or a harder test than one: spring, damper and mass at the tool.
struct GridHand {
  std::string name;
  double stiffness_N_per_m{0.0};
  double damping_Ns_per_m{0.0};
  double mass_kg{0.0};
};

/// Single hands: a published one (from memory), those of the oracles of admittance control, and two that are
/// no hands but with which a loop should be tested too: a fixture, and the clamp of 50 kN/m (its damping is
/// assumed equal to the fixture's).
[[nodiscard]] std::vector<GridHand> NamedHands();

/// All hands that a cell must be stable with: the named ones, and every combination of
///
///     k  50, 300, 1500, 6000, 10000 N/m     the range of human arms; 300 and 6000 the ends of a grip step
///     b  2, 13, 80 N s/m                    range and its middle by ratio
///     m  0.3, 1.1, 4 kg                     the same
///
/// Stability is not monotone in stiffness, so corners alone are not enough. Always in the same order.
[[nodiscard]] std::vector<GridHand> HandGrid();

/// Parameters of an operator with that hand. Rotational stiffness, damping and inertia follow from the
/// translational ones with a lever of 0.1 m, about the width of a grip (assumed). Parameters that the grid
/// does not set are taken from `rest`.
[[nodiscard]] OperatorHandParams OperatorWith(const GridHand& hand, OperatorHandParams rest = {});

}  // namespace osteon::hil
