#include "simulation/fidelity/disjoint_balls.h"

#include <numbers>

namespace osteon::simulation {
namespace {

// the fitted constants of the header: lost depth divided by the balls' radius, and share of the bone's volume
// that balls fill
constexpr double kErrorOverRadius = 0.33;
constexpr double kSolidFraction = 0.77;

}  // namespace

double PredictDisjointBalls(double error_m, double volume_m3) {
  const double r = error_m / kErrorOverRadius;
  return kSolidFraction * volume_m3 / (4.0 / 3.0 * std::numbers::pi * r * r * r);
}

}  // namespace osteon::simulation
