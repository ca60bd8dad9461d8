#pragma once

namespace osteon::simulation {

/// Predicts the number N of balls that a disjoint packing needs, so that a cut loses at most a mean depth of
/// `error_m` beyond the tool's sweep. The largest radius r is the same in the whole bone of volume V, as in
/// the cutting paper.
///
///     error = 0.33 r,   N = 0.77 V / (4/3 π r³)
///
/// In theory a packing that fills the share φ = 0.77 of the volume loses the depth φ r/2 = 0.385 r. Carved
/// packings lost 0.31 to 0.37 r. They held up to 1.8 times as many balls as predicted
/// (tests/bench/results/*/depth.csv), so the predicted number is rather too low.
/// @param volume_m3  of the bone
[[nodiscard]] double PredictDisjointBalls(double error_m, double volume_m3);

}  // namespace osteon::simulation
