#pragma once

#include "control/guidance/guidance_field.h"
#include "kinematics/spatial.h"

// Shared by the tests of the guidance: parameters of a corridor, and poses of a tool in it.

namespace osteon::control {

/// Default gains around an oblique axis, for a head of 44 mm diameter.
[[nodiscard]] inline GuidanceParams SomeGuidance() {
  GuidanceParams params;
  params.axis_W = Vector3(0.6, 0.2, 0.7).normalized();
  params.centre_W = {0.1, -0.2, 0.3};
  params.head_m = 0.022;
  return params;
}

/// Place of a tool in the corridor.
struct CorridorPlace {
  double height_m{0.0};  ///< height of the head's centre above the planned centre
  double aside_m{0.0};   ///< distance from the axis
  double tilt_rad{0.0};  ///< angle between the feed and the axis
};

/// Pose of a tool at this place of the corridor. The tool's feed points into the bone.
[[nodiscard]] inline Pose PoseAt(const GuidanceParams& params, const CorridorPlace& place) {
  const Matrix3 R_WC = RotationFromZTo(params.axis_W);
  Pose X_WT = Pose::Identity();
  X_WT.linear() = R_WC * ExpRotation(Vector3(3.141592653589793 - place.tilt_rad, 0, 0));
  const Vector3 head_W = params.centre_W + R_WC * Vector3(place.aside_m, 0, place.height_m);
  X_WT.translation() = head_W + params.head_m * X_WT.linear().col(2);
  return X_WT;
}

}  // namespace osteon::control
