#include "control/coupling/hand_over.h"

#include <algorithm>

namespace osteon::control {
namespace {

constexpr double kMinForce_N = 1e-9;  // a smaller force has no defined direction

Wrench Scaled(const Wrench& F, double share) OSTEON_RT { return {.f = share * F.f, .t = share * F.t}; }

// Scales a hand-over down if the spring's force has fallen since the hand-over began, as when planes release
// the tool.
HandOver AtForce(HandOver hand_over, double spring_N) OSTEON_RT {
  if (spring_N >= hand_over.spring_N) return hand_over;
  hand_over.F_T_W = Scaled(hand_over.F_T_W, spring_N / hand_over.spring_N);
  hand_over.spring_N = spring_N;
  return hand_over;
}

// Returns a wrench with the direction of `before` and the force of `after`. A larger `before` is scaled down.
// A smaller `before` is not scaled up: a part of `after` is added.
Wrench WithSizeOf(Wrench before, const Wrench& after) OSTEON_RT {
  const double after_N = after.f.norm();
  const double against_N = std::min(0.0, before.f.dot(after.f) / after_N);  // <= 0
  // remove a component opposite to `after`, which rounding or motion may cause
  before.f -= against_N / after_N * after.f;
  const double before_N = before.f.norm();
  if (before_N <= kMinForce_N) return after;
  const double share = std::min(1.0, after_N / before_N), rest = std::max(0.0, 1.0 - before_N / after_N);
  return {.f = share * before.f + rest * after.f, .t = share * before.t + rest * after.t};
}

}  // namespace

void BeginHandOver(HandOver& hand_over, const HandOverRate& rate, const Wrench& before,
                   const Wrench& after) OSTEON_RT {
  const double turning_N_per_s = hand_over.turn_N_per_s;
  hand_over = {};
  if (after.f.norm() <= kMinForce_N) return;
  const Wrench first = WithSizeOf(before, after);  // wrench at the beginning of the turn
  const Wrench difference{.f = first.f - after.f, .t = first.t - after.t};
  const double difference_N = difference.f.norm();
  if (difference_N <= kMinForce_N) return;
  // a frame that arrives during a turn does not slow the turn down
  hand_over = {
      .F_T_W = difference,
      .spring_N = after.f.norm(),
      .turn_N_per_s = std::max({turning_N_per_s, difference_N / rate.return_s, rate.min_turn_N_per_s})};
}

Wrench ApplyHandOver(const HandOver& hand_over, const Wrench& after) OSTEON_RT {
  if (hand_over.spring_N == 0.0) return after;
  const double after_N = after.f.norm();
  const Wrench remaining = AtForce(hand_over, after_N).F_T_W;
  const Wrench sum{.f = after.f + remaining.f, .t = after.t + remaining.t};
  const double sum_N = sum.f.norm();
  return sum_N > after_N ? Scaled(sum, after_N / sum_N) : sum;
}

Wrench StepHandOver(HandOver& hand_over, const Wrench& after, double dt_s) OSTEON_RT {
  if (hand_over.spring_N == 0.0) return after;
  hand_over = AtForce(hand_over, after.f.norm());
  const double remaining_N = hand_over.F_T_W.f.norm(), step_N = hand_over.turn_N_per_s * dt_s;
  if (remaining_N <= step_N + kMinForce_N) {
    hand_over = {};
    return after;
  }
  hand_over.F_T_W = Scaled(hand_over.F_T_W, 1.0 - step_N / remaining_N);
  return ApplyHandOver(hand_over, after);
}

double TimeLeft_s(const HandOver& hand_over) OSTEON_RT {
  return hand_over.turn_N_per_s > 0.0 ? hand_over.F_T_W.f.norm() / hand_over.turn_N_per_s : 0.0;
}

}  // namespace osteon::control
