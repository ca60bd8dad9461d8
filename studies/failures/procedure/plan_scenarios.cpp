#include "studies/failures/procedure/plan_scenarios.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include <fmt/format.h>

#include "base/units.h"
#include "procedure/assessment/cavity_result.h"
#include "procedure/assessment/sphere_fit.h"
#include "procedure/plan/surgical_plan.h"
#include "simulation/bone/scenes.h"
#include "simulation/fidelity/recarve.h"
#include "simulation/removal/cut_metrics.h"

namespace osteon::studies {
namespace {

using procedure::CupDefinition;
using simulation::Ball;

constexpr CupDefinition kDefinitions[] = {CupDefinition::kRadiographic, CupDefinition::kOperative,
                                          CupDefinition::kAnatomic};
constexpr double kRadius_m = 0.025;  // radius of the cap's sphere, and of the reamer

double AngleBetween_deg(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / kDegree;
}

// Returns the result with its verdict: the baseline fails if it exceeds the bound, ours passes if it keeps
// the bound.
FailureResult Judged(FailureResult result) {
  result.baseline_fails = result.baseline > result.bound;
  result.ours_passes = result.ours <= result.bound;
  return result;
}

struct Sphere {
  Vector3 centre_m;
  double radius_m;
};

// Fits a sphere by linear least squares of |p|² = 2 p·C + (R² - |C|²), with points p, centre C and radius R.
// This fit is biased if the points are noisy.
Sphere AlgebraicFit(const std::vector<Vector3>& points_m) {
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  Eigen::Vector4d b = Eigen::Vector4d::Zero();
  for (const Vector3& p_m : points_m) {
    Eigen::Vector4d row;
    row << 2.0 * p_m, 1.0;
    A += row * row.transpose();
    b += row * p_m.squaredNorm();
  }
  const Eigen::Vector4d x = A.ldlt().solve(b);
  return {x.head<3>(), std::sqrt(x(3) + x.head<3>().squaredNorm())};
}

// Balls of radius 0 at the points.
std::vector<Ball> AsBalls(const std::vector<Vector3>& points_m) {
  std::vector<Ball> balls;
  for (const Vector3& p_m : points_m) balls.push_back({.center_m = p_m, .radius_m = 0.0});
  return balls;
}

// Fits a sphere by the shipped method (procedure/assessment). @param near_m  expected place of the sphere's
// centre
Sphere GeometricFit(const std::vector<Ball>& balls, const Vector3& near_m) {
  const auto fit = procedure::FitSphere(balls, Vector3::UnitZ(), near_m, kRadius_m);
  if (!fit) throw std::runtime_error(fit.error());
  return {fit->centre_m, fit->radius_m};
}

// Points on a cap of a sphere with kRadius_m about the origin, at angles up to cap_rad from -z, with noise
// along the radius.
std::vector<Vector3> NoisyCap(double cap_rad, int count, double noise_m, std::mt19937_64& random) {
  std::uniform_real_distribution<double> height(std::cos(cap_rad), 1.0), turn(0.0, 2.0 * M_PI);
  std::normal_distribution<double> noise(0.0, noise_m);
  std::vector<Vector3> points_m;
  for (int i = 0; i < count; ++i) {
    const double z = height(random), across = std::sqrt(1.0 - z * z), phi = turn(random);
    points_m.push_back((kRadius_m + noise(random)) *
                       Vector3(across * std::cos(phi), across * std::sin(phi), -z));
  }
  return points_m;
}

// The cup of the demo, packed with large balls.
simulation::Bone CoarseCup() {
  constexpr double kSpacing_m = 2.5e-3, kGap_m = 0.1e-3;
  simulation::AcetabulumParams params;
  params.packing.lattice.finest_m = kSpacing_m;
  params.packing.surface_gap_m = kGap_m;
  return simulation::MakeAcetabulum(params);
}

}  // namespace

FailureResult RunCupDefinition(const FailureSetting&) {
  FailureResult result{.id = 23,
                       .name = "cup definitions",
                       .metric = "angle between the planned axis and the one that is used",
                       .unit = "deg",
                       .baseline_name = "radiographic angles read as operative ones",
                       .bound = 1e-9};
  FailureSeries wrong{.name = result.baseline_name},
      right{.name = "by any definition and back", .ours = true};
  for (int anteversion_deg = 0; anteversion_deg <= 30; ++anteversion_deg) {
    const procedure::CupAngles angles{40.0 * kDegree, anteversion_deg * kDegree};
    const Vector3 planned = procedure::CupAxis_N(CupDefinition::kRadiographic, angles);
    const double off_deg = AngleBetween_deg(planned, procedure::CupAxis_N(CupDefinition::kOperative, angles));
    double back_deg = 0.0;
    for (const CupDefinition definition : kDefinitions)
      back_deg = std::max(
          back_deg, AngleBetween_deg(
                        planned, procedure::CupAxis_N(definition, procedure::AnglesOf(definition, planned))));
    wrong.x.push_back(anteversion_deg), wrong.y.push_back(off_deg);
    right.x.push_back(anteversion_deg), right.y.push_back(back_deg);
    if (anteversion_deg == 20) result.baseline = off_deg;
    result.ours = std::max(result.ours, back_deg);
  }
  result.note = fmt::format("At 40/20. At 40/30 the wrong definition is {:.2f} deg off.", wrong.y.back());
  result.plot = {.x_label = "anteversion [deg]",
                 .y_label = "angle [deg]",
                 .series = {wrong, right},
                 .bound_is_on_y = true};
  return Judged(result);
}

FailureResult RunWrongSide(const FailureSetting&) {
  FailureResult result{.id = 24,
                       .name = "wrong side",
                       .metric = "angle between an accepted axis and the native cup's",
                       .unit = "deg",
                       .baseline_name = "a left plan taken at the right hip",
                       .bound = procedure::kMaxAxisFromSite_rad / kDegree};
  // a pelvis with spines 240 mm apart: x to the left, y backwards, z up
  const procedure::PelvicLandmarks pelvis{
      .asis_right_m = {-0.12, 0.0, 0.0}, .asis_left_m = {0.12, 0.0, 0.0}, .pubis_m = {0.0, 0.0, -0.087}};
  FailureSeries taken{.name = result.baseline_name}, accepted{.name = "accepted by ours", .ours = true};
  for (int inclination_deg = 30; inclination_deg <= 50; ++inclination_deg) {
    const Vector3 a_N =
        procedure::CupAxis_N(CupDefinition::kRadiographic, {inclination_deg * kDegree, 15.0 * kDegree});
    const Vector3 native = procedure::FrameOf(pelvis, procedure::Side::kRight).ToG(a_N);
    procedure::SurgicalPlan plan;
    plan.side = procedure::Side::kLeft;
    plan.axis_G = procedure::FrameOf(pelvis, plan.side).ToG(a_N);
    const double off_deg = AngleBetween_deg(native, plan.axis_G);
    const bool refused =
        !procedure::SiteError(plan, simulation::CutSite{.center_m = {}, .axis = native}).empty();
    taken.x.push_back(inclination_deg), taken.y.push_back(off_deg);
    accepted.x.push_back(inclination_deg), accepted.y.push_back(refused ? 0.0 : off_deg);
    if (inclination_deg == 40) result.baseline = off_deg;
    result.ours = std::max(result.ours, accepted.y.back());
  }
  result.note = "Ours refuses each of these plans, so that no axis is accepted.";
  result.plot = {.x_label = "inclination [deg]",
                 .y_label = "angle [deg]",
                 .series = {taken, accepted},
                 .bound_is_on_y = true};
  return Judged(result);
}

FailureResult RunSmallCap(const FailureSetting& setting) {
  constexpr double kNoise_m = 0.3e-3, kCap_rad = 46.0 * kDegree;
  constexpr int kPoints = 2000;
  const int fits = setting.full() ? 2000 : 300;
  FailureResult result{.id = 25,
                       .name = "small cap",
                       .metric = "bias of the fitted radius or depth, the larger",
                       .unit = "mm",
                       .baseline_name = "algebraic fit",
                       .bound = 0.02};
  std::mt19937_64 random(25);
  Vector3 depth_radius[2] = {Vector3::Zero(),
                             Vector3::Zero()};  // sums of the errors of depth and radius [m]: baseline, ours
  FailureSeries algebraic{.name = result.baseline_name}, geometric{.name = "geometric fit", .ours = true};
  int done = 0;
  while (done < fits && setting.GoesOn(static_cast<double>(done) / fits)) {
    const std::vector<Vector3> points_m = NoisyCap(kCap_rad, kPoints, kNoise_m, random);
    const Sphere found[2] = {AlgebraicFit(points_m), GeometricFit(AsBalls(points_m), Vector3::Zero())};
    for (int i = 0; i < 2; ++i)
      depth_radius[i] += Vector3(found[i].centre_m.z(), found[i].radius_m - kRadius_m, 0.0);
    ++done;
    algebraic.x.push_back(done), geometric.x.push_back(done);
    algebraic.y.push_back(1e3 * depth_radius[0].y() / done);
    geometric.y.push_back(1e3 * depth_radius[1].y() / done);
  }
  if (done == 0) return result;
  result.baseline = 1e3 * depth_radius[0].cwiseAbs().maxCoeff() / done;
  result.ours = 1e3 * depth_radius[1].cwiseAbs().maxCoeff() / done;
  result.note = fmt::format("Algebraic: radius {:+.3f}, depth {:+.3f} mm; geometric: {:+.3f}, {:+.3f} mm.",
                            1e3 * depth_radius[0].y() / done, 1e3 * depth_radius[0].x() / done,
                            1e3 * depth_radius[1].y() / done, 1e3 * depth_radius[1].x() / done);
  result.plot = {
      .x_label = "fits", .y_label = "mean error of the radius [mm]", .series = {algebraic, geometric}};
  result = Judged(result);
  result.ours_passes = result.ours_passes && done == fits;
  return result;
}

FailureResult RunCoarsePacking(const FailureSetting& setting) {
  FailureResult result{.id = 26,
                       .name = "coarse packing",
                       .metric = "error of the fitted diameter",
                       .unit = "mm",
                       .baseline_name = "sphere through where rays meet the balls",
                       .bound = 0.01};
  if (!setting.GoesOn(0.0)) return result;
  const simulation::Bone bone = CoarseCup();
  const simulation::Tool tool = simulation::MakeReamer(kRadius_m, 8e-3, 0.12, 1.0, {0.0, 0.0, -0.06});
  const auto engine =
      setting.make_engine(bone, tool, Pose::Identity(), {.law = simulation::RemovalLaw::kImmediate});
  const Vector3 centre_m(0.0, 0.0, -0.002);
  std::vector<PlainPose> places;
  for (int step = 30; step >= 0; --step) {
    Pose X_GT = Pose::Identity();
    X_GT.linear() = RotationFromZTo(-Vector3::UnitZ());
    X_GT.translation() = centre_m + Vector3(0.0, 0.0, 1e-3 * step - kRadius_m);
    places.push_back(X_GT);
  }
  if (!simulation::CarveTrail(*engine, places)) throw std::runtime_error("the engine refused a frame");
  const simulation::CarvedState state = engine->Snapshot();
  const std::vector<Ball> left = simulation::LiveBalls(state), cut = procedure::CutBalls(bone, state);
  std::vector<Vector3> hits_m;
  FailureSeries rays{.name = result.baseline_name},
      near{.name = "near points of the cut balls", .ours = true};
  for (const Vector3& direction : procedure::HemisphereDirections(Vector3::UnitZ(), 2000))
    if (const auto hit_m = simulation::FirstHit(left, centre_m, direction);
        hit_m && *hit_m < 1.1 * kRadius_m) {
      hits_m.push_back(centre_m + *hit_m * direction);
      rays.x.push_back(std::acos(-direction.z()) / kDegree);
      rays.y.push_back(1e3 * (*hit_m - kRadius_m));
    }
  for (std::size_t i = 0; i < cut.size(); ++i) {
    const Vector3 way_m = Vector3(cut[i].center_m) - centre_m;
    if (way_m.z() >= 0.0) continue;
    near.x.push_back(std::acos(-way_m.z() / way_m.norm()) / kDegree);
    near.y.push_back(1e3 * (way_m.norm() - cut[i].radius_m - kRadius_m));
  }
  const Sphere by_rays = GeometricFit(AsBalls(hits_m), centre_m), by_balls = GeometricFit(cut, centre_m);
  result.baseline = 2e3 * std::abs(by_rays.radius_m - kRadius_m);
  result.ours = 2e3 * std::abs(by_balls.radius_m - kRadius_m);
  result.note =
      fmt::format("{} balls, {} of them cut, {} rays.", bone.balls.size(), near.x.size(), hits_m.size());
  result.plot = {.x_label = "angle from the pole [deg]",
                 .y_label = "beyond the reamer's sphere [mm]",
                 .series = {rays, near}};
  return Judged(result);
}

}  // namespace osteon::studies
