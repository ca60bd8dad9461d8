#pragma once

#include <string>
#include <vector>

#include "hil/operator/operator_hand.h"

namespace osteon::hil {

/// Model of a human arm, or of a stiffer fixture for a harder test: spring, damper and mass at the tool.
struct GridHand {
  std::string name;
  double stiffness_N_per_m{0.0};
  double damping_Ns_per_m{0.0};
  double mass_kg{0.0};
};

/// Individual hands: a published one (from memory) and those of the oracles of admittance control. Two
/// further entries are no hands, but a loop should be tested with them too: a fixture, and a clamp of 50 kN/m
/// (its damping is assumed equal to the fixture's).
[[nodiscard]] std::vector<GridHand> NamedHands();

/// All hands with which a cell must be stable: the named ones, and every combination of
///
///     k  50, 300, 1500, 6000, 10000 N/m     the range of human arms; 300 and 6000 the ends of a grip step
///     b  2, 13, 80 N s/m                    the range of human arms, and its geometric middle
///     m  0.3, 1.1, 4 kg                     the same
///
/// Stability is not monotone in stiffness, so the corners of the ranges alone are not enough. The order is
/// always the same.
[[nodiscard]] std::vector<GridHand> HandGrid();

/// Parameters of an operator with that hand. Rotational stiffness, damping and inertia follow from the
/// translational ones with a lever of 0.1 m, about the width of a grip (assumed). Parameters that the grid
/// does not set are taken from `rest`.
[[nodiscard]] OperatorHandParams OperatorWith(const GridHand& hand, OperatorHandParams rest = {});

}  // namespace osteon::hil
