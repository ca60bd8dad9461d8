#pragma once

#include "control/rt/marker.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// How fast a change of planes may turn the coupling's force.
struct HandOverRate {
  double return_s{0.008};            ///< the whole turn is done within this; > 0
  double least_turn_N_per_s{500.0};  ///< a small turn is done sooner, at this speed; > 0
};

/// What a hand-over has still to turn. Plain data; as constructed there is nothing.
struct HandOver {
  Wrench F_T_W;              ///< what the new planes' spring still lacks, on T at To, in W
  double spring_N{0.0};      ///< least force of the new planes since the hand-over began
  double turn_N_per_s{0.0};  ///< at which |F_T_W.f| falls
};

/// Turns the coupling's force from the planes of one frame to those of the next over some ticks.
///
/// Planes may vanish from one frame to the next, turn, or share the force in another way. At one pose of the
/// tool let F_1 be the spring's wrench by the planes before, F_2 by the planes of now, f_1 and f_2 their
/// forces. The proxy of the tick before keeps the new planes (EvaluateCoupling holds back those that it does
/// not keep), and the new displacement is the nearest point of theirs to the tool. So it lies in the ball
/// over the old one (Thales): the force does not rise but by the tick's own motion, and it turns by less than
/// a right angle. That turn alone may be a step of half the force. Therefore
///
///     F = F_2 + w E,   E = s F_1 + (1 - s |f_1|/|f_2|) F_2 - F_2,   s = min(1, |f_2|/|f_1|)
///
/// starts with the old direction and the new size, and w goes from 1 to 0 at an even speed within return_s. A
/// small turn goes at least_turn_N_per_s and so mostly within the tick itself. |f| <= |f_2| in every tick:
/// nothing beyond the planes' own force is rendered, and a force that falls falls at once, for E shrinks with
/// |f_2| and is gone where the new planes let go. As the old proxy keeps the new planes, f_1 pushes the tool
/// out of each of them: nothing pulls. The energy tank pays for the work of w E.
///
/// BeginHandOver: in the tick in which a frame's planes replace others.
/// @param before, after  the spring by either at this tick's pose; `before` with what an earlier hand-over
/// left
void BeginHandOver(HandOver& hand_over, const HandOverRate& rate, const Wrench& before,
                   const Wrench& after) OSTEON_RT;

/// One tick's part of the way; the first tick takes one as well. @param after  the spring by the planes of
/// now
/// @returns the spring's wrench to render; `after` itself where nothing is left.
[[nodiscard]] Wrench StepHandOver(HandOver& hand_over, const Wrench& after, double dt_s) OSTEON_RT;

/// The same without a part of the way: what the hand-over makes of that spring now.
[[nodiscard]] Wrench ApplyHandOver(const HandOver& hand_over, const Wrench& after) OSTEON_RT;

/// Time until nothing is left [s].
[[nodiscard]] double TimeLeft_s(const HandOver& hand_over) OSTEON_RT;

}  // namespace osteon::control
