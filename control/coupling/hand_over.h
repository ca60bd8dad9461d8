#pragma once

#include "base/marker.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Limits of the speed at which a change of planes turns the coupling's force.
struct HandOverRate {
  double return_s{0.008};          ///< longest duration of a turn; > 0
  double min_turn_N_per_s{500.0};  ///< smallest speed of a turn, so that a small turn ends sooner; > 0
};

/// State of a hand-over. After construction, no hand-over is in progress. Plain data.
struct HandOver {
  Wrench F_T_W;          ///< remaining difference to the spring wrench of the new planes, on T at To, in W
  double spring_N{0.0};  ///< smallest spring force of the new planes since the hand-over began
  double turn_N_per_s{0.0};  ///< speed at which |F_T_W.f| falls
};

/// Turns the coupling's force from the planes of one frame to those of the next over some ticks.
///
/// From one frame to the next, planes may vanish or turn, or the force may be distributed differently over
/// them. Let F_1 be the spring's wrench by the previous planes, and F_2 the wrench by the present planes, at
/// the same pose of the tool, with the forces f_1 and f_2. The proxy of the previous tick satisfies the new
/// planes, because EvaluateCoupling holds back any plane that the proxy would violate. The new displacement
/// leads to the nearest point that satisfies the new planes. This point lies in the ball whose diameter is
/// the old displacement (Thales). So a change of planes does not raise the force, and turns it by less than a
/// right angle. But the turn may be a step of half the force. Therefore the rendered wrench is
///
///     F = F_2 + w E,   E = s F_1 + (1 - s |f_1|/|f_2|) F_2 - F_2,   s = min(1, |f_2|/|f_1|)
///
/// F begins with the old direction and the new magnitude. w falls from 1 to 0 at constant speed within
/// return_s. A small turn, at the speed min_turn_N_per_s, usually ends within one tick.
///
/// - |f| <= |f_2| in every tick: the force never exceeds that of the new planes.
/// - If |f_2| falls, |f| falls without delay, because E is scaled down with |f_2|. E vanishes when the new
///   planes release the tool.
/// - The force never pulls the tool into a plane: the old proxy satisfies the new planes, so f_1 pushes the
///   tool out of each of them.
/// - The energy tank pays for the work of w E.
///
/// Begins a hand-over. Call in the tick in which a frame's planes replace the previous ones.
/// @param before, after  spring wrenches by the old and by the new planes at this tick's pose; `before`
///   includes the rest of an earlier hand-over
void BeginHandOver(HandOver& hand_over, const HandOverRate& rate, const Wrench& before,
                   const Wrench& after) OSTEON_RT;

/// Advances the hand-over by one tick. Call in every tick, including the one of BeginHandOver.
/// @param after  spring wrench by the present planes
/// @returns the spring wrench to render; equals `after` once the hand-over has ended.
[[nodiscard]] Wrench StepHandOver(HandOver& hand_over, const Wrench& after, double dt_s) OSTEON_RT;

/// Applies the hand-over to the present spring wrench without advancing it.
[[nodiscard]] Wrench ApplyHandOver(const HandOver& hand_over, const Wrench& after) OSTEON_RT;

/// Time until the hand-over ends [s].
[[nodiscard]] double TimeLeft_s(const HandOver& hand_over) OSTEON_RT;

}  // namespace osteon::control
