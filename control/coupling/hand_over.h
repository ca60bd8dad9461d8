#pragma once

#include "base/marker.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// How fast a change of planes may turn the coupling's force.
struct HandOverRate {
  double return_s{0.008};          ///< the turn ends within this time; > 0
  double min_turn_N_per_s{500.0};  ///< least speed of the turn: a small turn ends sooner; > 0
};

/// The rest of a hand-over in progress. Plain data; none after construction.
struct HandOver {
  Wrench F_T_W;  ///< difference still to be turned, relative to the new planes' spring, on T at To, in W
  double spring_N{0.0};      ///< least force of the new planes since the hand-over began
  double turn_N_per_s{0.0};  ///< speed at which |F_T_W.f| falls
};

/// Turns the coupling's force from the planes of one frame to those of the next over some ticks.
///
/// From one frame to the next, planes may vanish, turn, or share the force in another way. At one pose of the
/// tool let F_1 be the spring's wrench by the previous planes, F_2 by the present planes, and f_1 and f_2
/// their forces. The proxy of the tick before satisfies the new planes (EvaluateCoupling holds back those
/// that it does not satisfy), and the new displacement is the nearest point of theirs to the tool. That point
/// lies in the ball over the old displacement (Thales): the force rises only by the tick's own motion, and
/// turns by less than a right angle. The turn alone may be a step of half the force. Therefore
///
///     F = F_2 + w E,   E = s F_1 + (1 - s |f_1|/|f_2|) F_2 - F_2,   s = min(1, |f_2|/|f_1|)
///
/// starts with the old direction and the new size, and w goes from 1 to 0 at constant speed within return_s.
/// A small turn goes at min_turn_N_per_s and so mostly within the tick itself. |f| <= |f_2| in every tick:
/// nothing beyond the planes' own force is rendered. A force that falls, falls at once, because E shrinks
/// with |f_2| and vanishes where the new planes release the tool. As the old proxy satisfies the new planes,
/// f_1 pushes the tool out of each of them: nothing pulls. The energy tank pays for the work of w E.
///
/// Begins a hand-over, in the tick in which a frame's planes replace others.
/// @param before, after  the spring by the old and new planes at this tick's pose; `before` includes the rest
///   of an earlier hand-over
void BeginHandOver(HandOver& hand_over, const HandOverRate& rate, const Wrench& before,
                   const Wrench& after) OSTEON_RT;

/// Advances the hand-over by one tick; the first tick counts too. @param after  the spring by the present
/// planes
/// @returns the spring's wrench to render; `after` itself once the hand-over has ended.
[[nodiscard]] Wrench StepHandOver(HandOver& hand_over, const Wrench& after, double dt_s) OSTEON_RT;

/// Applies the hand-over to the present spring without advancing it.
[[nodiscard]] Wrench ApplyHandOver(const HandOver& hand_over, const Wrench& after) OSTEON_RT;

/// Time until the hand-over ends [s].
[[nodiscard]] double TimeLeft_s(const HandOver& hand_over) OSTEON_RT;

}  // namespace osteon::control
