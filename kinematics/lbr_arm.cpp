#include "kinematics/lbr_arm.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "base/number_text.h"
#include "kinematics/lbr_elbow.h"

namespace osteon::kinematics {
namespace {

constexpr double kPi = std::numbers::pi;

[[noreturn]] void Refuse(const std::string& name, double found, const char* accepted) {
  throw std::invalid_argument("arm: " + name + ": found " + base::NumberText(found) + ", accepted " +
                              accepted);
}

// Returns the parameters. @throws std::invalid_argument if a length or a limit is out of range.
const LbrParams& Validated(const LbrParams& params) {
  if (!std::isfinite(params.base_to_shoulder_m))
    Refuse("base_to_shoulder_m", params.base_to_shoulder_m, "a finite length");
  if (!std::isfinite(params.wrist_to_flange_m))
    Refuse("wrist_to_flange_m", params.wrist_to_flange_m, "a finite length");
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  if (!positive(params.shoulder_to_elbow_m)) Refuse("shoulder_to_elbow_m", params.shoulder_to_elbow_m, "> 0");
  if (!positive(params.elbow_to_wrist_m)) Refuse("elbow_to_wrist_m", params.elbow_to_wrist_m, "> 0");
  for (std::size_t i = 0; i < 7; ++i) {
    const JointLimits& limit = params.limits[i];
    const std::string name = "position limit of A" + std::to_string(i + 1) + " [rad]";
    if (!(limit.lower_rad >= -kPi && limit.lower_rad <= kPi))
      Refuse("lower " + name, limit.lower_rad, "-pi … pi");
    if (!(limit.upper_rad > limit.lower_rad && limit.upper_rad <= kPi))
      Refuse("upper " + name, limit.upper_rad, "above the lower one … pi");
  }
  return params;
}

}  // namespace

LbrArm::LbrArm(const LbrParams& params) : params_(Validated(params)), chain_(ChainFrom(params)) {}

Pose LbrArm::FlangePose(const JointVector& q) const OSTEON_RT { return chain_.FlangePose(q); }

Jacobian LbrArm::JacobianAt(const JointVector& q, const Vector3& p_F) const OSTEON_RT {
  const SerialChain<7>::Posture posture = chain_.ComputePosture(q);
  return chain_.JacobianAt(posture, posture.X_BF * p_F);
}

double LbrArm::ArmAngle(const JointVector& q) const OSTEON_RT {
  // columns of R_B2 and R_B3
  const double c1 = std::cos(q[0]), s1 = std::sin(q[0]), c2 = std::cos(q[1]), s2 = std::sin(q[1]);
  const double c3 = std::cos(q[2]), s3 = std::sin(q[2]);
  const Vector3 x_2(c1 * c2, s1 * c2, -s2), y_2(-s1, c1, 0.0), u(c1 * s2, s1 * s2, c2);
  const Vector3 x_3 = c3 * x_2 + s3 * y_2, y_3 = c3 * y_2 - s3 * x_2;

  // the normal of the elbow's plane is ± the axis of A4
  const Vector3 f = std::cos(q[3]) * u - std::sin(q[3]) * x_3;
  const Vector3 p_SW = params_.shoulder_to_elbow_m * u + params_.elbow_to_wrist_m * f;
  const double reach = p_SW.norm();
  const ElbowCircle circle = CircleAround(reach > 0.0 ? Vector3(p_SW / reach) : Vector3::UnitZ());
  const Vector3 m = q[3] < 0.0 ? Vector3(-y_3) : y_3;
  return std::atan2(-m.dot(circle.up), m.dot(circle.side));
}

const LbrSolution* LbrSolutions::Nearest(const JointVector& seed) const OSTEON_RT {
  if (!reachable()) return nullptr;
  const LbrSolution* best = nullptr;
  double best_distance = std::numeric_limits<double>::infinity();
  for (const LbrSolution& candidate : configuration) {
    const double distance = (candidate.q - seed).squaredNorm();
    if (!candidate.valid() || !(distance < best_distance)) continue;
    best = &candidate;
    best_distance = distance;
  }
  return best;
}

// One function of more than 60 lines, because each joint needs the frames of all joints before it.
LbrSolutions LbrArm::Solve(const Pose& X_BF, double arm_angle_rad, const JointVector& seed) const OSTEON_RT {
  LbrSolutions result;

  // position of the wrist relative to the shoulder, and the triangle of shoulder, elbow and wrist
  const ElbowTriangle triangle = TriangleTo(params_, ShoulderToWrist(params_, X_BF));
  result.out_of_reach_m = triangle.out_of_reach_m;
  if (!std::isfinite(X_BF.linear().sum() + arm_angle_rad))
    result.out_of_reach_m = std::numeric_limits<double>::quiet_NaN();
  if (!result.reachable()) return result;

  // the elbow on its circle: upper arm u, forearm f, normal m, outward direction d
  const ElbowCircle circle = CircleAround(triangle.axis);
  const double cos_psi = std::cos(arm_angle_rad), sin_psi = std::sin(arm_angle_rad);
  const Vector3 e = cos_psi * circle.up + sin_psi * circle.side;
  const Vector3 m = cos_psi * circle.side - sin_psi * circle.up;
  const Vector3 u = triangle.cos_shoulder * circle.axis + triangle.sin_shoulder * e;
  const Vector3 d = triangle.cos_shoulder * e - triangle.sin_shoulder * circle.axis;
  const Vector3 f = triangle.cos_elbow * u - triangle.sin_elbow * d;

  // joints of configuration 0 (q2, q4, q6 >= 0); first the shoulder, with R_B3 = [d m u]
  JointVector q;
  double sine = std::sqrt(u.x() * u.x() + u.y() * u.y()), c, s;
  if (sine < kFreeJoint) {
    sine = 0.0;
    q[0] = seed[0];
    c = std::cos(q[0]), s = std::sin(q[0]);
  } else {
    q[0] = std::atan2(u.y(), u.x());
    c = u.x() / sine, s = u.y() / sine;
  }
  q[1] = std::atan2(sine, u.z());
  q[2] = std::atan2(c * d.y() - s * d.x(), c * m.y() - s * m.x());  // y of frame 2 is (-s c 0)
  q[3] = std::atan2(triangle.sin_elbow, triangle.cos_elbow);

  // wrist: R_B4 = [m x f, m, f]
  const WristAngles wrist = SolveWrist(m.cross(f), m, f, X_BF.linear(), seed[4]);
  q.tail<3>() << wrist.turn, wrist.tilt, wrist.twist;

  // Each joint has two values, as computed and after a flip. Also compute how far each value is beyond the
  // limits. A flip of A2, A4 or A6 changes the sign of that joint and turns its neighbours by half a turn.
  std::array<JointVector, 2> q_of{q, {}};
  std::array<std::array<double, 7>, 2> beyond_of{};
  for (int i = 0; i < 7; ++i) q_of[1][i] = i % 2 == 1 ? -q[i] : q[i] - std::copysign(kPi, q[i]);
  for (std::size_t flipped = 0; flipped < 2; ++flipped) {
    for (std::size_t i = 0; i < 7; ++i) {
      const double value = q_of[flipped][static_cast<int>(i)];
      beyond_of[flipped][i] =
          std::max(params_.limits[i].lower_rad - value, value - params_.limits[i].upper_rad);
    }
  }
  for (unsigned k = 0; k < LbrSolutions::kConfigurations; ++k) {
    const unsigned flip2 = k & 1u, flip4 = k >> 1 & 1u, flip6 = k >> 2 & 1u;
    const std::array<unsigned, 7> flip{flip2, flip2, flip2 ^ flip4, flip4, flip4 ^ flip6, flip6, flip6};
    LbrSolution& solution = result.configuration[k];
    for (std::size_t i = 0; i < 7; ++i) {
      solution.q[static_cast<int>(i)] = q_of[flip[i]][static_cast<int>(i)];
      const double beyond = beyond_of[flip[i]][i];
      if (beyond <= 0.0) continue;
      solution.beyond = static_cast<std::uint8_t>(solution.beyond | 1u << i);
      if (!(beyond > solution.beyond_rad)) continue;
      solution.beyond_rad = beyond;
      solution.worst_joint = static_cast<int>(i);
    }
  }
  return result;
}

bool LbrArm::Inverse(const Pose& X_BF, double arm_angle_rad, const JointVector& seed,
                     JointVector& q) const OSTEON_RT {
  const LbrSolutions solutions = Solve(X_BF, arm_angle_rad, seed);
  const LbrSolution* nearest = solutions.Nearest(seed);
  if (nearest == nullptr) return false;
  q = nearest->q;
  return true;
}

}  // namespace osteon::kinematics
