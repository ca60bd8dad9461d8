#include "plugin/src/convert.h"

#include <algorithm>
#include <cmath>

#include "plugin/src/result.h"

namespace osteon::plugin {
namespace {

template <std::size_t N>
bool AllFinite(const double (&values)[N]) noexcept {
  return std::all_of(values, values + N, [](double value) { return std::isfinite(value); });
}

}  // namespace

bool IsUsable(const OsteonPose& pose) noexcept {
  if (!AllFinite(pose.position_m) || !AllFinite(pose.orientation_wxyz)) return false;
  for (const double value : pose.position_m)
    if (std::abs(value) > kMaxPosition_m) return false;
  double norm2 = 0.0;
  for (const double value : pose.orientation_wxyz) norm2 += value * value;
  return norm2 > 1e-12 && std::isfinite(norm2);
}

bool IsFinite(const OsteonTwist& twist) noexcept {
  return AllFinite(twist.linear_m_per_s) && AllFinite(twist.angular_rad_per_s);
}

Pose ToPose(const OsteonPose& pose) noexcept {
  const auto& q = pose.orientation_wxyz;
  Pose X = Pose::Identity();
  X.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
  X.translation() = Vector3(pose.position_m[0], pose.position_m[1], pose.position_m[2]);
  return X;
}

OsteonPose FromPose(const Pose& X) noexcept {
  const Eigen::Quaterniond q(X.linear());
  const Vector3 p = X.translation();
  return {.position_m = {p.x(), p.y(), p.z()}, .orientation_wxyz = {q.w(), q.x(), q.y(), q.z()}};
}

Twist ToTwist(const OsteonTwist& twist) noexcept {
  return {.v = Vector3(twist.linear_m_per_s[0], twist.linear_m_per_s[1], twist.linear_m_per_s[2]),
          .w = Vector3(twist.angular_rad_per_s[0], twist.angular_rad_per_s[1], twist.angular_rad_per_s[2])};
}

OsteonWrench FromWrench(const Wrench& F) noexcept {
  return {.force_N = {F.f.x(), F.f.y(), F.f.z()}, .torque_Nm = {F.t.x(), F.t.y(), F.t.z()}};
}

Pose CheckedPose(const OsteonPose* pose) {
  CheckPointer(pose, "pose");
  if (!IsUsable(*pose))
    throw Failure(OSTEON_ERROR_ARGUMENT,
                  "pose: found a number that is not finite, a position beyond 1 km, or a quaternion of "
                  "length 0; accepted finite numbers within 1 km, and a quaternion with a direction");
  return ToPose(*pose);
}

}  // namespace osteon::plugin
