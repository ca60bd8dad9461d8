// Constants and small formulas of the cutting model that all engines use. The same file compiles as C++
// (simulation/) and as GLSL (gpu/shaders/). Lengths are in metres; the shaders compute in millimetres and
// convert.
#ifndef OSTEON_SIMULATION_CUTTING_CONSTANTS_H
#define OSTEON_SIMULATION_CUTTING_CONSTANTS_H

#ifdef __cplusplus
namespace osteon::simulation {
#define OSTEON_CONST inline constexpr
#define OSTEON_FUNCTION [[nodiscard]] constexpr
#else
#define OSTEON_CONST const
#define OSTEON_FUNCTION
#endif
// A decimal fraction in double precision. It is written as a quotient of whole numbers, because GLSL's suffix
// for doubles does not exist in C++. The quotient is rounded like the decimal fraction.
#define OSTEON_DECIMAL(whole, scale) (double(whole) / double(scale))

/// Tool balls whose first contacts lie within this length of the tool's path count as touching at the same
/// time [m]. Bone balls are stored as floats, so after a cut they touch the cutting balls only to within this
/// length. Without the tolerance, rounding would decide which tool ball touches first.
OSTEON_CONST double kTieTolerance_m = OSTEON_DECIMAL(1, 100000000);

/// Upper limit of a lens volume as a weight in a mean normal [m^3]. Larger overlaps are no longer contacts.
/// The limit also keeps the shaders' sums within their range.
OSTEON_CONST double kMaxLensVolume = OSTEON_DECIMAL(5, 10) / 1000000000;

/// Balls with a smaller radius are removed [m].
OSTEON_CONST double kMinBallRadius = OSTEON_DECIMAL(1, 1000000);
/// If a ball's centre is closer to a capsule's axis than this fraction of the capsule's radius, rounding
/// makes the direction from axis to centre inaccurate, so that it needs a correction.
OSTEON_CONST double kOnAxis = OSTEON_DECIMAL(1, 1000);

/// Weight [m] of the angle to the bin's centre when a bin's nearest pair is chosen: this length times (1 -
/// cosine) is added to the gap. At a cut wall, hundreds of balls touch at once, with gaps that differ only by
/// rounding; the direction then decides.
OSTEON_CONST double kBinCentreBias_m = OSTEON_DECIMAL(5, 100000);

/// Cosine of 30 degrees, the half angle of the cone about a face's normal: pairs in the cone belong to the
/// face.
OSTEON_CONST double kFaceCosine = OSTEON_DECIMAL(866, 1000);
/// Two pairs face each other across the tool if the angle between their normals exceeds 143 degrees. This is
/// its cosine.
OSTEON_CONST double kOppositeCosine = OSTEON_DECIMAL(-8, 10);

/// Weight of the slack in the search for the constrained target (FindConstrainedGoal): planes that hold the
/// target back by 10 mm yield by 10 nm.
OSTEON_CONST double kHoldSlack = OSTEON_DECIMAL(1, 1000000);
/// A smaller violation of a plane is accepted [m]. It is larger than the resolution of floats, 4 nm at 30 mm.
OSTEON_CONST double kViolated_m = OSTEON_DECIMAL(1, 100000000);
/// Smallest pivot of the Gram matrix of unit normals. Below it, the normals count as linearly dependent.
OSTEON_CONST double kMinPivot = OSTEON_DECIMAL(1, 100000000) / 100000;
/// Largest number of rounds in the search for the holding planes, which usually takes about ten. Without the
/// limit, sets of planes could recur for ever because of rounding.
OSTEON_CONST int kMaxHoldRounds = 200;

/// Travel that is added to a slide with the turn when it is compared with a slide without the turn
/// (SlidesTurning). So a tool at rest still turns with the hand, although a slide without the turn would be
/// some micrometres longer.
OSTEON_CONST double kRotationBias_m = OSTEON_DECIMAL(5, 1000000);
/// Fraction of the contact tolerance that a turn may use. The rest is left for sliding along the bone that
/// holds the tool.
OSTEON_CONST double kTurnToleranceShare = OSTEON_DECIMAL(35, 100);

/// Fraction of a frame's allowed travel (max_slide_m) that the slide may take while the rate law cuts. The
/// rest is reserved for the advance. Otherwise, when frames are late, a tool that moves fast across bone
/// would only slide, and bone would remain although there is enough energy to remove it.
OSTEON_CONST double kSlideShare = OSTEON_DECIMAL(8, 10);

/// Enlarged gap of a pair, if `room` < `tolerance` is left between this pair and the pair that faces it
/// across the tool. Both gaps grow by half of the missing room, but by at most three quarters of the
/// tolerance.
OSTEON_FUNCTION double YieldingGap(double gap, double room, double tolerance) {
  double max_lack = 0.75 * tolerance, half_lack = 0.5 * (tolerance - room);
  return gap + (half_lack < max_lack ? half_lack : max_lack);
}

/// Largest part of `normal`, the sum of the multipliers, that counts as force: 2 (point_length + slack).
/// Multipliers that balance each other are limited by this.
OSTEON_FUNCTION double ForceMultiplierCap(double normal, double point_length, double slack) {
  double worth = 2.0 * (point_length + slack);
  return worth < normal ? worth : normal;
}

/// Weight of the holding planes' direction against the face's mean normal, as far as it follows from the
/// face's width. It is not limited to 0 … 1 yet.
/// @param narrow  length of the mean normal before normalisation: 1 for a single direction, 0.966 for
///   directions all over the face's cone
OSTEON_FUNCTION double WidthExactness(double narrow) {
  return (OSTEON_DECIMAL(983, 1000) - narrow) / OSTEON_DECIMAL(13, 1000);
}
/// Weight of the holding planes' direction against a face's mean normal, 0 … 1.
///
/// It is 0 if one face presses with a narrow patch of balls, because the normals of single pairs are rough.
/// It is 1 if several faces press: steep faces press with a larger force than their resultant, and errors of
/// their mean normals would grow with that force. It is also 1 if a face is wide (a reamer in its cup),
/// because the mean normal then depends only on the cone over which it was taken.
/// @param share  part of the sum of multipliers that belongs to the face that holds most @param width
/// WidthExactness of the face
OSTEON_FUNCTION double Exactness(double share, double width) {
  double several = 4.0 * (1.0 - share), most = several < width ? width : several;
  return most < 0.0 ? 0.0 : most > 1.0 ? 1.0 : most;
}

/// Whether the tool slides with its turn. It does, unless bone stops the turning tool before half of the
/// length that it could slide without turning.
/// @param way, straight_way  travel with the turn and without it  @param rotation_bias  kRotationBias_m
OSTEON_FUNCTION bool SlidesTurning(bool stopped, double way, double straight_way, double rotation_bias) {
  return !stopped || way + rotation_bias > 0.5 * straight_way;
}

#ifdef __cplusplus
// checks that the quotients equal the decimal fractions
static_assert(kTieTolerance_m == 1e-8 && kMaxLensVolume == 0.5e-9 && kMinBallRadius == 1e-6 &&
              kOnAxis == 1e-3 && kBinCentreBias_m == 0.05e-3 && kFaceCosine == 0.866 && kHoldSlack == 1e-6 &&
              kMinPivot == 1e-13 && kRotationBias_m == 5e-6 && kTurnToleranceShare == 0.35 &&
              kSlideShare == 0.8);
}  // namespace osteon::simulation
#endif
#undef OSTEON_DECIMAL
#undef OSTEON_FUNCTION
#undef OSTEON_CONST
#endif
