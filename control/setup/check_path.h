#pragma once

#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "kinematics/chain_params.h"
#include "kinematics/spatial.h"

// Checks at set-up, before the arm is driven, whether it may go straight in joint space (JointPath) to a
// goal. Allocates; not for the tick.

namespace osteon::control {

/// A ball that moves with the arm and encloses a part of it.
struct PathBall {
  std::string name;                   ///< name in messages, e.g. "the tool's head"
  int link{-1};                       ///< the joint whose frame carries the ball, 0 … N-1; -1: the flange
  Vector3 center_m{Vector3::Zero()};  ///< centre of the ball in that frame
  double radius_m{0.0};               ///< >= 0
};

/// Everything on the far side of a plane, such as the table.
struct KeepAbovePlane {
  std::string name;
  Vector3 normal_W{Vector3::UnitZ()};  ///< unit, to the free side
  double offset_m{0.0};                ///< free: normal·p > offset
};

/// Part of a bone or of another obstacle.
struct KeepOutSphere {
  Vector3 center_W_m{Vector3::Zero()};
  double radius_m{0.0};
};

/// The balls of the arm, and the obstacles that they must not touch. Plain data.
struct PathSurroundings {
  Pose X_WB{Pose::Identity()};  ///< the arm's base in world
  std::vector<PathBall> balls;
  std::vector<KeepAbovePlane> planes;
  std::vector<KeepOutSphere> spheres;  ///< together one obstacle to keep clear of, e.g. a bone's balls
  std::string spheres_name{"the bone"};
  double clearance_m{0.01};    ///< > resolution
  double resolution_m{0.001};  ///< by how much a ball may come nearer between two checked places; > 0
  /// Smallest distance of the goal from the joints' limits (1 deg).
  double position_margin_rad{0.0174532925199433};
};

/// Nearest approach over the checked places. Between two of them a ball may be nearer, but never beyond what
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
///     limits     both ends and all between are within the joints' limits, the goal by the margin
///     goal       d(1) >= 0
///     spheres    d(0) >= 0: an arm whose tool is in the bone is brought out by hand, along the tool's axis
///     way        d(s) >= min(clearance, d(1), max of d up to s)
///
/// for every ball. So the path keeps the clearance; near a goal that is nearer than the clearance, it keeps
/// the goal's distance; and an arm that begins nearer than that, or beneath a plane, moves out and never back
/// in. A goal near the bone is where the work begins: the cell's start pose says how near. The cell's
/// workspace is not checked: an arm outside it is a reason to need a path.
///
/// Nothing is missed between two places: in ds no ball moves farther than sum_i |dq_i| R_i ds (ReachBeyond
/// and the ball's own distance), and each step is as long as the smallest gap to the bound allows, or 2
/// resolution. Only the balls are checked: the links between them may be nearer.
///
/// @returns the nearest approach; or a text for the user: the place, the value found and the value accepted.
/// @throws std::invalid_argument if a ball's link, a radius, the clearance or the resolution is out of range:
///   a caller's mistake.
template <int N>
[[nodiscard]] tl::expected<PathClearance, std::string> CheckPath(const kinematics::ChainParams<N>& chain,
                                                                 const kinematics::JointVectorN<N>& q_from,
                                                                 const kinematics::JointVectorN<N>& q_goal,
                                                                 const PathSurroundings& around);

}  // namespace osteon::control
