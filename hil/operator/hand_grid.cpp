#include "hil/operator/hand_grid.h"

#include <fmt/format.h>

namespace osteon::hil {

std::vector<GridHand> NamedHands() {
  return {{"published", 135.0, 6.45, 0.554},
          {"firm", 500.0, 20.0, 1.5},
          {"stiff", 3000.0, 60.0, 3.0},
          {"fixture", 20000.0, 50.0, 0.0},
          {"clamp", 50000.0, 50.0, 0.0}};
}

std::vector<GridHand> HandGrid() {
  std::vector<GridHand> grid = NamedHands();
  for (const double k : {50.0, 300.0, 1500.0, 6000.0, 10000.0})
    for (const double b : {2.0, 13.0, 80.0})
      for (const double m : {0.3, 1.1, 4.0})
        grid.push_back({fmt::format("{} N/m, {} N s/m, {} kg", k, b, m), k, b, m});
  return grid;
}

OperatorHandParams OperatorWith(const GridHand& hand, OperatorHandParams rest) {
  constexpr double kLever2_m2 = 0.1 * 0.1;  // square of the lever of 0.1 m that converts to rotational values
  rest.stiffness_N_per_m = hand.stiffness_N_per_m;
  rest.damping_Ns_per_m = hand.damping_Ns_per_m;
  rest.mass_kg = hand.mass_kg;
  rest.stiffness_Nm_per_rad = kLever2_m2 * hand.stiffness_N_per_m;
  rest.damping_Nms_per_rad = kLever2_m2 * hand.damping_Ns_per_m;
  rest.inertia_kgm2 = kLever2_m2 * hand.mass_kg;
  return rest;
}

}  // namespace osteon::hil
