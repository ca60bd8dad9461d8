#include "kinematics/arm_angle_intervals.h"

#include <algorithm>
#include <limits>

#include "kinematics/lbr_elbow.h"

namespace osteon::kinematics {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kMaxEnds = 2 * ArmAngleIntervals::kMax;

// The function c cos(psi) + s sin(psi) + k of the arm angle psi.
struct Wave {
  double c{0.0}, s{0.0}, k{0.0};

  [[nodiscard]] double At(double cosine, double sine) const { return c * cosine + s * sine + k; }
  // Whether the wave is zero at every arm angle.
  [[nodiscard]] bool Vanishes() const { return std::abs(c) + std::abs(s) + std::abs(k) < kFreeJoint; }
};

Wave operator-(const Wave& a) { return {-a.c, -a.s, -a.k}; }
Wave operator+(const Wave& a, const Wave& b) { return {a.c + b.c, a.s + b.s, a.k + b.k}; }
Wave operator*(double factor, const Wave& a) { return {factor * a.c, factor * a.s, factor * a.k}; }

// A vector that turns with the elbow, by its components along three directions of lbr_elbow.h: axis a,
// direction e toward the elbow, normal m.
struct TurningVector {
  double a, e, m;
};

// Dot product of a turning vector with a fixed vector v, as a function of the arm angle psi:
// e = cos(psi) up + sin(psi) side, m = cos(psi) side - sin(psi) up.
Wave Dot(const TurningVector& t, const ElbowCircle& circle, const Vector3& v) {
  const double up = circle.up.dot(v), side = circle.side.dot(v);
  return {t.e * up + t.m * side, t.e * side - t.m * up, t.a * circle.axis.dot(v)};
}

// A joint of configuration 0 as a function of the arm angle: atan2(y, x) for a turning joint, acos(x) for a
// bending joint, fixed_rad for a joint that the arm angle does not move.
struct MovingJoint {
  enum class Kind { kTurning, kBending, kFixed } kind{Kind::kFixed};
  Wave x, y;  // turning joint: (x, y) is its direction; bending joint: x is its cosine, y is not used
  double fixed_rad{0.0};
};

// Finds the seven joints of configuration 0. The vectors u, d, m and f are those of lbr_elbow.h; x_4 is
// normal to f in the elbow's plane.
// @param upper_to_fore  length of the upper arm over that of the forearm
// @param seed  value of a joint that is free at every arm angle
std::array<MovingJoint, 7> JointsOf(const ElbowTriangle& t, const ElbowCircle& circle, double upper_to_fore,
                                    const Matrix3& R_BF, const JointVector& seed) {
  using enum MovingJoint::Kind;
  const Vector3 x = Vector3::UnitX(), y = Vector3::UnitY(), z = Vector3::UnitZ();
  // beta = |q4| - alpha; its sine comes from the law of sines, which is exact for a straight arm
  const double sin_beta = upper_to_fore * t.sin_shoulder;
  const double cos_beta = t.cos_elbow * t.cos_shoulder + t.sin_elbow * t.sin_shoulder;
  const TurningVector u{t.cos_shoulder, t.sin_shoulder, 0.0}, d{-t.sin_shoulder, t.cos_shoulder, 0.0};
  const TurningVector m{0.0, 0.0, 1.0}, f{cos_beta, -sin_beta, 0.0}, x_4{sin_beta, cos_beta, 0.0};
  const auto dot = [&circle](const TurningVector& vector, const Vector3& v) {
    return Dot(vector, circle, v);
  };
  const auto turning = [](const Wave& cosine, const Wave& sine) {
    return MovingJoint{.kind = kTurning, .x = cosine, .y = sine};
  };
  const auto bending = [](const Wave& cosine) { return MovingJoint{.kind = kBending, .x = cosine, .y = {}}; };
  const auto fixed = [](double q_rad) {
    return MovingJoint{.kind = kFixed, .x = {}, .y = {}, .fixed_rad = q_rad};
  };

  std::array<MovingJoint, 7> joint;
  joint[0] = turning(dot(u, x), dot(u, y));
  joint[1] = bending(dot(u, z));
  joint[2] = turning(-dot(d, z), dot(m, z));
  joint[3] = fixed(std::atan2(t.sin_elbow, t.cos_elbow));
  joint[4] = turning(dot(x_4, R_BF.col(2)), dot(m, R_BF.col(2)));
  joint[5] = bending(dot(f, R_BF.col(2)));
  joint[6] = turning(-dot(f, R_BF.col(0)), dot(f, R_BF.col(1)));
  // If the upper arm is vertical at every arm angle, A1 is free: it keeps the seed's value, and A3 takes the
  // rotation. If the wrist is straight at every arm angle, the same holds for A5 and A7.
  if (joint[0].x.Vanishes() && joint[0].y.Vanishes()) {
    const Vector3 y_2(-std::sin(seed[0]), std::cos(seed[0]), 0.0);
    joint[0] = fixed(seed[0]);
    joint[2] = turning(dot(m, y_2), dot(d, y_2));
  }
  if (joint[4].x.Vanishes() && joint[4].y.Vanishes()) {
    const double cosine = std::cos(seed[4]), sine = std::sin(seed[4]);
    const auto dot_y_6 = [&](const Vector3& v) { return cosine * dot(m, v) + -sine * dot(x_4, v); };
    joint[4] = fixed(seed[4]);
    joint[6] = turning(dot_y_6(R_BF.col(1)), dot_y_6(R_BF.col(0)));
  }
  return joint;
}

// Arm angles at which a joint meets a limit, from -pi to pi. The caller sorts them.
struct Ends {
  std::array<double, kMaxEnds> at;
  int count{0};

  // Adds the arm angles at which the wave is 0: none or two.
  void AddRootsOf(const Wave& wave) {
    // c cos(psi) + s sin(psi) = amplitude cos(psi - middle)
    const double amplitude = std::hypot(wave.c, wave.s);
    if (!(amplitude > 0.0 && std::abs(wave.k) <= amplitude)) return;
    const double middle = std::atan2(wave.s, wave.c);
    const double half = std::atan2(std::sqrt((amplitude - wave.k) * (amplitude + wave.k)), -wave.k);
    for (const double root : {middle - half, middle + half}) {
      const double turned = root >= kPi ? root - 2.0 * kPi : root < -kPi ? root + 2.0 * kPi : root;
      at[static_cast<std::size_t>(count++)] = std::clamp(turned, -kPi, kPi);
    }
  }
};

// Whether every joint is within its limits at the arm angle psi.
// @param sign  for each joint, ±1 by the configuration. -1 selects the second solution: a bending joint has
// the opposite sign, a turning joint is turned by pi
bool Within(const std::array<MovingJoint, 7>& joints, const std::array<double, 7>& sign,
            const std::array<JointLimits, 7>& limits, double psi_rad) {
  using enum MovingJoint::Kind;
  const double cosine = std::cos(psi_rad), sine = std::sin(psi_rad);
  for (std::size_t i = 0; i < 7; ++i) {
    const MovingJoint& joint = joints[i];
    double q = joint.fixed_rad;
    if (joint.kind == kTurning) {
      q = std::atan2(sign[i] * joint.y.At(cosine, sine), sign[i] * joint.x.At(cosine, sine));
    } else if (joint.kind == kBending) {
      q = sign[i] * std::acos(std::clamp(joint.x.At(cosine, sine), -1.0, 1.0));
    } else if (sign[i] < 0.0) {
      q = i == 3 ? -q : q - std::copysign(kPi, q);
    }
    if (!(q >= limits[i].lower_rad && q <= limits[i].upper_rad)) return false;
  }
  return true;
}

}  // namespace

// More than 60 lines, because one pass round the circle makes the arcs between the roots, tests them and
// merges them.
ArmAngleIntervals FindArmAngleIntervals(const LbrArm& arm, const Pose& X_BF, int configuration,
                                        const JointVector& seed) OSTEON_RT {
  const LbrParams& params = arm.params();
  ArmAngleIntervals result;
  const ElbowTriangle triangle = TriangleTo(params, ShoulderToWrist(params, X_BF));
  result.out_of_reach_m = triangle.out_of_reach_m;
  if (!X_BF.linear().allFinite()) result.out_of_reach_m = std::numeric_limits<double>::quiet_NaN();
  if (result.out_of_reach_m != 0.0) return result;

  const ElbowCircle circle = CircleAround(triangle.axis);
  const std::array<MovingJoint, 7> joints =
      JointsOf(triangle, circle, params.shoulder_to_elbow_m / params.elbow_to_wrist_m, X_BF.linear(), seed);
  // Signs of A2, A4 and A6 in this configuration. Each flip of a bending joint turns the turning joints
  // beside it by pi.
  const double sign2 = (configuration & 1) != 0 ? -1.0 : 1.0, sign4 = (configuration & 2) != 0 ? -1.0 : 1.0,
               sign6 = (configuration & 4) != 0 ? -1.0 : 1.0;
  const std::array<double, 7> sign{sign2, sign2, sign2 * sign4, sign4, sign4 * sign6, sign6, sign6};

  // the arm angles at which a joint may pass a limit
  Ends ends;
  for (std::size_t i = 0; i < 7; ++i) {
    const MovingJoint& joint = joints[i];
    const JointLimits& limit = params.limits[i];
    if (joint.kind == MovingJoint::Kind::kFixed) continue;
    if (limit.lower_rad <= -kPi && limit.upper_rad >= kPi) continue;  // turns freely
    for (const double theta : {limit.lower_rad, limit.upper_rad}) {
      const double cosine = std::cos(theta);
      ends.AddRootsOf(joint.kind == MovingJoint::Kind::kBending
                          ? joint.x + Wave{.k = -cosine}
                          : cosine * joint.y + -std::sin(theta) * joint.x);
    }
  }
  std::sort(ends.at.begin(), ends.at.begin() + ends.count);

  // An arc is allowed if its middle is within the limits. Allowed arcs that touch are merged into one
  // interval.
  const auto within = [&](double psi_rad) { return Within(joints, sign, params.limits, psi_rad); };
  if (ends.count == 0) {
    if (within(0.0)) result.interval[static_cast<std::size_t>(result.count++)] = {-kPi, kPi};
    return result;
  }
  const double first = ends.at[0];
  for (int i = 0; i < ends.count; ++i) {
    const double from = ends.at[static_cast<std::size_t>(i)];
    const double to = i + 1 < ends.count ? ends.at[static_cast<std::size_t>(i + 1)] : first + 2.0 * kPi;
    if (!(to > from) || !within(0.5 * (from + to))) continue;
    ArmAngleInterval* last =
        result.count > 0 ? &result.interval[static_cast<std::size_t>(result.count - 1)] : nullptr;
    if (last != nullptr && last->to_rad == from)
      last->to_rad = to;
    else
      result.interval[static_cast<std::size_t>(result.count++)] = {from, to};
  }
  // the last arc and the first touch at ±pi: merge them too
  if (result.count == 0) return result;
  ArmAngleInterval& begin = result.interval[0];
  ArmAngleInterval& end = result.interval[static_cast<std::size_t>(result.count - 1)];
  if (begin.from_rad != first || end.to_rad != first + 2.0 * kPi) return result;
  if (result.count == 1) {
    begin = {-kPi, kPi};
    return result;
  }
  end.to_rad = begin.to_rad + 2.0 * kPi;
  for (int i = 1; i < result.count; ++i)
    result.interval[static_cast<std::size_t>(i - 1)] = result.interval[static_cast<std::size_t>(i)];
  --result.count;
  return result;
}

}  // namespace osteon::kinematics
