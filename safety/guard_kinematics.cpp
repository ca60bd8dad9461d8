#include "safety/guard_kinematics.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include "base/number_text.h"

namespace osteon::safety {
namespace {

// tolerance of the length of an axis, or of a column of a rotation matrix
constexpr double kUnitTolerance = 1e-6;
constexpr std::size_t kElbow = 3;  // A4

// Throws std::invalid_argument unless X has a finite position and a rotation. @param name  for the message
void RequirePose(const Pose& X, const std::string& name) {
  const Matrix3 R = X.linear();
  const bool rotation = (R * R.transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff() < kUnitTolerance &&
                        R.determinant() > 0.0;
  if (!rotation || !X.matrix().allFinite())
    throw std::invalid_argument("guard: " + name + ": accepted a finite position and a rotation");
}

// Rodrigues' formula: rotates v about the unit vector a.
Vector3 Rotate(const Vector3& a, double cosine, double sine, const Vector3& v) OSTEON_RT {
  return cosine * v + sine * a.cross(v) + (1.0 - cosine) * a.dot(v) * a;
}

}  // namespace

GuardKinematics::GuardKinematics(const kinematics::ChainParams<7>& chain, const Pose& X_WB,
                                 const Pose& X_FT) {
  RequirePose(X_WB, "X_WB");
  RequirePose(X_FT, "X_FT");
  RequirePose(chain.X_LF, "the flange in the last link's frame");
  Matrix3 R_W = X_WB.linear();
  Vector3 p_W = X_WB.translation();
  for (std::size_t i = 0; i < kJoints; ++i) {
    const kinematics::RevoluteJoint& joint = chain.joints[i];
    const std::string name = "joint A" + std::to_string(i + 1);
    RequirePose(joint.X_PJ, name);
    const double length = joint.axis_J.norm();
    if (!(std::abs(length - 1.0) < kUnitTolerance))
      throw std::invalid_argument("guard: " + name + ": axis: found a length of " + base::NumberText(length) +
                                  ", accepted 1");
    p_W += R_W * joint.X_PJ.translation();
    R_W = R_W * joint.X_PJ.linear();
    origin_W_[i] = p_W;
    axis_W_[i] = R_W * joint.axis_J / length;
  }
  // A description may put the origin of A4 anywhere on its axis. The elbow is the point of this axis nearest
  // to the axis of A3.
  const Vector3 &a = axis_W_[kElbow], &b = axis_W_[kElbow - 1], normal = a.cross(b);
  const Vector3 between = origin_W_[kElbow - 1] - origin_W_[kElbow];
  const double along_m =
      normal.norm() > kUnitTolerance ? between.cross(b).dot(normal) / normal.squaredNorm() : 0.0;
  p_WElbow_ = origin_W_[kElbow] + along_m * a;
  p_WFlange_ = p_W + R_W * chain.X_LF.translation();
  const Matrix3 R_WF = R_W * chain.X_LF.linear();
  p_WT_ = p_WFlange_ + R_WF * X_FT.translation();
  R_WT_ = R_WF * X_FT.linear();
}

GuardKinematics::Turns GuardKinematics::ComputeTurns(const Joints& q) OSTEON_RT {
  Turns turns;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const double angle_rad = q[static_cast<Eigen::Index>(i)];
    turns[i] = {.cosine = std::cos(angle_rad), .sine = std::sin(angle_rad)};
  }
  return turns;
}

Vector3 GuardKinematics::TurnDirection(const Turns& turns, std::size_t count, Vector3 v_W) const OSTEON_RT {
  for (std::size_t i = count; i-- > 0;) v_W = Rotate(axis_W_[i], turns[i].cosine, turns[i].sine, v_W);
  return v_W;
}

Vector3 GuardKinematics::TurnPoint(const Turns& turns, std::size_t count, Vector3 p_W) const OSTEON_RT {
  for (std::size_t i = count; i-- > 0;)
    p_W = origin_W_[i] + Rotate(axis_W_[i], turns[i].cosine, turns[i].sine, p_W - origin_W_[i]);
  return p_W;
}

GuardKinematics::Placement GuardKinematics::ComputePlacement(const Joints& q) const OSTEON_RT {
  const Turns turns = ComputeTurns(q);
  Placement placement;
  placement.p_WT = TurnPoint(turns, kJoints, p_WT_);
  placement.p_WFlange = TurnPoint(turns, kJoints, p_WFlange_);
  placement.p_WElbow = TurnPoint(turns, kElbow, p_WElbow_);  // joints A1 … A3 move the elbow; A4 does not
  for (int axis = 0; axis < 3; ++axis)
    placement.R_WT.col(axis) = TurnDirection(turns, kJoints, R_WT_.col(axis));
  return placement;
}

GuardKinematics::JointMotions GuardKinematics::ComputeJointMotions(const Joints& q,
                                                                   const Vector3& p_WP) const OSTEON_RT {
  const Turns turns = ComputeTurns(q);
  JointMotions motions;
  for (std::size_t i = 0; i < kJoints; ++i) {
    motions.w[i] = TurnDirection(turns, i, axis_W_[i]);
    motions.v[i] = motions.w[i].cross(p_WP - TurnPoint(turns, i, origin_W_[i]));
  }
  return motions;
}

}  // namespace osteon::safety
