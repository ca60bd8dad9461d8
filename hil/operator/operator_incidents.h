#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <variant>

#include "hil/operator/hand_spring.h"
#include "kinematics/spatial.h"

namespace osteon::hil {

// Events that change an operator beside the script. Times are the script's. An incident begins, may end, and
// is over when the hand is back at its script, return_s after its end.

/// The hand stiffens at once, as in fright: muscles and their antagonists contract together. This changes the
/// hand's resistance but not the wrench at that moment, so the present wrench is kept as an offset to the new
/// spring, whose rest position becomes nearly the hand's present place. A stiff hand holds its place and does
/// not press with a bounded force: its limit is max_force_N instead of the script's force limit. At the end
/// the wrench is kept once more, and fades while the hand returns to its script.
struct GripStep {
  double begin_s{0.0};
  double end_s{std::numeric_limits<double>::infinity()};
  double return_s{0.3};
  HandSpring spring{.stiffness_N_per_m = 6000.0, .stiffness_Nm_per_rad = 60.0};
};

/// The handle is clamped where it is at that moment, without preload: the hand's wrench drops to zero. A
/// clamp has no muscles: neither the script's force limit nor the hand's max_force_N and max_torque_Nm act,
/// and it does not tremble. At the end the hand takes over the clamp's wrench, as far as it can, and returns
/// to its script.
struct RigidClamp {
  double begin_s{0.0};
  double end_s{std::numeric_limits<double>::infinity()};
  double return_s{0.3};
  HandSpring spring{.stiffness_N_per_m = 50000.0,
                    .damping_Ns_per_m = 50.0,
                    .stiffness_Nm_per_rad = 500.0,
                    .damping_Nms_per_rad = 0.5};
};

/// A jerk F sin^2(pi t / jerk_s), bounded only by the hand's max_force_N. Then the hand opens within
/// release_s, is away, and grasps again, or never does.
struct StartledRelease {
  double begin_s{0.0};
  double jerk_N{0.0};                     ///< peak; the impulse is half of it times jerk_s
  double jerk_s{0.05};                    ///< 0: none
  PlainVector3 jerk_C{Vector3::UnitZ()};  ///< unit vector: direction, in the site's frame (+z out of the
                                          ///< bone)
  double release_s{0.03};
  double away_s{std::numeric_limits<double>::infinity()};  ///< from the open hand to the grasp's beginning
  double return_s{0.3};                                    ///< of the grasp
};

using HandIncident = std::variant<GripStep, RigidClamp, StartledRelease>;

/// The incidents of an operator, one after the other. Plain data, without a heap.
struct HandIncidents {
  static constexpr std::size_t kMax = 8;
  std::array<HandIncident, kMax> list{};
  std::size_t count{0};  ///< used entries, from the front of the list
};

/// When an incident begins, when it ends, and when the hand is back at its script; the last two may be
/// infinite.
struct IncidentTimes {
  double begin_s, end_s, over_s;
};
[[nodiscard]] IncidentTimes TimesOf(const HandIncident& incident) noexcept;

/// @throws std::invalid_argument "operator's incident N: NAME: found …, accepted …" on more incidents than
///   fit, a value out of range, an end before its beginning, or an incident that begins before the one ahead
///   of it is over.
void CheckIncidents(const HandIncidents& incidents);

/// The effect of the incidents on the hand at one moment; without an incident, the defaults.
struct IncidentMoment {
  static constexpr std::size_t kNone = HandIncidents::kMax;

  std::size_t holding{kNone};  ///< the incident whose spring holds the tool instead of the hand's own
  bool clamped{false};         ///< the spring is that of a RigidClamp
  bool after_clamp{false};     ///< the hand is returning from a clamp
  double back{1.0};            ///< progress of the return to the script: 0 under another spring, then up to 1
  double grip{1.0};            ///< share of the hand that holds on: 0 while it is away
  Vector3 jerk_C_N{Vector3::Zero()};
};

/// The effect of incidents that CheckIncidents accepted. A pure function of time.
[[nodiscard]] IncidentMoment MomentOf(const HandIncidents& incidents, double time_s) noexcept;

/// The spring of a GripStep or RigidClamp.
[[nodiscard]] const HandSpring& SpringOf(const HandIncident& incident) noexcept;

}  // namespace osteon::hil
