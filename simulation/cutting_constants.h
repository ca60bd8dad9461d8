// Constants and small formulas of the cutting model that both engines use: one text for C++ (simulation/) and
// GLSL (gpu/shaders/). The algorithms around them are each engine's own. Lengths in metres; the shaders,
// which compute in millimetres, convert.
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
// A decimal fraction to double precision: GLSL's suffix for it is none in C++, and a quotient of whole
// numbers is rounded as the decimal fraction would be.
#define OSTEON_DECIMAL(whole, scale) (double(whole) / double(scale))

/// Tool balls that touch within this way of the tool touch at the same time [m]: a ball that was cut lies so
/// near to what has cut it, since it is stored in floats, and rounding would choose.
OSTEON_CONST double kSameTouch_m = OSTEON_DECIMAL(1, 100000000);

/// Lens volumes count up to this [m^3] in a normal: overlaps beyond it are no contacts any more, and the
/// shaders' sums stay within their range.
OSTEON_CONST double kLargestLensVolume = OSTEON_DECIMAL(5, 10) / 1000000000;

/// Balls smaller than this are gone [m].
OSTEON_CONST double kLeastBallRadius = OSTEON_DECIMAL(1, 1000000);
/// Closer to a capsule's axis than this share of its radius, a centre's direction from it is checked.
OSTEON_CONST double kOnAxis = OSTEON_DECIMAL(1, 1000);

/// What a bin's pair may be farther away and yet be taken, for a direction nearer to the bin's middle: times
/// 1 - cosine [m]. A wall that was cut touches with hundreds of balls at once, equally far but for rounding;
/// the direction then decides.
OSTEON_CONST double kMiddleWorth_m = OSTEON_DECIMAL(5, 100000);

/// Half angle of the cone about a face's normal in which pairs belong to it (cosine of 30 degrees).
OSTEON_CONST double kFaceCosine = OSTEON_DECIMAL(866, 1000);
/// Two pairs face each other across a gap where the angle between their normals is above 143 degrees.
OSTEON_CONST double kOppositeCosine = OSTEON_DECIMAL(-8, 10);

/// Square of the slack's compliance against the point's: a hold of 10 mm yields by 10 nm.
OSTEON_CONST double kHoldSlack = OSTEON_DECIMAL(1, 1000000);
/// A plane is kept to within this [m]: floats tell places of 30 mm to 4 nm.
OSTEON_CONST double kViolated_m = OSTEON_DECIMAL(1, 100000000);
/// Of the Gram matrix of unit normals: below, they are parallel.
OSTEON_CONST double kMinPivot = OSTEON_DECIMAL(1, 100000000) / 100000;
/// Some ten are usual; rounding alone could make sets of planes come back.
OSTEON_CONST int kMaxHoldRounds = 200;

/// A turn is worth this much of a way: a tool that rests turns with the hand, whatever its micrometres of
/// slide.
OSTEON_CONST double kTurnWorth_m = OSTEON_DECIMAL(5, 1000000);
/// Share of the contact tolerance that a turn may use: the rest is for going along whatever holds it.
OSTEON_CONST double kTurnToleranceShare = OSTEON_DECIMAL(35, 100);

/// Share of what a frame may go (max_slide_m) that its slide may take while the rate law cuts. The rest is
/// the advance's: a tool that is led across bone fast, in frames that come late, would only slide else, and
/// bone would stay that its force has the energy to remove.
OSTEON_CONST double kSlideShare = OSTEON_DECIMAL(8, 10);

/// The gap that a pair holds at, where `room` is left between it and what faces it: both yield until the
/// tolerance is left, by three quarters of it at most.
OSTEON_FUNCTION double YieldingGap(double gap, double room, double tolerance) {
  double most = 0.75 * tolerance, half_lack = 0.5 * (tolerance - room);
  return gap + (half_lack < most ? half_lack : most);
}

/// Of multipliers that add up to `normal`, how much is worth a force: of those that balance one another only
/// as much as the slack is worth at the coupling's stiffness.
OSTEON_FUNCTION double ForceMultiplierCap(double normal, double point_length, double slack) {
  double worth = 2.0 * (point_length + slack);
  return worth < normal ? worth : normal;
}

/// How much a face's width asks for the direction in which the planes hold, against the face's mean normal.
/// @param narrow  length of the mean normal before it is made unit: 1 for one direction, .966 for all in the
///   face's cone
OSTEON_FUNCTION double WidthExactness(double narrow) {
  return (OSTEON_DECIMAL(983, 1000) - narrow) / OSTEON_DECIMAL(13, 1000);
}
/// How much the direction in which the planes hold counts against the mean normal of a face, 0 … 1: nothing
/// where one face presses with a narrow patch of balls, whose single normals are rough; all where several
/// faces press, since steep ones hold with more than their resultant and errors of their means would grow
/// with it, and where a face is wide (a reamer in its cup), since then the mean only tells which cone it was
/// taken over.
/// @param share  of the face that holds most;  @param width  WidthExactness of the face
OSTEON_FUNCTION double Exactness(double share, double width) {
  double several = 4.0 * (1.0 - share), most = several < width ? width : several;
  return most < 0.0 ? 0.0 : most > 1.0 ? 1.0 : most;
}

/// Whether the tool slides with its turn rather than straight: unless bone stops it so early that it goes
/// less than half as far.
/// @param way, straight_way  that it goes with the turn and without;  @param turn_worth  kTurnWorth_m
OSTEON_FUNCTION bool SlidesTurning(bool stopped, double way, double straight_way, double turn_worth) {
  return !stopped || way + turn_worth > 0.5 * straight_way;
}

#ifdef __cplusplus
// the quotients are what the decimal fractions are
static_assert(kSameTouch_m == 1e-8 && kLargestLensVolume == 0.5e-9 && kLeastBallRadius == 1e-6 &&
              kOnAxis == 1e-3 && kMiddleWorth_m == 0.05e-3 && kFaceCosine == 0.866 && kHoldSlack == 1e-6 &&
              kMinPivot == 1e-13 && kTurnWorth_m == 5e-6 && kTurnToleranceShare == 0.35 &&
              kSlideShare == 0.8);
}  // namespace osteon::simulation
#endif
#undef OSTEON_DECIMAL
#undef OSTEON_FUNCTION
#undef OSTEON_CONST
#endif
