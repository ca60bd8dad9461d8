#include "tests/property/wild_zone.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace osteon::property {
namespace {

using safety::ZoneShape;

// Signed distance of p from the zone's set [m]: positive outside. Outside a box or cylinder, the distance is
// the largest of the distances from its faces. Beyond an edge this is less than the Euclidean distance.
double Outside_m(const safety::ZoneParams& zone, const Vector3& p) {
  const Vector3 to = p - zone.p_W_m;
  const double x = zone.R_W.col(0).dot(to), y = zone.R_W.col(1).dot(to), z = zone.R_W.col(2).dot(to);
  switch (zone.shape) {
    case ZoneShape::kHalfSpace:
      return -z;
    case ZoneShape::kSphere:
      return to.norm() - zone.radius_m;
    case ZoneShape::kBox:
      return std::max({std::abs(x) - zone.half_edge_m.x(), std::abs(y) - zone.half_edge_m.y(),
                       std::abs(z) - zone.half_edge_m.z()});
    case ZoneShape::kCylinder:
      return std::max(std::hypot(x, y) - zone.radius_m, std::abs(z) - zone.half_length_m);
    case ZoneShape::kCapsule:
      return std::hypot(x, y, std::max(0.0, std::abs(z) - zone.half_length_m)) - zone.radius_m;
  }
  return 0.0;
}

}  // namespace

void showValue(const ZoneChoice& z, std::ostream& out) {
  out << fmt::format("{{shape {} side {} point {} size {} offset {} toward {} {} {} turn {} {} {}}}", z.shape,
                     z.side, z.point, z.size, z.offset_mm, z.toward[0], z.toward[1], z.toward[2], z.turn[0],
                     z.turn[1], z.turn[2]);
}

rc::Gen<ZoneChoice> AnyZone(int least_mm, int most_mm) {
  const auto among = [](int from, int to) { return rc::gen::resize(100, rc::gen::inRange(from, to + 1)); };
  return rc::gen::build<ZoneChoice>(
      rc::gen::set(&ZoneChoice::shape, among(0, 4)), rc::gen::set(&ZoneChoice::side, among(0, 1)),
      rc::gen::set(&ZoneChoice::point, among(0, 2)), rc::gen::set(&ZoneChoice::size, among(0, 9)),
      rc::gen::set(&ZoneChoice::offset_mm, among(least_mm, most_mm)),
      rc::gen::set(&ZoneChoice::toward, rc::gen::container<std::array<int, 3>>(among(-9, 9))),
      rc::gen::set(&ZoneChoice::turn, rc::gen::container<std::array<int, 3>>(among(-31, 31))));
}

const Vector3& PointOf(const ArmPoints& points, safety::ZonePoint point) {
  return point == safety::ZonePoint::kApex     ? points.p_tool_m
         : point == safety::ZonePoint::kFlange ? points.p_flange_m
                                               : points.p_elbow_m;
}

double PastBound_m(const safety::ZoneParams& zone, const Vector3& p) {
  return zone.side == safety::ZoneSide::kKeepIn ? Outside_m(zone, p) : -Outside_m(zone, p);
}

safety::ZoneParams ZoneOf(const ZoneChoice& choice, const ArmPoints& start) {
  safety::ZoneParams zone{.shape = static_cast<ZoneShape>(choice.shape),
                          .side = static_cast<safety::ZoneSide>(choice.side),
                          .point = static_cast<safety::ZonePoint>(choice.point)};
  const auto about = [&](int i) {
    return Eigen::AngleAxisd(0.1 * choice.turn[static_cast<std::size_t>(i)], Vector3::Unit(i));
  };
  zone.R_W = (about(2) * about(1) * about(0)).toRotationMatrix();
  const double size_m = 0.006 * std::pow(1.5, choice.size);
  zone.half_edge_m = size_m * Vector3(1.0, 1.4, 0.7);
  zone.radius_m = size_m;
  zone.half_length_m = 0.8 * size_m;

  // Find by bisection how far the set's surface is from its centre along `out`. Then place the centre so that
  // the arm's point is on this line, by the offset from the surface.
  Vector3 out(choice.toward[0], choice.toward[1], choice.toward[2]);
  if (out.isZero() || zone.shape == ZoneShape::kHalfSpace) out = -Vector3::UnitZ();
  out = zone.R_W * out.normalized();
  double inside_m = 0.0, outside_m = 10.0 * size_m;
  for (int i = 0; i < 50; ++i) {
    const double there_m = 0.5 * (inside_m + outside_m);
    (Outside_m(zone, there_m * out) > 0.0 ? outside_m : inside_m) = there_m;
  }
  const double sign = zone.side == safety::ZoneSide::kKeepIn ? -1.0 : 1.0;
  zone.p_W_m = PointOf(start, zone.point) - (inside_m + sign * 1e-3 * (choice.offset_mm + 0.5)) * out;
  return zone;
}

}  // namespace osteon::property
