#include "kinematics/lbr_params.h"

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

#include "base/number_text.h"

namespace osteon::kinematics {
namespace {

// Accepted deviation of an axis or a point from the arm's geometry.
constexpr double kOff_m = 1e-9;
constexpr double kOff_rad = 1e-9;

[[noreturn]] void Refuse(const std::string& what, double found, const char* unit, double accepted) {
  std::ostringstream text;
  text << "arm is not spherical-revolute-spherical: " << what << ", found " << found << ' ' << unit
       << " off, accepted " << accepted << ' ' << unit;
  throw std::invalid_argument(text.str());
}

std::string Text(const Vector3& v) {
  std::ostringstream text;
  text << '(' << v.x() << ' ' << v.y() << ' ' << v.z() << ')';
  return text.str();
}

// Axis of a joint at q = 0, in B: a line.
struct Line {
  Vector3 point, direction;
};

// Rounds a length to whole picometres: removes the rounding error of summing a description's origins.
double Length(double sum_m) { return std::round(sum_m * 1e12) / 1e12; }

double AngleBetween(const Vector3& a, const Vector3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

}  // namespace

LbrParams LbrParamsFrom(const ChainParams<7>& chain) {
  const Vector3 x = Vector3::UnitX(), y = Vector3::UnitY(), z = Vector3::UnitZ();
  const std::array<Vector3, 7> expected{z, y, z, -y, z, y, z};

  // check the direction of every axis, and that the turning axes lie on B's z axis
  Pose X_BL = Pose::Identity();
  std::array<Line, 7> axis;
  for (std::size_t i = 0; i < 7; ++i) {
    const RevoluteJoint& joint = chain.joints[i];
    const std::string name{'A', static_cast<char>('1' + i)};
    X_BL = X_BL * joint.X_PJ;
    axis[i] = {.point = X_BL.translation(), .direction = X_BL.linear() * joint.axis_J};
    const double tilt_rad = AngleBetween(axis[i].direction, expected[i]);
    if (!(tilt_rad <= kOff_rad))
      Refuse("axis of " + name + " at zero is " + Text(axis[i].direction) + ", accepted " + Text(expected[i]),
             tilt_rad, "rad", kOff_rad);
    // a turning axis lies on B's z axis; a bending axis crosses it
    const double beside_m = expected[i].z() != 0.0 ? std::hypot(axis[i].point.x(), axis[i].point.y())
                                                   : std::abs(axis[i].point.x());
    if (!(beside_m <= kOff_m))
      Refuse("axis of " + name + " passes beside the line from base to flange", beside_m, "m", kOff_m);
  }

  // check that the flange is on B's z axis and aligned with B
  const Pose X_BF = X_BL * chain.X_LF;
  const double beside_m = std::hypot(X_BF.translation().x(), X_BF.translation().y());
  if (!(beside_m <= kOff_m))
    Refuse("flange at zero is beside the line through base and shoulder", beside_m, "m", kOff_m);
  const double turned_rad = std::max(AngleBetween(X_BF.linear() * x, x), AngleBetween(X_BF.linear() * z, z));
  if (!(turned_rad <= kOff_rad)) Refuse("flange at zero is turned against B", turned_rad, "rad", kOff_rad);

  LbrParams params;
  const double shoulder_m = axis[1].point.z(), elbow_m = axis[3].point.z(), wrist_m = axis[5].point.z();
  params.base_to_shoulder_m = Length(shoulder_m);
  params.shoulder_to_elbow_m = Length(elbow_m - shoulder_m);
  params.elbow_to_wrist_m = Length(wrist_m - elbow_m);
  params.wrist_to_flange_m = Length(X_BF.translation().z() - wrist_m);
  if (!(params.shoulder_to_elbow_m > kOff_m))
    throw std::invalid_argument(
        "arm is not spherical-revolute-spherical: A4 is not above A2 at zero, found " +
        base::NumberText(params.shoulder_to_elbow_m) + " m, accepted > 0");
  if (!(params.elbow_to_wrist_m > kOff_m))
    throw std::invalid_argument(
        "arm is not spherical-revolute-spherical: A6 is not above A4 at zero, found " +
        base::NumberText(params.elbow_to_wrist_m) + " m, accepted > 0");
  for (std::size_t i = 0; i < 7; ++i) params.limits[i] = chain.joints[i].limits;
  return params;
}

ChainParams<7> ChainFrom(const LbrParams& params) {
  const Vector3 y = Vector3::UnitY(), z = Vector3::UnitZ();
  const std::array<Vector3, 7> axes{z, y, z, -y, z, y, z};
  // Height of each joint above the one before: A2, A4 and A6 are at shoulder, elbow and wrist; A3, A5
  // and A7 share the origin of the joint before.
  const std::array<double, 7> above_m{0.0, params.base_to_shoulder_m, 0.0, params.shoulder_to_elbow_m,
                                      0.0, params.elbow_to_wrist_m,   0.0};
  ChainParams<7> chain;
  for (std::size_t i = 0; i < 7; ++i) {
    chain.joints[i].X_PJ.translation() = above_m[i] * z;
    chain.joints[i].axis_J = axes[i];
    chain.joints[i].limits = params.limits[i];
  }
  chain.X_LF.translation() = params.wrist_to_flange_m * z;
  return chain;
}

}  // namespace osteon::kinematics
