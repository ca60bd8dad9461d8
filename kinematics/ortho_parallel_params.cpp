#include "kinematics/ortho_parallel_params.h"

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

// Refuses an arm whose deviation from the required geometry is too large. @param off  the deviation
// @throws std::invalid_argument if `off` is larger than `accepted`.
void Require(const std::string& what, double off, const char* unit, double accepted) {
  if (off <= accepted) return;  // false for NaN, which is refused too
  std::ostringstream text;
  text << "arm is not ortho-parallel with a spherical wrist: " << what << ", found " << off << ' ' << unit
       << " off, accepted " << accepted << ' ' << unit;
  throw std::invalid_argument(text.str());
}

// Axis of a joint at q = 0, in B: a line.
struct Line {
  Vector3 point, direction;
};

double Distance(const Line& line, const Vector3& point) {
  return line.direction.cross(point - line.point).norm();
}

// Sine of the angle between two unit vectors.
double Sine(const Vector3& a, const Vector3& b) { return a.cross(b).norm(); }
double Sign(double value) { return value < 0.0 ? -1.0 : 1.0; }

// Point of line a nearest to line b; the lines are perpendicular or nearly so.
Vector3 NearestOn(const Line& a, const Line& b) {
  const Vector3 between = b.point - a.point;
  const double cosine = a.direction.dot(b.direction);
  const double along =
      (between.dot(a.direction) - cosine * between.dot(b.direction)) / (1.0 - cosine * cosine);
  return a.point + along * a.direction;
}

}  // namespace

ChainParams<6> ChainFrom(const OrthoParallelParams& params) {
  const Vector3 y = Vector3::UnitY(), z = Vector3::UnitZ();
  const std::array<Vector3, 6> axis{z, y, y, z, y, z};
  const std::array<Vector3, 6> origin{Vector3::Zero(),
                                      Vector3(params.a1_m, params.b_m, params.c1_m),
                                      Vector3(0.0, 0.0, params.c2_m),
                                      Vector3(params.a2_m, 0.0, params.c3_m),
                                      Vector3::Zero(),
                                      Vector3::Zero()};
  ChainParams<6> chain;
  for (std::size_t i = 0; i < 6; ++i) {
    RevoluteJoint& joint = chain.joints[i];
    joint.X_PJ.translation() = origin[i];
    joint.X_PJ.linear() = Eigen::AngleAxisd(-params.offset_rad[i], axis[i]).toRotationMatrix();
    joint.axis_J = params.sign[i] * axis[i];
    joint.limits = params.limits[i];
  }
  chain.X_LF.translation() = params.c4_m * z;
  return chain;
}

OrthoParallelParams OrthoParallelParamsFrom(const ChainParams<6>& chain) {
  const Vector3 y = Vector3::UnitY(), z = Vector3::UnitZ();
  std::array<Line, 6> axis;
  Pose X_BF = Pose::Identity();
  for (std::size_t i = 0; i < 6; ++i) {
    X_BF = X_BF * chain.joints[i].X_PJ;
    axis[i] = {.point = X_BF.translation(), .direction = X_BF.linear() * chain.joints[i].axis_J};
  }
  X_BF = X_BF * chain.X_LF;

  // check the axes' directions, and that the wrist's axes meet in one point
  Require("axis of A1 is not z of B", Sine(axis[0].direction, z), "rad", kOff_rad);
  Require("axis of A1 passes beside B's origin", Distance(axis[0], Vector3::Zero()), "m", kOff_m);
  Require("axis of A2 at zero is not along y of B", Sine(axis[1].direction, y), "rad", kOff_rad);
  Require("axis of A3 at zero is not along y of B", Sine(axis[2].direction, y), "rad", kOff_rad);
  Require("axis of A4 is not square to A3", std::abs(axis[3].direction.dot(y)), "rad", kOff_rad);
  Require("axis of A5 is not square to A4", std::abs(axis[4].direction.dot(axis[3].direction)), "rad",
          kOff_rad);
  Require("axis of A6 is not square to A5", std::abs(axis[5].direction.dot(axis[4].direction)), "rad",
          kOff_rad);
  const Vector3 wrist = NearestOn(axis[4], axis[3]);
  Require("axis of A4 misses A5", Distance(axis[3], wrist), "m", kOff_m);
  Require("axis of A6 misses where A4 and A5 meet", Distance(axis[5], wrist), "m", kOff_m);
  Require("flange is beside A6", Distance(axis[5], X_BF.translation()), "m", kOff_m);
  Require("flange does not look along A6", Sine(axis[5].direction, X_BF.linear().col(2)), "rad", kOff_rad);

  // lengths in the arm's plane: from A2 to A3, and from A3 along A4 to the wrist
  OrthoParallelParams params;
  std::array<double, 6> theta{};  // theta1 … theta6 at q = 0
  params.a1_m = axis[1].point.x();
  params.c1_m = axis[1].point.z();
  params.b_m = wrist.y();
  const Vector3 upper(axis[2].point.x() - params.a1_m, 0.0, axis[2].point.z() - params.c1_m);
  const Vector3 fore = wrist - Vector3(axis[2].point.x(), params.b_m, axis[2].point.z());
  params.c2_m = upper.norm();
  const double sign4 = Sign(fore.dot(axis[3].direction));
  const Vector3 z_4 = sign4 * axis[3].direction, x_c = y.cross(z_4);
  params.c3_m = fore.dot(z_4);
  params.a2_m = fore.dot(x_c);
  if (!(params.c2_m > kOff_m) || !(params.c3_m > kOff_m))
    throw std::invalid_argument("arm is not ortho-parallel with a spherical wrist: found " +
                                base::NumberText(params.c2_m) + " m from A2 to A3, " +
                                base::NumberText(params.c3_m) + " m from A3 to the wrist, accepted > 0");
  theta[1] = std::atan2(upper.x(), upper.z());
  theta[2] = std::remainder(std::atan2(z_4.x(), z_4.z()) - theta[1], 2.0 * std::numbers::pi);

  // wrist: A5 is the forearm's y axis turned by theta4, A6 its z axis then turned by theta5
  const double across = axis[4].direction.dot(y);
  const double sign5 = std::abs(across) > kOff_rad ? Sign(across) : Sign(-axis[4].direction.dot(x_c));
  const Vector3 y_5 = sign5 * axis[4].direction, x_4 = y_5.cross(z_4), z_6 = X_BF.linear().col(2);
  theta[3] = std::atan2(-y_5.dot(x_c), y_5.dot(y));
  theta[4] = std::atan2(z_6.dot(x_4), z_6.dot(z_4));
  theta[5] = std::atan2(X_BF.linear().col(0).dot(y_5), X_BF.linear().col(0).dot(y_5.cross(z_6)));
  params.c4_m = (X_BF.translation() - wrist).dot(z_6);

  params.sign = {
      Sign(axis[0].direction.z()),     Sign(axis[1].direction.y()), Sign(axis[2].direction.y()), sign4, sign5,
      Sign(axis[5].direction.dot(z_6))};
  for (std::size_t i = 0; i < 6; ++i) {
    params.offset_rad[i] = 0.0 - theta[i];
    params.limits[i] = chain.joints[i].limits;
  }
  return params;
}

}  // namespace osteon::kinematics
