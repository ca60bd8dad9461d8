#pragma once

namespace osteon::simulation {

/// Number of balls of a disjoint packing, with one largest radius everywhere, whose cuts lose at most
/// `error_m` beyond the tool's sweep. The whole bone is packed alike, as in the cutting paper.
///
///     error = 0.33 r,   N = 0.77 V / (4/3 π r³)
///
/// In theory a ball of solid fraction φ loses φ r/2 = 0.385 r. Carved packings lost 0.31 to 0.37 r and held
/// up to 1.8 times as many balls (tests/bench/results/*/depth.csv), so the count is rather too low.
/// @param volume_m3  of the bone
[[nodiscard]] double PredictDisjointBalls(double error_m, double volume_m3);

}  // namespace osteon::simulation
