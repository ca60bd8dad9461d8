#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <variant>

#include "hil/operator/hand_spring.h"
#include "kinematics/spatial.h"

namespace osteon::hil {

// Events that change the operator's hand independently of the script. Times are measured from the script's
// beginning. An incident begins, may end, and is over once the hand has returned to its script, return_s
// after the end.

/// The hand stiffens at once, as in fright: muscles and their antagonists contract together. This changes the
/// hand's stiffness and damping but not the wrench at that moment, so the present wrench becomes an offset of
/// the new spring. The new spring's position of equilibrium is therefore near the hand's present position. A
/// stiff hand holds its position instead of pressing with a bounded force: its limit is max_force_N instead
/// of the script's force limit. At the end the present wrench becomes an offset again, which fades while the
/// hand returns to its script.
struct GripStep {
  double begin_s{0.0};
  double end_s{std::numeric_limits<double>::infinity()};
  double return_s{0.3};
  HandSpring spring{.stiffness_N_per_m = 6000.0, .stiffness_Nm_per_rad = 60.0};
};

/// The handle is clamped at its present pose, without preload: the wrench on the handle becomes zero. A clamp
/// is no hand: the script's force limit and the hand's max_force_N and max_torque_Nm do not apply, and there
/// is no tremor. At the end the hand takes over the clamp's wrench within the hand's limits, and returns to
/// its script.
struct RigidClamp {
  double begin_s{0.0};
  double end_s{std::numeric_limits<double>::infinity()};
  double return_s{0.3};
  HandSpring spring{.stiffness_N_per_m = 50000.0,
                    .damping_Ns_per_m = 50.0,
                    .stiffness_Nm_per_rad = 500.0,
                    .damping_Nms_per_rad = 0.5};
};

/// The hand jerks with the force F sin^2(pi t / jerk_s), limited only by max_force_N. Then it opens within
/// release_s, is away for away_s, and grasps again within return_s. If away_s is infinite, the hand never
/// grasps again.
struct StartledRelease {
  double begin_s{0.0};
  double jerk_N{0.0};                     ///< F: peak force; the impulse is F/2 times jerk_s
  double jerk_s{0.05};                    ///< duration of the jerk; 0: no jerk
  PlainVector3 jerk_C{Vector3::UnitZ()};  ///< unit vector: direction, in the site's frame (+z out of the
                                          ///< bone)
  double release_s{0.03};
  double away_s{std::numeric_limits<double>::infinity()};  ///< time from the open hand to the beginning of
                                                           ///< the new grasp
  double return_s{0.3};                                    ///< duration of the new grasp
};

using HandIncident = std::variant<GripStep, RigidClamp, StartledRelease>;

/// The incidents of an operator in order of time. Plain data, no heap memory.
struct HandIncidents {
  static constexpr std::size_t kMax = 8;
  std::array<HandIncident, kMax> list{};
  std::size_t count{0};  ///< number of used entries at the front of the list
};

/// Times at which an incident begins, at which it ends, and at which the hand has returned to its script. The
/// last two may be infinite.
struct IncidentTimes {
  double begin_s, end_s, over_s;
};
[[nodiscard]] IncidentTimes TimesOf(const HandIncident& incident) noexcept;

/// @throws std::invalid_argument "operator's incident N: NAME: found …, accepted …" on more incidents than
///   fit, a value out of range, an end before its beginning, or an incident that begins before the previous
///   one is over.
void CheckIncidents(const HandIncidents& incidents);

/// The effect of the incidents on the hand at one moment. The defaults mean that no incident has an effect.
struct IncidentMoment {
  static constexpr std::size_t kNone = HandIncidents::kMax;

  std::size_t holding{kNone};  ///< index of the incident whose spring replaces the hand's own
  bool clamped{false};         ///< the spring is that of a RigidClamp
  bool after_clamp{false};     ///< the hand is returning from a clamp
  double back{1.0};  ///< c: progress of the return to the script: 0 while an incident's spring is used, then
                     ///< rising to 1
  double grip{1.0};  ///< G: share of the hand's wrench that the grip transmits; 0 while the hand is away
  Vector3 jerk_C_N{Vector3::Zero()};
};

/// Returns the effect of the incidents at a time. CheckIncidents must have accepted them. A pure function.
[[nodiscard]] IncidentMoment MomentOf(const HandIncidents& incidents, double time_s) noexcept;

/// The spring of a GripStep or RigidClamp.
[[nodiscard]] const HandSpring& SpringOf(const HandIncident& incident) noexcept;

}  // namespace osteon::hil
