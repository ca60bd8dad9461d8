#pragma once

#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "kinematics/chain_params.h"
#include "kinematics/spatial.h"

// Checks at set-up, before the arm moves, whether it may move to a goal along a straight line in joint space
// (JointPath). Allocates memory; not for the tick.

namespace osteon::control {

/// A ball that moves with the arm and encloses a part of it.
struct PathBall {
  std::string name;                   ///< name in messages, e.g. "the tool's head"
  int link{-1};                       ///< the joint whose frame carries the ball, 0 … N-1; -1: the flange
  Vector3 center_m{Vector3::Zero()};  ///< centre of the ball in that frame
  double radius_m{0.0};               ///< >= 0
};

/// The space behind a plane, such as a table, which the balls must not enter.
struct KeepAbovePlane {
  std::string name;
  Vector3 normal_W{Vector3::UnitZ()};  ///< unit vector that points to the free side
  double offset_m{0.0};                ///< a point p is free if normal·p > offset
};

/// A sphere that the balls must not enter: part of a bone or of another obstacle.
struct KeepOutSphere {
  Vector3 center_W_m{Vector3::Zero()};
  double radius_m{0.0};
};

/// The balls of the arm, and the obstacles that they must not touch. Plain data.
struct PathSurroundings {
  Pose X_WB{Pose::Identity()};  ///< the arm's base in world
  std::vector<PathBall> balls;
  std::vector<KeepAbovePlane> planes;
  std::vector<KeepOutSphere> spheres;  ///< together one obstacle, e.g. the balls of a bone
  std::string spheres_name{"the bone"};
  double clearance_m{0.01};    ///< > resolution
  double resolution_m{0.001};  ///< a ball may come nearer by at most this between two checked places; > 0
  /// Smallest accepted distance of the goal from the joints' position limits (1 deg).
  double position_margin_rad{0.0174532925199433};
};

/// Smallest distance over all checked places. Between two places a ball may be nearer, but by no more than
/// CheckPath accepts.
struct PathClearance {
  double min_distance_m{0.0};  ///< infinite if there are no obstacles
  double share{0.0};           ///< position of the nearest approach along the path: 0 … 1
  std::string between;         ///< "the tool's head, the bone"
  int places{0};               ///< number of places checked
};

/// Checks q_from + s (q_goal - q_from), s in 0 … 1. Let d(s) be the distance of a ball from a plane, or from
/// the nearest sphere, less its radius (negative: beneath or inside). The path is accepted if
///
///     limits     both ends are within the joints' limits, the goal by the margin
///     goal       d(1) >= 0
///     spheres    d(0) >= 0: an arm whose tool is in the bone is brought out by hand, along the tool's axis
///     path       d(s) >= min(clearance, d(1), max of d up to s)
///
/// for every ball. So the path keeps the clearance. If the goal itself is nearer than the clearance, the path
/// keeps the goal's distance: the work begins near the bone, and the cell's start pose determines how near.
/// If the arm begins nearer than that, or beneath a plane, it must move out and never come back nearer. The
/// cell's workspace is not checked, because the path may be needed just because the arm is outside the
/// workspace.
///
/// No violation between two checked places is missed. Within a step ds, no ball moves farther than sum_i
/// |dq_i| R_i ds, with the change dq_i of joint i over the path and the largest distance R_i of a ball from
/// its axis (ReachBeyond, plus the ball's distance from its frame). Each step is as long as the smallest gap
/// to a bound allows, or moves the balls by at most 2 resolution. Only the balls are checked: parts of the
/// links outside the balls may be nearer.
///
/// @returns the smallest distance; or a text for the user with the place, the value found and the value
///   accepted
/// @throws std::invalid_argument if a ball's link, a radius, the clearance or the resolution is out of range:
///   a caller's mistake.
template <int N>
[[nodiscard]] tl::expected<PathClearance, std::string> CheckPath(const kinematics::ChainParams<N>& chain,
                                                                 const kinematics::JointVectorN<N>& q_from,
                                                                 const kinematics::JointVectorN<N>& q_goal,
                                                                 const PathSurroundings& around);

}  // namespace osteon::control
