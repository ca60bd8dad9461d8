#pragma once

#include <cstdint>
#include <limits>

#include "base/marker.h"
#include "kinematics/spatial.h"

namespace osteon::safety {

/// Reaction of the cell if the hand pushes harder than the coupling may resist: the coupling stays at its
/// force limit, and the tool sinks into bone.
enum class OnForceLimit : std::uint8_t {
  kYield = 0,  ///< only the limited coupling: the tool moves in against the law's drag alone
  kSlow = 1,   ///< bounds the tool's speed into bone; the hand feels a drag that rises up to that bound
  kStop = 2,   ///< a fault, and Stop 1, after ForceLimitReactionParams::stop_after_s at the limit
};

struct ForceLimitReactionParams {
  OnForceLimit reaction{OnForceLimit::kSlow};
  /// kSlow: the tool's speed where the limit is just reached, over the speed at which the material gives way.
  /// The factor is 1 at the zone's end and 2 - advance_factor at twice the zone, so that the tool stays near
  /// the zone's end; 1 … 2.
  double advance_factor{1.1};
  /// kSlow: the tool slows down to that speed over this distance beyond the displacement at which the limit
  /// was reached [m]; > 0.
  double slow_zone_m{0.5e-3};
  double stop_after_s{0.05};  ///< kStop: time at the limit until the fault; > 0
  /// Distance of the tool from its collision-free pose at which the cell stops, with every reaction; > 0.
  double max_tool_in_bone_m{std::numeric_limits<double>::infinity()};
};

/// @throws std::invalid_argument naming the field, the value and what is accepted.
void Validate(const ForceLimitReactionParams& params);

/// The coupling in a tick.
struct ForceLimitInput {
  Vector3 displacement_W{Vector3::Zero()};  ///< from the tool to its collision-free pose [m]
  double rendered_scale{1.0};               ///< share of the coupling that every limit passes, 0 … 1
  double advance_m_per_s{0.0};  ///< speed at which the bone gives way along the displacement, >= 0
};

/// Reaction while a limit reduces the coupling: measures how deep the tool is in bone, and decides how fast
/// it may go deeper and when the cell has to stop.
///
///     e     = |d| (1 - share)                          displacement beyond the point of the limit
///     x     = min(2, e / zone)
///     v_max = (factor + (1 - factor) x) advance + sqrt((a T)^2 + 2 a max(0, zone - e)) - a T     into bone, along -d
///
/// The last terms are the braking parabola of the stops with their deceleration a, so that the drag felt by
/// the hand, (F_hand - F_limit) / v_max, rises steadily until the tool advances with the material alone.
class ForceLimitReaction {
 public:
  /// @throws std::invalid_argument as Validate. @param deceleration_m_per_s2 > 0 @param period_s > 0
  ForceLimitReaction(const ForceLimitReactionParams& params, double deceleration_m_per_s2, double period_s);

  /// Call once per tick, in contact or not.
  void Step(const ForceLimitInput& input) OSTEON_RT;

  /// Removes the part of a velocity that goes into bone faster than allowed. Translation only, and at most to
  /// rest: a tool that turns into bone is not pushed out.
  /// @param v_before_W  velocity of the previous tick: the tool is slowed down at most as hard as by a stop
  /// [m/s]
  /// @param[in,out] v_W [m/s] @returns whether v_W was changed
  [[nodiscard]] bool Limit(const Vector3& v_before_W, Vector3& v_W) const OSTEON_RT;

  /// To be called when rendering starts.
  void Reset() OSTEON_RT;

  [[nodiscard]] bool saturated() const OSTEON_RT { return saturated_; }  ///< a limit reduces the coupling
  /// Whether the cell must stop: kStop, and the coupling was at its limit for stop_after_s.
  [[nodiscard]] bool must_stop() const OSTEON_RT;
  [[nodiscard]] double tool_in_bone_m() const OSTEON_RT { return depth_m_; }
  [[nodiscard]] bool too_deep() const OSTEON_RT { return !(depth_m_ <= params_.max_tool_in_bone_m); }

 private:
  ForceLimitReactionParams params_;
  double deceleration_m_per_s2_, period_s_;
  Vector3 into_bone_W_{Vector3::Zero()};  // unit, zero without contact
  // the tool from its collision-free pose; v_max; time for which a limit has reduced the coupling
  double depth_m_{0.0}, allowed_m_per_s_{0.0}, saturated_s_{0.0};
  bool saturated_{false};
};

}  // namespace osteon::safety
