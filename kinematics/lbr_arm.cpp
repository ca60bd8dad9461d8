#include "kinematics/lbr_arm.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace osteon::kinematics {
namespace {

constexpr double kReachSlack_m = 1e-12;  // rounding of a stretched arm's own forward kinematics
constexpr double kStraightElbow =
    1e-6;  // sine below which the elbow counts as on the line: moves the wrist by < 1 pm
constexpr double kVerticalLine =
    1e-9;  // sine below which the shoulder-wrist line has no highest point around it
constexpr double kFreeJoint = 1e-12;  // sine below which a direction says nothing about the angle around it

Matrix3 RotationY(double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  Matrix3 R;
  R << c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c;
  return R;
}

Matrix3 RotationZ(double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  Matrix3 R;
  R << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
  return R;
}

// The elbow's circle seen from the shoulder: `axis` along shoulder to wrist, `up` to its highest point, side
// = axis x up.
struct ElbowCircle {
  Vector3 axis, up, side;
};

ElbowCircle CircleAround(const Vector3& p_SW) {
  ElbowCircle circle;
  circle.axis = p_SW.normalized();
  Vector3 up = Vector3::UnitZ() - circle.axis.z() * circle.axis;
  if (up.norm() < kVerticalLine) up = Vector3::UnitX() - circle.axis.x() * circle.axis;
  circle.up = up.normalized();
  circle.side = circle.axis.cross(circle.up);
  return circle;
}

// Points and axes of a posture, in B.
struct Posture {
  std::array<Vector3, 7> axis;
  Vector3 p_shoulder, p_elbow, p_wrist;
  Pose X_BF;
};

Posture PostureOf(const LbrParams& params, const JointVector& q) {
  Posture a;
  Matrix3 R = Matrix3::Identity();
  a.axis[0] = R.col(2);
  R *= RotationZ(q[0]);
  a.p_shoulder = Vector3(0.0, 0.0, params.base_to_shoulder_m);
  a.axis[1] = R.col(1);
  R *= RotationY(q[1]);
  a.axis[2] = R.col(2);
  R *= RotationZ(q[2]);
  a.p_elbow = a.p_shoulder + params.shoulder_to_elbow_m * R.col(2);
  a.axis[3] = -R.col(1);
  R *= RotationY(-q[3]);
  a.axis[4] = R.col(2);
  R *= RotationZ(q[4]);
  a.p_wrist = a.p_elbow + params.elbow_to_wrist_m * R.col(2);
  a.axis[5] = R.col(1);
  R *= RotationY(q[5]);
  a.axis[6] = R.col(2);
  R *= RotationZ(q[6]);
  a.X_BF = Pose::Identity();
  a.X_BF.linear() = R;
  a.X_BF.translation() = a.p_wrist + params.wrist_to_flange_m * R.col(2);
  return a;
}

// Angles of Rz(turn) Ry(tilt) z = direction with the tilt of the given sign; the turn is `free` where the
// tilt is 0.
struct TurnTilt {
  double turn, tilt;
};

TurnTilt DirectionAngles(const Vector3& direction, double sign, double free) {
  const double sine = std::hypot(direction.x(), direction.y());
  if (sine < kFreeJoint) return {free, std::atan2(0.0, direction.z())};
  return {std::atan2(sign * direction.y(), sign * direction.x()), sign * std::atan2(sine, direction.z())};
}

}  // namespace

Pose LbrArm::FlangePose(const JointVector& q) const noexcept { return PostureOf(params_, q).X_BF; }

Jacobian LbrArm::FlangeJacobian(const JointVector& q) const noexcept {
  const Posture a = PostureOf(params_, q);
  Jacobian J;
  for (int i = 0; i < 7; ++i) {
    const Vector3& axis = a.axis[static_cast<std::size_t>(i)];
    const Vector3& p_joint = i < 3 ? a.p_shoulder : i == 3 ? a.p_elbow : a.p_wrist;
    J.block<3, 1>(0, i) = axis.cross(a.X_BF.translation() - p_joint);
    J.block<3, 1>(3, i) = axis;
  }
  return J;
}

double LbrArm::ArmAngle(const JointVector& q) const noexcept {
  const Posture a = PostureOf(params_, q);
  const ElbowCircle circle = CircleAround(a.p_wrist - a.p_shoulder);
  const Vector3 p_SE = a.p_elbow - a.p_shoulder;
  const double up = circle.up.dot(p_SE), side = circle.side.dot(p_SE);
  if (std::hypot(up, side) < kStraightElbow * params_.shoulder_to_elbow_m) return 0.0;
  return std::atan2(side, up);
}

bool LbrArm::Inverse(const Pose& X_BF, double arm_angle_rad, const JointVector& seed,
                     JointVector& q) const noexcept {
  const double upper = params_.shoulder_to_elbow_m, fore = params_.elbow_to_wrist_m;

  // wrist from the shoulder; within reach?
  const Vector3 p_SW = X_BF.translation() - params_.wrist_to_flange_m * X_BF.linear().col(2) -
                       Vector3(0.0, 0.0, params_.base_to_shoulder_m);
  const double reach = p_SW.norm();
  const bool reachable =
      reach > 0.0 && reach <= upper + fore + kReachSlack_m && reach >= std::abs(upper - fore);
  if (!reachable) return false;  // also where it is not a number

  // elbow from the shoulder: cosine rule in the triangle, then the place on the circle
  const double cosine = std::min(1.0, (reach * reach + upper * upper - fore * fore) / (2.0 * reach * upper));
  double sine = std::sqrt((1.0 - cosine) * (1.0 + cosine));
  if (sine < kStraightElbow) sine = 0.0;
  const ElbowCircle circle = CircleAround(p_SW);
  const Vector3 upper_arm = cosine * circle.axis + sine * (std::cos(arm_angle_rad) * circle.up +
                                                           std::sin(arm_angle_rad) * circle.side);
  const Vector3 forearm = sine == 0.0 ? upper_arm : Vector3((p_SW - upper * upper_arm).normalized());

  // the eight postures; keep the nearest that every limit allows
  JointVector best = seed;
  double best_distance = std::numeric_limits<double>::infinity();
  for (const double sign2 : {1.0, -1.0}) {
    const TurnTilt shoulder = DirectionAngles(upper_arm, sign2, seed[0]);
    const Matrix3 R_B2 = RotationZ(shoulder.turn) * RotationY(shoulder.tilt);
    for (const double sign4 : {1.0, -1.0}) {
      // A4 turns about -y, hence the sign of its tilt
      const TurnTilt elbow = DirectionAngles(R_B2.transpose() * forearm, -sign4, seed[2]);
      const Matrix3 R_B4 = R_B2 * RotationZ(elbow.turn) * RotationY(elbow.tilt);
      const Matrix3 R_4F = R_B4.transpose() * X_BF.linear();
      for (const double sign6 : {1.0, -1.0}) {
        const TurnTilt wrist = DirectionAngles(R_4F.col(2), sign6, seed[4]);
        // what is left is Ry(q6) Rz(q7), whose second row is (sin q7, cos q7, 0)
        const Eigen::RowVector3d row = RotationZ(wrist.turn).col(1).transpose() * R_4F;
        JointVector candidate;
        candidate << shoulder.turn, shoulder.tilt, elbow.turn, -elbow.tilt, wrist.turn, wrist.tilt,
            std::atan2(row.x(), row.y());
        bool allowed = true;
        for (int i = 0; i < 7; ++i) {
          const JointLimits& limit = params_.limits[static_cast<std::size_t>(i)];
          allowed = allowed && candidate[i] >= limit.lower_rad && candidate[i] <= limit.upper_rad;
        }
        const double distance = (candidate - seed).squaredNorm();
        if (!allowed || !(distance < best_distance)) continue;
        best = candidate;
        best_distance = distance;
      }
    }
  }
  if (!std::isfinite(best_distance)) return false;
  q = best;
  return true;
}

}  // namespace osteon::kinematics
