// Constants and small formulas of the cutting model that both engines use: one text for C++ (simulation/) and
// GLSL (gpu/shaders/). Each engine has its own algorithms around them. Lengths in metres; the shaders compute
// in millimetres and convert.
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
// A decimal fraction in double precision. GLSL's suffix for doubles does not exist in C++, and a quotient of
// whole numbers is rounded like the decimal fraction.
#define OSTEON_DECIMAL(whole, scale) (double(whole) / double(scale))

/// Tool balls whose first contacts lie within this length of the tool's way count as touching at the same
/// time [m]. A cut ball lies this close to the ball that cut it, since it is stored in floats; without the
/// tolerance, rounding would choose between them.
OSTEON_CONST double kTieTolerance_m = OSTEON_DECIMAL(1, 100000000);

/// Upper limit of a lens volume in a normal [m^3]. Larger overlaps are no contacts any more, and the limit
/// keeps the shaders' sums within their range.
OSTEON_CONST double kMaxLensVolume = OSTEON_DECIMAL(5, 10) / 1000000000;

/// Balls smaller than this are gone [m].
OSTEON_CONST double kMinBallRadius = OSTEON_DECIMAL(1, 1000000);
/// If a ball's centre is closer to a capsule's axis than this share of the capsule's radius, the direction
/// from axis to centre needs a correction.
OSTEON_CONST double kOnAxis = OSTEON_DECIMAL(1, 1000);

/// A bin's pair may be farther away by this length times (1 - cosine) if its direction is nearer to the bin's
/// centre [m]. A cut wall touches with hundreds of balls at once, all equally far but for rounding; the
/// direction then decides.
OSTEON_CONST double kBinCentreBias_m = OSTEON_DECIMAL(5, 100000);

/// Pairs belong to a face within a cone of 30 degrees half angle about its normal (its cosine).
OSTEON_CONST double kFaceCosine = OSTEON_DECIMAL(866, 1000);
/// Two pairs face each other across a gap where the angle between their normals exceeds 143 degrees.
OSTEON_CONST double kOppositeCosine = OSTEON_DECIMAL(-8, 10);

/// Weight of the slack in the search for the constrained target (FindConstrainedGoal): planes that hold the
/// target back by 10 mm yield by 10 nm.
OSTEON_CONST double kHoldSlack = OSTEON_DECIMAL(1, 1000000);
/// Tolerance to which a plane is kept [m]: floats resolve positions of 30 mm to 4 nm.
OSTEON_CONST double kViolated_m = OSTEON_DECIMAL(1, 100000000);
/// Smallest pivot of the Gram matrix of unit normals. Below it the normals count as parallel.
OSTEON_CONST double kMinPivot = OSTEON_DECIMAL(1, 100000000) / 100000;
/// Limit on the rounds of the search for the holding planes, which usually needs about ten. Rounding alone
/// could make sets of planes recur for ever.
OSTEON_CONST int kMaxHoldRounds = 200;

/// A turn counts as this length of travel, so that a resting tool turns with the hand even if it slides by
/// some micrometres.
OSTEON_CONST double kRotationBias_m = OSTEON_DECIMAL(5, 1000000);
/// Share of the contact tolerance that a turn may use: the rest is left for sliding along the bone that holds
/// the tool.
OSTEON_CONST double kTurnToleranceShare = OSTEON_DECIMAL(35, 100);

/// Share of a frame's allowed travel (max_slide_m) that the slide may take while the rate law cuts. The
/// advance keeps the rest. Otherwise a tool that moves fast across bone in late frames would only slide, and
/// bone would stay although the force has the energy to remove it.
OSTEON_CONST double kSlideShare = OSTEON_DECIMAL(8, 10);

/// Gap at which a pair holds, if `room` is left between this pair and the pair that faces it across the tool.
/// Both yield until the tolerance is left, each by at most three quarters of it.
OSTEON_FUNCTION double YieldingGap(double gap, double room, double tolerance) {
  double max_lack = 0.75 * tolerance, half_lack = 0.5 * (tolerance - room);
  return gap + (half_lack < max_lack ? half_lack : max_lack);
}

/// Largest part of `normal`, the sum of the multipliers, that counts as force. Multipliers that balance each
/// other count only as far as the slack is worth at the coupling's stiffness.
OSTEON_FUNCTION double ForceMultiplierCap(double normal, double point_length, double slack) {
  double worth = 2.0 * (point_length + slack);
  return worth < normal ? worth : normal;
}

/// Weight that a face's width gives to the direction of the holding planes, against the face's mean normal.
/// @param narrow  length of the mean normal before normalisation: 1 for a single direction, 0.966 for
///   directions all over the face's cone
OSTEON_FUNCTION double WidthExactness(double narrow) {
  return (OSTEON_DECIMAL(983, 1000) - narrow) / OSTEON_DECIMAL(13, 1000);
}
/// Weight of the holding planes' direction against a face's mean normal, 0 … 1.
///
/// It is 0 where one face presses with a narrow patch of balls, because single normals are rough there. It is
/// 1 where several faces press: steep faces hold with more than their resultant, and errors of their means
/// would grow with that force. It is 1 too where a face is wide (a reamer in its cup), because the mean then
/// only shows the cone that it was taken over.
/// @param share  share of the face that holds most;  @param width  WidthExactness of the face
OSTEON_FUNCTION double Exactness(double share, double width) {
  double several = 4.0 * (1.0 - share), most = several < width ? width : several;
  return most < 0.0 ? 0.0 : most > 1.0 ? 1.0 : most;
}

/// Whether the tool slides while it turns: always, unless bone stops the turning tool before half the way
/// that it could slide without turning.
/// @param way, straight_way  travel with the turn and without it;  @param rotation_bias  kRotationBias_m
OSTEON_FUNCTION bool SlidesTurning(bool stopped, double way, double straight_way, double rotation_bias) {
  return !stopped || way + rotation_bias > 0.5 * straight_way;
}

#ifdef __cplusplus
// the quotients equal the decimal fractions
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
