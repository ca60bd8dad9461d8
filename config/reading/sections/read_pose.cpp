#include "config/reading/sections/read_pose.h"

namespace osteon::config {

Pose ReadPose(Reader section) {
  const Vector3 p_m = section.Triple("position_mm", -5000, 5000),
                rpy_rad = section.Triple("rpy_deg", -360, 360);
  const Eigen::Quaterniond turn = Eigen::AngleAxisd(rpy_rad.z(), Vector3::UnitZ()) *
                                  Eigen::AngleAxisd(rpy_rad.y(), Vector3::UnitY()) *
                                  Eigen::AngleAxisd(rpy_rad.x(), Vector3::UnitX());
  Pose X = Pose::Identity();
  X.linear() = turn.toRotationMatrix();
  X.translation() = p_m;
  return X;
}

}  // namespace osteon::config
