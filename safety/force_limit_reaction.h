#pragma once

#include <cstdint>
#include <limits>

#include "control/rt/marker.h"
#include "kinematics/spatial.h"

namespace osteon::safety {

/// What the cell does where the hand pushes harder than the coupling may resist: the coupling stays at its
/// force limit, and the tool sinks into bone.
enum class OnForceLimit : std::uint8_t {
  kYield = 0,  ///< nothing beside the coupling at its limit: the tool goes in against the law's drag alone
  kSlow = 1,   ///< the tool's speed into bone is bounded; the hand is told by a drag that rises to that bound
  kStop = 2,   ///< a fault, and Stop 1, after ForceLimitReactionParams::stop_after_s at the limit
};

struct ForceLimitReactionParams {
  OnForceLimit reaction{OnForceLimit::kSlow};
  /// kSlow: of the speed at which the material gives way, the tool's where the limit is just reached; at the
  /// zone's end it is 1 and at twice the zone 2 - advance_factor, so that the tool stays near the zone's end;
  /// 1 … 2.
  double advance_factor{1.1};
  /// kSlow: the way beyond the displacement at which the limit was reached, over which the tool is slowed
  /// down to that speed [m]; > 0.
  double slow_zone_m{0.5e-3};
  double stop_after_s{0.05};  ///< kStop; > 0
  /// Distance between the tool and its collision-free pose at which the cell stops, whatever the reaction; >
  /// 0.
  double max_tool_in_bone_m{std::numeric_limits<double>::infinity()};
};

/// @throws std::invalid_argument naming the field, the value and what is accepted.
void Validate(const ForceLimitReactionParams& params);

/// How a tick finds the coupling.
struct ForceLimitInput {
  Vector3 displacement_W{Vector3::Zero()};  ///< from the tool to its collision-free pose [m]
  double rendered_share{1.0};               ///< of the coupling that every limit lets through, 0 … 1
  double advance_m_per_s{0.0};              ///< speed at which the bone gives way along that way, >= 0
};

/// The state that is reached where a limit takes from the coupling: how deep the tool is in bone, how fast it
/// may go deeper, and when that has to end.
///
///     e     = |d| (1 - share)                          beyond where the limit was reached
///     x     = min(2, e / zone)
///     v_max = (factor + (1 - factor) x) advance + sqrt((a T)^2 + 2 a max(0, zone - e)) - a T     into bone, along -d
///
/// The last terms are the braking parabola of the stops with their deceleration a, so that the drag which the
/// hand feels, (F_hand - F_limit) / v_max, rises steadily until the tool advances with the material alone.
class ForceLimitReaction {
 public:
  /// @throws std::invalid_argument as Validate. @param deceleration_m_per_s2 > 0 @param period_s > 0
  ForceLimitReaction(const ForceLimitReactionParams& params, double deceleration_m_per_s2, double period_s);

  /// One tick. Once a tick, in contact or not.
  void Step(const ForceLimitInput& input) OSTEON_RT;

  /// Takes from a velocity what goes into bone faster than allowed. Translation only, and never beyond rest:
  /// a tool that turns into bone is not pushed out.
  /// @param v_before_W  of the tick before: it is slowed down no harder than a stop does [m/s]
  /// @param[in,out] v_W [m/s] @returns whether something was taken
  [[nodiscard]] bool Limit(const Vector3& v_before_W, Vector3& v_W) const OSTEON_RT;

  /// The tool takes up rendering.
  void Reset() OSTEON_RT;

  [[nodiscard]] bool saturated() const OSTEON_RT { return saturated_; }  ///< a limit takes from the coupling
  /// kStop: the time is over.
  [[nodiscard]] bool must_stop() const OSTEON_RT;
  [[nodiscard]] double tool_in_bone_m() const OSTEON_RT { return depth_m_; }
  [[nodiscard]] bool too_deep() const OSTEON_RT { return !(depth_m_ <= params_.max_tool_in_bone_m); }

 private:
  ForceLimitReactionParams params_;
  double deceleration_m_per_s2_, period_s_;
  Vector3 into_bone_W_{Vector3::Zero()};  // unit, zero without contact
  double depth_m_{0.0}, allowed_m_per_s_{0.0}, saturated_s_{0.0};
  bool saturated_{false};
};

}  // namespace osteon::safety
