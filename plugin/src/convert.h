#pragma once

#include "kinematics/spatial.h"
#include "plugin/include/osteon.h"

namespace osteon::plugin {

/// Largest coordinate, in G, of a pose or a site. Beyond it the engines' float numbers do not resolve 0.1 mm.
inline constexpr double kMaxPosition_m = 1000.0;

/// Whether every number is finite, each coordinate within kMaxPosition_m, and the quaternion has a direction.
[[nodiscard]] bool IsUsable(const OsteonPose& pose) noexcept;
[[nodiscard]] bool IsFinite(const OsteonTwist& twist) noexcept;

/// Converts a pose. @param pose  one for which IsUsable is true
[[nodiscard]] Pose ToPose(const OsteonPose& pose) noexcept;
[[nodiscard]] OsteonPose FromPose(const Pose& X) noexcept;
[[nodiscard]] Twist ToTwist(const OsteonTwist& twist) noexcept;
[[nodiscard]] OsteonWrench FromWrench(const Wrench& F) noexcept;

/// Converts a pose. @throws Failure naming the value, if the pose is null or not usable.
[[nodiscard]] Pose CheckedPose(const OsteonPose* pose);

}  // namespace osteon::plugin
