#include "procedure/assessment/cavity_result.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/units.h"
#include "procedure/assessment/target_tissue.h"
#include "simulation/removal/cut_metrics.h"

namespace osteon::procedure {
namespace {

using simulation::Ball;

constexpr int kCoverageDirections = 4000;  // directions of the hemisphere in which coverage is sampled
// The rim: bone at most kRimWidth_m outside the planned cavity, and at most kRimDepth_m below the plane
// through the site's centre.
constexpr double kRimWidth_m = 3e-3, kRimDepth_m = 2e-3;
// a ball whose radius shrank by more counts as cut; rounding changes it by 1e-6 mm
constexpr double kShrunk_mm = 1e-4;

// Returns the balls that reach into a shell of half thickness `reach_m` around the planned sphere.
std::vector<Ball> NearShell(std::span<const Ball> balls, const PlannedCavity& cavity, double reach_m) {
  std::vector<Ball> near;
  for (const Ball& ball : balls) {
    const double outside_m = (Vector3(ball.center_m) - cavity.centre_m).norm() - cavity.radius_m;
    if (std::abs(outside_m) <= ball.radius_m + reach_m) near.push_back(ball);
  }
  return near;
}

// Distance along a ray from `from_m` to its first point in a ball that is at least `min_m` away; infinity if
// there is none.
double EntryDistance(const Vector3& from_m, const Vector3& direction, const Ball& ball, double min_m) {
  const Vector3 way_m = Vector3(ball.center_m) - from_m;
  const double along_m = way_m.dot(direction);
  const double aside2 = way_m.squaredNorm() - along_m * along_m, radius2 = ball.radius_m * ball.radius_m;
  if (aside2 > radius2) return std::numeric_limits<double>::infinity();
  const double half_chord_m = std::sqrt(radius2 - aside2);
  if (along_m + half_chord_m < min_m) return std::numeric_limits<double>::infinity();
  return std::max(along_m - half_chord_m, min_m);
}

// Sorts balls, as seen from a point, into bands of the angle between their direction and an axis. A ray from
// the point can meet only balls of the band that contains its direction.
class BallBands {
 public:
  BallBands(std::span<const Ball> balls, const Vector3& from_m, const Vector3& axis)
      : balls_(balls), from_m_(from_m), axis_(axis), bands_(kBands) {
    for (std::size_t i = 0; i < balls.size(); ++i) {
      const Vector3 way_m = Vector3(balls[i].center_m) - from_m;
      // half of the angle that the ball covers, seen from the point; pi if the point is inside the ball
      const double far_m = way_m.norm(), radius_m = balls[i].radius_m;
      const double half_rad =
          (radius_m < far_m ? std::asin(radius_m / far_m) : std::numbers::pi) + kBandMargin_rad;
      const double angle_rad = AngleOf(way_m);
      for (std::size_t band = BandAt(angle_rad - half_rad); band <= BandAt(angle_rad + half_rad); ++band)
        bands_[band].push_back(i);
    }
  }

  // Distance along a ray to its first point in any ball that is at least `min_m` away; infinity if there is
  // none.
  [[nodiscard]] double FirstBone(const Vector3& direction, double min_m) const {
    double first_m = std::numeric_limits<double>::infinity();
    for (const std::size_t i : bands_[BandAt(AngleOf(direction))])
      first_m = std::min(first_m, EntryDistance(from_m_, direction, balls_[i], min_m));
    return first_m;
  }

 private:
  static constexpr std::size_t kBands = 180;
  static constexpr double kBandMargin_rad = 1e-6;  // margin for rounding

  [[nodiscard]] double AngleOf(const Vector3& way) const {
    return std::atan2(axis_.cross(way).norm(), axis_.dot(way));
  }
  static std::size_t BandAt(double angle_rad) {
    const double band = angle_rad / std::numbers::pi * static_cast<double>(kBands);
    return static_cast<std::size_t>(std::clamp(band, 0.0, static_cast<double>(kBands - 1)));
  }

  std::span<const Ball> balls_;
  Vector3 from_m_, axis_;
  std::vector<std::vector<std::size_t>> bands_;
};

// Share of the planned hemisphere's directions in which bone begins at the planned sphere, to within
// kCoverageGap_m.
double Coverage(const PlannedCavity& cavity, std::span<const Ball> live) {
  const std::vector<Ball> near = NearShell(live, cavity, kCoverageGap_m);
  const BallBands bands(near, cavity.centre_m, cavity.axis);
  int covered = 0;
  for (const Vector3& direction : HemisphereDirections(cavity.axis, kCoverageDirections))
    if (bands.FirstBone(direction, cavity.radius_m - kCoverageGap_m) <= cavity.radius_m + kCoverageGap_m)
      ++covered;
  return static_cast<double>(covered) / kCoverageDirections;
}

// Sums a tissue's volume before the cut, and the volume that remains.
struct RemainingShare {
  double left_m3{0.0}, uncut_m3{0.0};
  void Add(double volume_m3, bool left) {
    uncut_m3 += volume_m3;
    if (left) left_m3 += volume_m3;
  }
  // The share that is left, 0 … 1; nothing if the tissue had no volume.
  [[nodiscard]] std::optional<double> value() const {
    return uncut_m3 > 0.0 ? std::optional(left_m3 / uncut_m3) : std::nullopt;
  }
};

}  // namespace

AnatomicShift ShiftOf(const PelvicFrame& pelvis, const Vector3& d_G) {
  return {.medial_m = -d_G.dot(pelvis.lateral),
          .superior_m = d_G.dot(pelvis.superior),
          .posterior_m = -d_G.dot(pelvis.anterior)};
}

bool InRoofArcs(const PelvicFrame& pelvis, const Vector3& native_centre_m, const Vector3& p_m) {
  const Vector3 d = pelvis.FromG(p_m - native_centre_m);
  const double across = std::hypot(d.x(), d.y()), angle_deg = std::atan2(across, d.z()) / kDegree;
  if (across <= 0.0) return d.z() > 0.0;
  // the angle from straight up, split into a medial and a forward component
  const double medial_deg = -angle_deg * d.x() / across, forward_deg = angle_deg * d.y() / across;
  // forward component as a fraction of the arc: ±1 at the anterior or posterior end
  const double forward_share = forward_deg / (forward_deg > 0.0 ? kRoofAnterior_deg : kRoofPosterior_deg);
  if (medial_deg <= 0.0) return std::abs(forward_share) <= 1.0 && angle_deg <= 90.0;
  return forward_share * forward_share + std::pow(medial_deg / kRoofMedial_deg, 2) <= 1.0;
}

std::vector<Vector3> HemisphereDirections(const Vector3& axis, int count) {
  // a Fibonacci lattice: the heights are evenly spaced, so each direction stands for the same area
  const double golden_angle_rad = std::numbers::pi * (3.0 - std::sqrt(5.0));
  const Matrix3 R = RotationFromZTo(axis);
  std::vector<Vector3> directions;
  for (int i = 0; i < count; ++i) {
    const double z = -(i + 0.5) / count, across = std::sqrt(1.0 - z * z);
    directions.push_back(
        R * Vector3(across * std::cos(golden_angle_rad * i), across * std::sin(golden_angle_rad * i), z));
  }
  return directions;
}

std::vector<Ball> CutBalls(const simulation::Bone& uncut, const simulation::CarvedState& state) {
  std::vector<Ball> cut;
  for (std::size_t i = 0; i < uncut.balls.size() && 4 * i + 3 < state.balls.size(); ++i) {
    const double radius_mm = state.balls[4 * i + 3];
    if (radius_mm > 0.0 && radius_mm < 1e3 * uncut.balls[i].radius_m - kShrunk_mm)
      cut.push_back({.center_m = Vector3(1e-3 * state.balls[4 * i], 1e-3 * state.balls[4 * i + 1],
                                         1e-3 * state.balls[4 * i + 2]),
                     .radius_m = 1e-3 * radius_mm});
  }
  return cut;
}

std::vector<std::optional<double>> DeviationMap(const SurgicalPlan& plan, std::span<const Ball> live_balls,
                                                std::span<const Vector3> directions_G) {
  const PlannedCavity cavity = plan.cavity();
  const std::vector<Ball> near = NearShell(live_balls, cavity, kMapReach_m);
  std::vector<std::optional<double>> map;
  const BallBands bands(near, cavity.centre_m, cavity.axis);
  for (const Vector3& direction : directions_G) {
    const double first_m = bands.FirstBone(direction, cavity.radius_m - kMapReach_m) - cavity.radius_m;
    map.push_back(first_m <= kMapReach_m ? std::optional(first_m) : std::nullopt);
  }
  return map;
}

CavityResult AssessCavity(const SurgicalPlan& plan, const simulation::Bone& uncut,
                          const simulation::CarvedState& state) {
  const PlannedCavity cavity = plan.cavity();
  CavityResult result;
  if (plan.kind != PlanKind::kCup) {
    result.fit_refused = "an opening is no sphere";
  } else if (auto fit = FitSphere(CutBalls(uncut, state), plan.axis_G, cavity.centre_m, cavity.radius_m)) {
    result.fit = *fit;
    result.from_plan = ShiftOf(plan.pelvis, fit->centre_m - cavity.centre_m);
    result.from_native = ShiftOf(plan.pelvis, fit->centre_m - plan.native_centre_m);
  } else {
    result.fit_refused = fit.error();
  }
  if (plan.kind == PlanKind::kCup) result.coverage = Coverage(cavity, simulation::LiveBalls(state));

  const Vector3 site_m = uncut.site.center_m, site_axis = uncut.site.axis;
  RemainingShare cartilage, rim;
  for (std::size_t i = 0; i < uncut.points.size() && i < state.cleared.size(); ++i) {
    const simulation::MassPoint& point = uncut.points[i];
    const Vector3 p_m = point.p_m;
    const bool left = state.cleared[i] == 0;
    const double outside_m = cavity.DistanceTo(p_m);
    if (!left) result.removed_m3 += point.volume_m3;
    if (IsTarget(plan, uncut, point)) continue;  // the target may be removed everywhere
    if (!left && outside_m > 0.0) result.over_m3 += point.volume_m3;
    if (left && outside_m < 0.0) result.under_m3 += point.volume_m3;
    if (point.material < uncut.materials.size() && uncut.materials[point.material].name == "cartilage" &&
        InRoofArcs(plan.pelvis, plan.native_centre_m, p_m))
      cartilage.Add(point.volume_m3, left);
    if (outside_m > 0.0 && outside_m <= kRimWidth_m && (p_m - site_m).dot(site_axis) >= -kRimDepth_m)
      rim.Add(point.volume_m3, left);
  }
  result.cartilage_left = cartilage.value();
  result.rim_preserved = rim.value();
  return result;
}

}  // namespace osteon::procedure
