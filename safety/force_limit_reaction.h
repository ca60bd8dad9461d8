#pragma once

#include <cstdint>
#include <limits>

#include "base/marker.h"
#include "kinematics/spatial.h"

namespace osteon::safety {

/// Reaction of the cell if the hand pushes harder than the coupling may resist: the coupling stays at its
/// force limit, and the tool sinks into bone.
enum class OnForceLimit : std::uint8_t {
  kYield = 0,  ///< no reaction besides the limited force: the tool moves in against the limited force and the
               ///< law's drag
  kSlow = 1,   ///< bounds the tool's speed into bone, which the hand feels as a drag
  kStop = 2,   ///< after ForceLimitReactionParams::stop_after_s at the limit, a fault and Stop 1
};

struct ForceLimitReactionParams {
  OnForceLimit reaction{OnForceLimit::kSlow};
  /// kSlow: factor on the bone's advance in the bound of the tool's speed, at the displacement at which the
  /// limit is just reached; 1 … 2. The factor decreases to 1 at slow_zone_m beyond this displacement, and to
  /// 2 - advance_factor at twice slow_zone_m, so that the tool stays near the zone's end.
  double advance_factor{1.1};
  /// kSlow: distance, beyond the displacement at which the limit is reached, over which the tool is slowed
  /// down to the bone's advance [m]; > 0.
  double slow_zone_m{0.5e-3};
  double stop_after_s{0.05};  ///< kStop: time at the limit until the fault; > 0
  /// Distance of the tool from its collision-free pose at which the cell stops, whatever the reaction; > 0.
  double max_tool_in_bone_m{std::numeric_limits<double>::infinity()};
};

/// Checks the parameters. @throws std::invalid_argument naming the field, the value and what is accepted.
void Validate(const ForceLimitReactionParams& params);

/// The coupling in a tick.
struct ForceLimitInput {
  Vector3 displacement_W{Vector3::Zero()};  ///< from the tool to its collision-free pose [m]
  double rendered_scale{1.0};   ///< share of the coupling's wrench that is rendered after all limits, 0 … 1
  double advance_m_per_s{0.0};  ///< the bone's advance along the displacement, >= 0
};

/// Reaction while a limit reduces the coupling. Measures how deep the tool is in bone, bounds the speed at
/// which it may go deeper, and decides when the cell has to stop. With d the displacement, a the deceleration
/// and T the period:
///
///     e     = |d| (1 - share)         part of |d| beyond the displacement at which the limit is reached
///     x     = min(2, e / zone)
///     v_max = (factor + (1 - factor) x) advance + sqrt((a T)^2 + 2 a max(0, zone - e)) - a T
///
/// v_max bounds the speed into bone, along -d. The terms after `advance` are the braking parabola of a stop.
/// The drag that the hand feels, (F_hand - F_limit) / v_max, therefore rises steadily until the tool moves
/// only as fast as the bone is cut.
class ForceLimitReaction {
 public:
  /// @throws std::invalid_argument as Validate. @param deceleration_m_per_s2 > 0 @param period_s > 0
  ForceLimitReaction(const ForceLimitReactionParams& params, double deceleration_m_per_s2, double period_s);

  /// Call once per tick, in contact or not.
  void Step(const ForceLimitInput& input) OSTEON_RT;

  /// Reduces the velocity's component into bone to the allowed speed. Acts on translation only, and never
  /// reverses the component: a tool that rotates into bone is not pushed out.
  /// @param v_before_W  velocity of the previous tick [m/s]; the tool is decelerated no harder than in a stop
  /// @param[in,out] v_W  velocity to reduce [m/s]  @returns whether v_W was changed
  [[nodiscard]] bool Limit(const Vector3& v_before_W, Vector3& v_W) const OSTEON_RT;

  /// Forgets all earlier ticks. Call it when rendering starts.
  void Reset() OSTEON_RT;

  [[nodiscard]] bool saturated() const OSTEON_RT { return saturated_; }  ///< a limit reduces the coupling
  /// Whether the cell must stop: the reaction is kStop, and the coupling was at its limit for stop_after_s.
  [[nodiscard]] bool must_stop() const OSTEON_RT;
  [[nodiscard]] double tool_in_bone_m() const OSTEON_RT { return depth_m_; }
  [[nodiscard]] bool too_deep() const OSTEON_RT { return !(depth_m_ <= params_.max_tool_in_bone_m); }

 private:
  ForceLimitReactionParams params_;
  double deceleration_m_per_s2_, period_s_;
  Vector3 into_bone_W_{Vector3::Zero()};  // unit vector into the bone; zero if no limit reduces the coupling
  // distance of the tool from its collision-free pose; v_max; time for which a limit has reduced the coupling
  // without interruption
  double depth_m_{0.0}, allowed_m_per_s_{0.0}, saturated_s_{0.0};
  bool saturated_{false};
};

}  // namespace osteon::safety
