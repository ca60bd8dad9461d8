#include "simulation/packing/counted_packing.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "simulation/packing/graded_descent.h"
#include "simulation/packing/morton.h"
#include "simulation/packing/tangent_balls.h"

namespace osteon::simulation {
namespace {

constexpr double kRadiusOverSpacing = 0.8;  // from 0.56 on, a body-centred lattice has no holes

/// Conditions under which a site of a body-centred lattice gets a ball.
struct LatticeRule {
  double spacing_m{0.0};
  double min_distance_m{0.0};  ///< smallest distance of a centre from the surface
  double min_depth_m{0.0};     ///< smallest depth of a centre below the zone
};

// Calls add(ball, items) for each ball of a body-centred lattice; `add` appends to `items`. Returns all
// items.
template <typename Item, typename Add>
std::vector<Item> DescendLattice(const Solid& solid, const CutZone& zone, const LatticeRule& rule,
                                 int threads, const Add& add) {
  const auto add_leaf = [&](const Cell& cell, std::vector<Item>& items) {
    const auto site = [&](const Vector3& p, double distance_m) {
      if (-distance_m >= rule.min_distance_m && zone.DepthAt(p) >= rule.min_depth_m)
        add(Ball{.center_m = p, .radius_m = std::min(kRadiusOverSpacing * rule.spacing_m, -distance_m)},
            items);
    };
    const double distance = solid.SignedDistance(cell.center());
    if (distance > cell.reach_m()) return;
    site(cell.center(), distance);
    site(cell.min_corner(), solid.SignedDistance(cell.min_corner()));
  };
  return DescendGraded<Item>(solid, zone, {.finest_m = rule.spacing_m, .coarser_from_m = {}},
                             CellChoice::kSolid, threads, kMaxBalls, add_leaf);
}

// Finds a spacing whose packing has nearly the wanted number of balls. `count_at` returns the number for a
// spacing, and is called once per guess. If a face of the solid is parallel to the lattice, the number jumps
// by a whole plane of balls. So a guess outside the known bracket is replaced by the bracket's middle, and
// the best guess is returned.
double FindSpacing(double first_m, std::size_t wanted, const std::function<std::size_t(double)>& count_at) {
  constexpr int kMaxRounds = 12;
  constexpr double
      // the number falls with spacing^-kExponent: 3 within the solid, 2 along its surface
      kTolerance = 0.004,
      kExponent = 2.8;
  const auto target = static_cast<double>(wanted);
  double spacing = first_m, best = first_m, best_error = HUGE_VAL;
  double too_fine = 0.0, too_coarse = HUGE_VAL;
  for (int round = 0; round < kMaxRounds; ++round) {
    const auto count = static_cast<double>(std::max<std::size_t>(1, count_at(spacing)));
    const double error = std::abs(count / target - 1.0);
    if (error < best_error) {
      best_error = error;
      best = spacing;
    }
    if (error <= kTolerance) break;
    if (count > target)
      too_fine = std::max(too_fine, spacing);
    else
      too_coarse = std::min(too_coarse, spacing);
    spacing *= std::pow(count / target, 1.0 / kExponent);
    if (!(spacing > too_fine && spacing < too_coarse)) spacing = std::sqrt(too_fine * too_coarse);
  }
  return best;
}

// Volume [m³] of the part of the solid that is deeper than `depth_m` below the zone, summed over cells of a
// sixtieth of the solid's size.
double VolumeBelow(const Solid& solid, const CutZone& zone, double depth_m, int threads) {
  const double side = solid.Bounds().sizes().maxCoeff() / 60.0;
  double volume = 0.0;
  for (const Cell& cell :
       DivideGraded(solid, zone, {.finest_m = side, .coarser_from_m = {}}, CellChoice::kSolid, threads))
    if (cell.signed_distance_m < 0.0 && zone.DepthAt(cell.center()) >= depth_m) volume += side * side * side;
  return volume;
}

// Makes the packing of CountedGrade::kFixedZone.
std::vector<Ball> FixedZone(const Solid& solid, const CutZone& zone, const PackingParams& base,
                            std::size_t count) {
  std::vector<Ball> balls = BuildPacking(solid, zone, base);
  if (balls.size() >= count || base.lattice.coarser_from_m.empty()) {
    if (balls.size() == count) return balls;
    PackingParams coarser = base;
    coarser.count = count;
    return BuildPacking(solid, zone, coarser);
  }
  LatticeRule rule{.min_depth_m = base.lattice.coarser_from_m.front()};
  std::erase_if(balls,
                [&](const Ball& ball) { return zone.DepthAt(Vector3(ball.center_m)) >= rule.min_depth_m; });
  const auto with_spacing = [&rule](double spacing_m) {
    LatticeRule spaced = rule;
    spaced.spacing_m = spacing_m;
    spaced.min_distance_m = 0.3 * spacing_m;
    return spaced;
  };
  const std::size_t wanted = count - balls.size();
  // a body-centred lattice has two balls per cube whose edge is the spacing
  const double first_guess_m =
      std::cbrt(2.0 * VolumeBelow(solid, zone, rule.min_depth_m, base.threads) / static_cast<double>(wanted));
  // one byte per ball is enough for counting
  const double spacing = FindSpacing(first_guess_m, wanted, [&](double spacing_m) {
    return DescendLattice<char>(solid, zone, with_spacing(spacing_m), base.threads,
                                [](const Ball&, std::vector<char>& items) { items.push_back(1); })
        .size();
  });
  const std::vector<Ball> deep =
      DescendLattice<Ball>(solid, zone, with_spacing(spacing), base.threads,
                           [](const Ball& ball, std::vector<Ball>& items) { items.push_back(ball); });
  balls.insert(balls.end(), deep.begin(), deep.end());
  return balls;
}

// Makes the packing of CountedGrade::kUniform with a lattice of this spacing.
std::vector<Ball> UniformAt(const Solid& solid, const PackingParams& base, double spacing_m) {
  const EverywhereZone everywhere;
  PackingParams params = base;
  params.cup_radius_cap_m = kRadiusOverSpacing * spacing_m;
  params.radius_growth = 0.0;
  params.min_radius_m = 0.1 * params.cup_radius_cap_m;
  const LatticeRule rule{.spacing_m = spacing_m, .min_distance_m = 0.9 * params.cup_radius_cap_m};
  std::vector<Ball> balls =
      DescendLattice<Ball>(solid, everywhere, rule, base.threads,
                           [](const Ball& ball, std::vector<Ball>& items) { items.push_back(ball); });
  for (const TangentBall& tangent :
       FindTangentBalls(solid, everywhere, params, {.finest_m = 0.5 * spacing_m, .coarser_from_m = {}}))
    balls.push_back(tangent.ball);
  return balls;
}

// Makes the packing of CountedGrade::kUniform with nearly this number of balls.
std::vector<Ball> UniformPacking(const Solid& solid, const PackingParams& base, std::size_t count) {
  const double volume = VolumeBelow(solid, EverywhereZone(), 0.0, base.threads);
  const double first_guess_m = std::cbrt(3.0 * volume / static_cast<double>(count));
  const double spacing = FindSpacing(
      first_guess_m, count, [&](double spacing_m) { return UniformAt(solid, base, spacing_m).size(); });
  return UniformAt(solid, base, spacing);
}

}  // namespace

std::vector<Ball> BuildCountedPacking(const Solid& solid, const CutZone& zone, const PackingParams& base,
                                      std::size_t count, CountedGrade grade) {
  if (count < 1 || count > kMaxBalls)
    throw std::invalid_argument(fmt::format("packing: count: found {}, accepted 1 … {}", count, kMaxBalls));
  PackingParams params = base;
  params.count = 0;
  std::vector<Ball> balls = grade == CountedGrade::kUniform ? UniformPacking(solid, params, count)
                                                            : FixedZone(solid, zone, params, count);
  SortAlongMortonCurve(balls, solid.Bounds(), [](const Ball& ball) { return Vector3(ball.center_m); });
  return balls;
}

double MeanSpacing(const Bone& bone, const CutZone& zone, double depth_m) {
  double volume = 0.0;
  std::size_t centers = 0;
  for (const MassPoint& point : bone.points)
    if (zone.DepthAt(Vector3(point.p_m)) < depth_m) volume += point.volume_m3;
  for (const Ball& ball : bone.balls)
    if (zone.DepthAt(Vector3(ball.center_m)) < depth_m) ++centers;
  return centers > 0 ? std::cbrt(volume / static_cast<double>(centers)) : 0.0;
}

}  // namespace osteon::simulation
