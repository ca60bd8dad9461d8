#pragma once

#include <cstdint>

// Error bounds of the kernels' floats. Floats only exclude pairs that do not matter; the remaining pairs are
// computed in double precision by the reference engine's own formulas. So every comparison of floats needs a
// margin for the rounding error.
//
// With u = 2^-24 (one rounding to float is at most u times the value), E the largest coordinate of a tool
// ball, R and r the radii of tool and bone ball, g the gap, all in millimetres:
//
//     place        a tool ball's coordinate is rounded once                        u E each, √3 u E together
//                  (bone balls and mass points are floats by themselves)
//     difference   from = place - centre                                            u d
//     distance     d = √(x² + y² + z²): three products and two sums, ½ · 3 u;
//                  the root itself, u                                               2.5 u d
//     radius       R is rounded once                                                u R
//     gap          g = (d - R) - r: two differences                                 u (r + |g|) + u |g|
//
// With d = R + r + g the sum is at most u (1.74 E + 4.5 (R + r) + 5.5 |g|). This also holds with fused
// multiply-adds, which round less often. Gaps that are compared are at most `reach`. The places of a frame
// lie between its start and its goal, or beyond by at most `reach`. A row's bound, and the displacement that
// is subtracted from it, are rounded several times more, by u (|g| + displacement) each. Lists are rebuilt
// before the displacement exceeds ten times `reach` (ListKeeper).
//
// A direction is from / d, so its error is √3 u E / d for the place, plus a few u for difference, distance,
// quotient and the turn into T: below RoundingOfGap() / d + kDirectionRounding (2^-20 is 16 u).

namespace osteon::simulation::cpu {

/// Largest error in floats of a gap of up to `reach_mm` to a tool ball [mm].
/// @param extent_mm  largest coordinate of the tool ball's centre
[[nodiscard]] constexpr float RoundingOfGap(float extent_mm, float tool_radius_mm, float max_ball_radius_mm,
                                            float reach_mm) {
  return 0x1p-24f *
         (2.0f * (extent_mm + reach_mm) + 5.0f * (tool_radius_mm + max_ball_radius_mm) + 64.0f * reach_mm);
}

/// Largest error in floats of a direction's component, without the part that is proportional to 1 / distance.
inline constexpr float kDirectionRounding = 0x1p-20f;

/// Boxes and reaches of lists are wider by this [mm]: more than any of the roundings above for a bone within
/// 2 m.
inline constexpr float kListSlack_mm = 2e-3f;

}  // namespace osteon::simulation::cpu
