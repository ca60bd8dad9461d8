#pragma once

#include "kinematics/spatial.h"
#include "plugin/include/osteon.h"

namespace osteon::plugin {

/// Largest coordinate of a pose and of a site, in G: beyond it the engines' floats do not resolve 0.1 mm.
inline constexpr double kMaxPosition_m = 1000.0;

/// Whether every number is finite, each coordinate within kMaxPosition_m, and the quaternion has a direction.
[[nodiscard]] bool IsUsable(const OsteonPose& pose) noexcept;
[[nodiscard]] bool IsFinite(const OsteonTwist& twist) noexcept;

/// @param pose  usable
[[nodiscard]] Pose ToPose(const OsteonPose& pose) noexcept;
[[nodiscard]] OsteonPose FromPose(const Pose& X) noexcept;
[[nodiscard]] Twist ToTwist(const OsteonTwist& twist) noexcept;
[[nodiscard]] OsteonWrench FromWrench(const Wrench& F) noexcept;

/// Converts a pose. @throws Failure naming the value, if the pose is null or not usable.
[[nodiscard]] Pose CheckedPose(const OsteonPose* pose);

}  // namespace osteon::plugin
