#include "kinematics/spatial.h"

namespace osteon {

Vector3 LogRotation(const Matrix3& R) OSTEON_RT {
  const Eigen::AngleAxisd a{R};
  return a.angle() * a.axis();
}

Matrix3 ExpRotation(const Vector3& r) OSTEON_RT {
  const double angle = r.norm();
  if (angle == 0.0) return Matrix3::Identity();
  return Eigen::AngleAxisd(angle, r / angle).toRotationMatrix();
}

double RotationAngle(const Matrix3& R) OSTEON_RT { return Eigen::AngleAxisd(R).angle(); }

Matrix3 RotationFromZTo(const Vector3& axis) {
  return Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), axis).toRotationMatrix();
}

}  // namespace osteon
