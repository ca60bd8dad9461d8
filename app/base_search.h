#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "app/arm_force.h"

// Where in the room an LBR should stand, so that its tool's forces are available throughout a task.
//
// A base is judged by its worst pose of the task at one arm angle and one configuration: what the servo loop
// keeps through a run. Value: the factor of the whole need (ArmForce::Factor), least over all poses, at the
// best arm angle; zero where a pose can't be reached within the joint margin, an elbow or wrist is straighter
// than the least bend (there the force along the arm grows without bound, and so do the joint speeds), or
// elbow or wrist would be beyond the workspace's plane.

namespace osteon::app {

/// The same arm, its position limits drawn in by a margin on both sides.
[[nodiscard]] kinematics::LbrParams DrawnIn(kinematics::LbrParams params, double margin_rad);

struct AxisRange {
  double from{0.0}, to{0.0};
};

struct BaseSearchParams {
  AxisRange x_m, y_m, z_m;   ///< of the base, in W
  double clearance_m{0.35};  ///< from the site's centre to the base's axis, across that axis
  double joint_margin_rad{0.0872664625997165};  ///< kept from the position limits (5 deg)
  double least_bend_rad{0.261799387799149};     ///< of A4 and A6 (15 deg)
  Vector3 now_W_m{Vector3::Zero()};  ///< where the base stands; of places as good, the nearer to it is taken:
  double moving_share_per_m{0.01};   ///< a metre must gain more than this share
  double step_m{0.05};               ///< of the first grid
  double final_step_m{0.005};
  int arm_angles{36};  ///< of the circle
  int starts{6};       ///< places of the grid that are refined
  int threads{2};
};

/// A base that was judged.
struct BaseFigure {
  Pose X_WB{Pose::Identity()};
  double arm_angle_rad{0.0};
  unsigned configurations{0};  ///< bit c: configuration c does the whole task; 0: none does
  double factor{0.0};          ///< guaranteed: of the need, all of it at once
};

class BaseSearch {
 public:
  /// @param arm  with payload  @param R_WB  which way the base's axis points; turns about it are free
  BaseSearch(const kinematics::ChainParams<7>& arm, const Matrix3& R_WB, const Pose& X_FT,
             const TaskVolume& task, const CapabilityNeed& need, const BaseSearchParams& params);

  /// A base at a place, turned so that A1 looks at the site, at its best arm angle of the circle's steps.
  [[nodiscard]] BaseFigure Judge(const Vector3& p_WB) const;
  /// The same at a given arm angle, the task sampled finely.
  [[nodiscard]] BaseFigure Judge(const Vector3& p_WB, double arm_angle_rad) const;

  /// Grid, then compass search from its best places over x, y, z and the arm angle with the task sampled
  /// finely; the result is rounded to whole millimetres and degrees and judged as it is written.
  /// Deterministic.
  /// @returns nothing where the task can be done from nowhere in the ranges.
  [[nodiscard]] std::optional<BaseFigure> Best(const std::function<bool()>& stop) const;

  /// Turned about its axis so that A1's range over the task lies in the middle of its limits, to whole
  /// degrees.
  [[nodiscard]] BaseFigure Centred(const BaseFigure& figure) const;

  /// The worst of every figure over the finely sampled task, in the first of its configurations.
  [[nodiscard]] ToolForce Forces(const BaseFigure& figure) const;

 private:
  [[nodiscard]] Pose Facing(const Vector3& p_WB) const;
  [[nodiscard]] double TurnOf(const Pose& X_WB) const;
  [[nodiscard]] double Score(const BaseFigure& figure) const;
  [[nodiscard]] bool Stands(const Vector3& p_WB) const;
  [[nodiscard]] BaseFigure JudgeAt(const Pose& X_WB, double arm_angle_rad, const std::vector<Pose>& poses,
                                   double least) const;

  kinematics::LbrArm arm_;  ///< its limits drawn in by the margin
  ArmForce force_;
  Matrix3 R_WB_;
  Pose X_TF_;
  TaskVolume task_;
  BaseSearchParams params_;
};

}  // namespace osteon::app
