#include "kinematics/spatial.h"

#include <cmath>

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

// Replaces Eigen's Quaterniond::FromTwoVectors, which uses a singular value decomposition for opposite
// vectors and would take 5 s to compile.
Matrix3 RotationFromZTo(const Vector3& axis) {
  constexpr double kOpposite = 1e-12;  // a direction whose cosine to z is this near to -1 counts as -z
  const Vector3 z = Vector3::UnitZ(), to = axis.normalized();
  const double c = to.dot(z);
  if (c < kOpposite - 1.0) return Vector3(1.0, -1.0, -1.0).asDiagonal();  // half a turn about x
  const double s = std::sqrt((1.0 + c) * 2.0), inverse = 1.0 / s;
  Eigen::Quaterniond q;
  q.vec() = z.cross(to) * inverse;
  q.w() = s * 0.5;
  return q.toRotationMatrix();
}

}  // namespace osteon
