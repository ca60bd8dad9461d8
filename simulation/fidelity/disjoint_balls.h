#pragma once

namespace osteon::simulation {

/// Balls of a disjoint packing whose greatest radius is the same everywhere, for a cut that loses no more
/// than `error_m` beyond the tool's sweep: what a bone takes that is packed whole and alike, as in the
/// cutting paper.
///
///     error = .33 r,   N = .77 V / (4/3 π r³)
///
/// By theory a ball of solid fraction φ loses φ r/2 = .385 r; carved packings lost .31 to .37 r and held as
/// many balls or up to 1.8 times as many (tests/bench/results/*/depth.csv), so this is rather too few.
/// @param volume_m3  of the bone
[[nodiscard]] double PredictDisjointBalls(double error_m, double volume_m3);

}  // namespace osteon::simulation
