#pragma once

#include <string>
#include <vector>

#include "hil/operator_hand.h"

namespace osteon::hil {

/// A human arm, or what is worse: spring, damper and mass at the tool.
struct GridHand {
  std::string name;
  double stiffness_N_per_m{0.0};
  double damping_Ns_per_m{0.0};
  double mass_kg{0.0};
};

/// Single hands: one that was published (from memory), those of the oracles of admittance control, and two
/// that are no hands, with which a loop is to be tried as well: a fixture, and the clamp of 50 kN/m (with the
/// damping of the fixture; nothing says it).
[[nodiscard]] std::vector<GridHand> NamedHands();

/// All hands that a cell is to be stable with: the named ones, and every combination of
///
///     k  50, 300, 1500, 6000, 10000 N/m     the range of human arms; 300 and 6000 the ends of a grip step
///     b  2, 13, 80 N s/m                    range and its middle by ratio
///     m  0.3, 1.1, 4 kg                     the same
///
/// Stability is not monotone in stiffness, so corners alone do not do. Always in the same order.
[[nodiscard]] std::vector<GridHand> HandGrid();

/// An operator with that hand. About the tool it is as stiff, damped and heavy as along it at a lever of .1
/// m, which is about what a grip is wide (assumed); what the grid does not say is as in `rest`.
[[nodiscard]] OperatorHandParams OperatorWith(const GridHand& hand, OperatorHandParams rest = {});

}  // namespace osteon::hil
