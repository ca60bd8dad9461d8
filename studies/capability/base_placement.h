#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "studies/capability/arm_force.h"

// Searches the place of an LBR's base in the room from which the arm can hold the tool's forces throughout a
// task.
//
// A base is judged at one arm angle and one configuration, since the servo loop keeps both through a run. Its
// value is the smallest factor of the whole need (ArmForce::NeedFactor) over all poses of the task, at the
// best arm angle. The value is zero in three cases: a pose can't be reached within the joint margin; elbow or
// wrist is bent less than the minimum (near a straight joint the force along the arm and the joint speeds
// grow without bound); or elbow or wrist would lie beyond the workspace's plane.

namespace osteon::studies {

/// Returns the arm with its position limits narrowed by a margin on both sides.
[[nodiscard]] kinematics::LbrParams WithNarrowedLimits(kinematics::LbrParams params, double margin_rad);

/// Range of one coordinate.
struct AxisRange {
  double from{0.0}, to{0.0};
};

/// Ranges, conditions and fineness of the search.
struct BasePlacementParams {
  AxisRange x_m, y_m, z_m;  ///< ranges of the base's origin, in W
  /// Minimum distance of the site's centre from the base's axis, measured across that axis.
  double clearance_m{0.35};
  double joint_margin_rad{0.0872664625997165};  ///< distance kept from the position limits (5 deg)
  double min_bend_rad{0.261799387799149};       ///< least bend of A4 and A6 from straight (15 deg)
  /// The base's present place: the search prefers the nearest of equally good places.
  Vector3 now_W_m{Vector3::Zero()};
  /// Relative gain of the factor that a place must bring per metre of its distance from the present place.
  double moving_share_per_m{0.01};
  double step_m{0.05};  ///< spacing of the first grid
  double final_step_m{0.005};
  int arm_angles{36};  ///< samples of the elbow's circle
  int starts{6};       ///< number of grid places that are refined
  int threads{2};
};

/// A pose of the base, and its value for the task.
struct BaseFigure {
  Pose X_WB{Pose::Identity()};
  double arm_angle_rad{0.0};
  unsigned configurations{0};  ///< bit c: the whole task can be done in configuration c; 0: in none
  double factor{0.0};          ///< smallest share of the whole need that the arm holds over the task
};

/// The search for one arm, tool and task.
class BasePlacement {
 public:
  /// @param arm  with payload  @param R_WB  direction of the base's axis; turns about that axis are free
  BasePlacement(const kinematics::ChainParams<7>& arm, const Matrix3& R_WB, const Pose& X_FT,
                const TaskVolume& task, const CapabilityNeed& need, const BasePlacementParams& params);

  /// Judges a base at a place, at the best of the sampled arm angles. The base is turned so that A1 faces the
  /// site.
  [[nodiscard]] BaseFigure Judge(const Vector3& p_WB) const;
  /// Judges the base at a given arm angle, with the task sampled finely.
  [[nodiscard]] BaseFigure Judge(const Vector3& p_WB, double arm_angle_rad) const;

  /// Searches a grid, then refines its best places by compass search over x, y, z and the arm angle, with the
  /// task sampled finely. The result is rounded to whole millimetres and degrees, and judged as rounded.
  /// Deterministic.
  /// @returns nothing if the task can't be done from any place within the ranges.
  [[nodiscard]] std::optional<BaseFigure> Best(const std::function<bool()>& stop) const;

  /// Turns the base about its axis, by whole degrees, until A1's range over the task is centred in its
  /// limits.
  [[nodiscard]] BaseFigure Centred(const BaseFigure& figure) const;

  /// Returns the smallest value of each figure over the finely sampled task, in the first of the base's
  /// configurations.
  [[nodiscard]] ToolForce Forces(const BaseFigure& figure) const;

 private:
  [[nodiscard]] Pose Facing(const Vector3& p_WB) const;
  [[nodiscard]] double TurnOf(const Pose& X_WB) const;
  /// The figure's factor, lowered by moving_share_per_m for each metre of distance from the present base.
  [[nodiscard]] double Score(const BaseFigure& figure) const;
  /// Whether the site is at least clearance_m from the base's axis.
  [[nodiscard]] bool IsClearOfSite(const Vector3& p_WB) const;
  /// Judges a base at one arm angle over these poses. Gives no configuration if a pose fails, or as soon as
  /// the factor falls below `least`.
  [[nodiscard]] BaseFigure JudgeAt(const Pose& X_WB, double arm_angle_rad, const std::vector<Pose>& poses,
                                   double least) const;

  kinematics::LbrArm arm_;  ///< limits narrowed by the margin
  ArmForce force_;
  Matrix3 R_WB_;
  Pose X_TF_;
  TaskVolume task_;
  BasePlacementParams params_;
};

}  // namespace osteon::studies
