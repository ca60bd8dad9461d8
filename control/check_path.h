#pragma once

#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "kinematics/chain_params.h"
#include "kinematics/spatial.h"

// Whether the arm may go straight in joint space (JointPath) from where it is to a goal: asked at set-up,
// before it is driven. Allocates; not for the tick.

namespace osteon::control {

/// A ball that goes with the arm, and stands for a part of it.
struct PathBall {
  std::string name;                   ///< as it stands in messages, e.g. "the tool's head"
  int link{-1};                       ///< the joint whose frame carries it, 0 … N-1; -1: the flange
  Vector3 center_m{Vector3::Zero()};  ///< in that frame
  double radius_m{0.0};               ///< >= 0
};

/// Whatever is on the other side of a plane, such as the table.
struct KeepAbovePlane {
  std::string name;
  Vector3 normal_W{Vector3::UnitZ()};  ///< unit, to the free side
  double offset_m{0.0};                ///< free: normal·p > offset
};

/// Part of a bone, or of what else is in the way.
struct KeepOutSphere {
  Vector3 center_W_m{Vector3::Zero()};
  double radius_m{0.0};
};

/// Plain data: what may touch, and what it may not.
struct PathSurroundings {
  Pose X_WB{Pose::Identity()};  ///< the arm's base in world
  std::vector<PathBall> balls;
  std::vector<KeepAbovePlane> planes;
  std::vector<KeepOutSphere> spheres;  ///< all of them are one thing to keep clear of, e.g. a bone's balls
  std::string spheres_name{"the bone"};
  double clearance_m{0.01};    ///< > resolution
  double resolution_m{0.001};  ///< how much nearer a ball may come between two places that are looked at; > 0
  double position_margin_rad{0.0174532925199433};  ///< of the goal from the joints' limits (1 deg)
};

/// The nearest that anything came, of the places that were looked at: between two it may be nearer, but never
/// beyond what CheckPath accepts.
struct PathClearance {
  double least_m{0.0};  ///< infinite where there is nothing to meet
  double share{0.0};    ///< of the path, where that is: 0 … 1
  std::string between;  ///< "the tool's head, the bone"
  int places{0};        ///< that were looked at
};

/// Looks along q_from + s (q_goal - q_from), s in 0 … 1. With d(s) the distance of a ball from a plane, or
/// from the nearest of the spheres, less its radius (negative: beneath or inside), the path is accepted where
///
///     limits     both ends are within the joints' limits, the goal by the margin; so is what is between
///     goal       d(1) >= 0
///     spheres    d(0) >= 0: an arm whose tool is in the bone is brought out by hand, along the tool's axis
///     way        d(s) >= min(clearance, d(1), max of d up to s)
///
/// for every ball. So it keeps the clearance; near a goal that is nearer, no less than there; and an arm that
/// begins nearer than that, or beneath a plane, goes out and never back in. A goal near the bone is where the
/// work begins: the cell's start pose says how near. The cell's workspace is no bound here: an arm that is
/// outside it is why there is a path.
///
/// Nothing is missed between two places: no ball goes further in ds than sum_i |dq_i| R_i ds (ReachBeyond and
/// the ball's own distance), and each step is what the smallest gap to the bound allows, or 2 resolution.
/// Only the balls are looked at: links between them may be nearer.
///
/// @returns the nearest approach; or where, what was found and what is accepted, as a text for the user.
/// @throws std::invalid_argument where a ball's link, a radius, the clearance or the resolution is out of
/// range: a mistake of the caller.
template <int N>
[[nodiscard]] tl::expected<PathClearance, std::string> CheckPath(const kinematics::ChainParams<N>& chain,
                                                                 const kinematics::JointVectorN<N>& q_from,
                                                                 const kinematics::JointVectorN<N>& q_goal,
                                                                 const PathSurroundings& around);

}  // namespace osteon::control
