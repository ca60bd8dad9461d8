#include "control/setup/check_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "base/units.h"
#include "kinematics/chain_reach.h"
#include "kinematics/serial_chain.h"

namespace osteon::control {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRounding_m = 1e-9;  // rounding error of a distance

// Throws std::invalid_argument if a value is out of range: a caller's mistake.
template <int N>
void CheckSurroundings(const PathSurroundings& around) {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(std::string("path surroundings: accepted ") + what);
  };
  require(around.resolution_m > 0.0, "resolution_m > 0");
  require(around.clearance_m > around.resolution_m && std::isfinite(around.clearance_m),
          "clearance_m > resolution_m");
  for (const PathBall& ball : around.balls)
    require(ball.link >= -1 && ball.link < N && ball.radius_m >= 0.0 && ball.center_m.allFinite(),
            "balls on links -1 … N-1, of radius_m >= 0");
  for (const KeepAbovePlane& plane : around.planes)
    require(std::abs(plane.normal_W.norm() - 1.0) < 1e-6 && std::isfinite(plane.offset_m),
            "planes with a unit normal");
  for (const KeepOutSphere& sphere : around.spheres)
    require(sphere.radius_m >= 0.0 && sphere.center_W_m.allFinite(), "spheres of radius_m >= 0");
}

// Describes why an end of the path is not accepted; empty if it is accepted.
template <int N>
std::string EndError(const kinematics::ChainParams<N>& chain, const kinematics::JointVectorN<N>& q,
                     double margin_rad, const char* which) {
  for (int i = 0; i < N; ++i) {
    const kinematics::JointLimits& limits = chain.joints[static_cast<std::size_t>(i)].limits;
    const double low = limits.lower_rad + margin_rad, high = limits.upper_rad - margin_rad;
    if (!(q[i] >= low && q[i] <= high))
      return fmt::format("{} of the path: found A{} at {:.2f} deg, accepted {:.2f} … {:.2f}", which, i + 1,
                         q[i] / kDegree, low / kDegree, high / kDegree);
  }
  return {};
}

// Distances [m] of all balls from all obstacles at a posture, as one array. For each ball it has the
// distances from all planes, then the distance from the nearest sphere. A negative distance means beneath a
// plane or inside a sphere.
template <int N>
class Distances {
 public:
  Distances(const kinematics::ChainParams<N>& chain, const PathSurroundings& around)
      : chain_(chain),
        around_(around),
        obstacle_count_(around.planes.size() + (around.spheres.empty() ? 0 : 1)) {}

  [[nodiscard]] std::size_t size() const { return around_.balls.size() * obstacle_count_; }

  std::vector<double> At(const kinematics::JointVectorN<N>& q) const {
    const auto posture = chain_.ComputePosture(q);
    std::vector<double> d;
    d.reserve(size());
    for (const PathBall& ball : around_.balls) {
      const Pose X_BL = ball.link < 0 ? posture.X_BF : chain_.LinkPose(posture, ball.link);
      const Vector3 p_W = around_.X_WB * (X_BL * ball.center_m);
      for (const KeepAbovePlane& plane : around_.planes)
        d.push_back(plane.normal_W.dot(p_W) - plane.offset_m - ball.radius_m);
      if (around_.spheres.empty()) continue;
      double nearest_m = kInfinity;
      for (const KeepOutSphere& sphere : around_.spheres)
        nearest_m = std::min(nearest_m, (p_W - sphere.center_W_m).norm() - sphere.radius_m);
      d.push_back(nearest_m - ball.radius_m);
    }
    return d;
  }

  [[nodiscard]] const PathBall& ball(std::size_t i) const { return around_.balls[i / obstacle_count_]; }
  [[nodiscard]] bool is_plane(std::size_t i) const { return i % obstacle_count_ < around_.planes.size(); }
  [[nodiscard]] const std::string& obstacle_name(std::size_t i) const {
    return is_plane(i) ? around_.planes[i % obstacle_count_].name : around_.spheres_name;
  }

 private:
  kinematics::SerialChain<N> chain_;
  const PathSurroundings& around_;
  // number of distances per ball: one for each plane, and one for all spheres together
  std::size_t obstacle_count_;
};

// "at 43 % of the path: found the head 12.0 mm inside the bone, accepted 10.0 mm clear of it"
template <int N>
std::string DescribeViolation(const Distances<N>& at, std::size_t i, double share, double found_m,
                              double accepted_m) {
  const char* where = found_m >= 0.0 ? "clear of" : at.is_plane(i) ? "beneath" : "inside";
  return fmt::format("at {:.0f} % of the path: found {} {:.1f} mm {} {}, accepted {}", 100.0 * share,
                     at.ball(i).name, 1e3 * std::abs(found_m), where, at.obstacle_name(i),
                     accepted_m >= 0.0
                         ? fmt::format("{:.1f} mm clear of it", 1e3 * accepted_m)
                         : fmt::format("{:.1f} mm beneath, and less from there on", -1e3 * accepted_m));
}

}  // namespace

template <int N>
tl::expected<PathClearance, std::string> CheckPath(const kinematics::ChainParams<N>& chain,
                                                   const kinematics::JointVectorN<N>& q_from,
                                                   const kinematics::JointVectorN<N>& q_goal,
                                                   const PathSurroundings& around) {
  CheckSurroundings<N>(around);
  for (const std::string& error : {EndError<N>(chain, q_from, 0.0, "the beginning"),
                                   EndError<N>(chain, q_goal, around.position_margin_rad, "the end")})
    if (!error.empty()) return tl::unexpected(error);

  const Distances<N> distances(chain, around);
  const kinematics::JointVectorN<N> way = q_goal - q_from;
  std::vector<double> max_so_far = distances.At(q_from), goal = distances.At(q_goal);
  for (std::size_t i = 0; i < max_so_far.size(); ++i) {
    if (max_so_far[i] < 0.0 && !distances.is_plane(i))
      return tl::unexpected(DescribeViolation(distances, i, 0.0, max_so_far[i], 0.0) +
                            ": bring the tool out by hand, along its axis");
    if (goal[i] < 0.0) return tl::unexpected(DescribeViolation(distances, i, 1.0, goal[i], 0.0));
  }

  // upper bound of the distance that any ball travels over the whole path
  double ball_m = 0.0;
  for (const PathBall& ball : around.balls) ball_m = std::max(ball_m, ball.center_m.norm());
  const double travel_m = way.cwiseAbs().dot((kinematics::ReachBeyond(chain).array() + ball_m).matrix());

  PathClearance found;
  found.min_distance_m = kInfinity;
  const auto update_nearest = [&](double s, const std::vector<double>& d) {
    ++found.places;
    for (std::size_t i = 0; i < d.size(); ++i)
      if (d[i] < found.min_distance_m)
        found = {d[i], s, distances.ball(i).name + ", " + distances.obstacle_name(i), found.places};
  };
  for (double s = 0.0; s < 1.0;) {
    const std::vector<double> d = distances.At(q_from + s * way);
    update_nearest(s, d);
    double gap_m = kInfinity;
    for (std::size_t i = 0; i < d.size(); ++i) {
      max_so_far[i] = std::max(max_so_far[i], d[i]);
      const double floor_m = std::min({around.clearance_m, goal[i], max_so_far[i]});
      if (d[i] < floor_m - kRounding_m)
        return tl::unexpected(DescribeViolation(distances, i, s, d[i], floor_m));
      gap_m = std::min(gap_m, d[i] - floor_m);
    }
    // The step is as long as the smallest gap to a bound allows, but at least so long that no ball travels
    // more than 2 resolution.
    s += std::max(gap_m, 2.0 * around.resolution_m) / travel_m;
  }
  update_nearest(1.0, goal);
  return found;
}

template tl::expected<PathClearance, std::string> CheckPath<6>(const kinematics::ChainParams<6>&,
                                                               const kinematics::JointVectorN<6>&,
                                                               const kinematics::JointVectorN<6>&,
                                                               const PathSurroundings&);
template tl::expected<PathClearance, std::string> CheckPath<7>(const kinematics::ChainParams<7>&,
                                                               const kinematics::JointVectorN<7>&,
                                                               const kinematics::JointVectorN<7>&,
                                                               const PathSurroundings&);

}  // namespace osteon::control
