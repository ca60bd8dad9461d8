#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "report/report.h"
#include "session/summary/verdict.h"
#include "studies/capability/base_placement.h"
#include "studies/capability/capability_map.h"
#include "studies/capability/rendering.h"

// The result of `osteon capability` and its forms: rows, JSON, CSV, pictures, an overlay for the cell.

namespace osteon::studies {

/// A map over places of the robot's base, nx by ny.
struct BasePanel {
  std::string title, x_label, y_label;
  double x_from_m{0.0}, y_from_m{0.0}, step_m{0.0};
  int nx{0}, ny{0};
  /// Axial force that the arm holds in every pose of the task while all forces and torques of CapabilityNeed
  /// act at once, for each place, row by row along x; NaN if the task can't be done from the place.
  std::vector<double> force_N;
  std::array<double, 2> site{}, own{}, best{};  ///< places of the site, the present base and the best one [m]
};

/// All that `osteon capability` found.
struct CapabilityResult {
  std::string cell, tool;
  TaskVolume task;
  CapabilityNeed need;
  Pose X_WB{Pose::Identity()};
  double own_arm_angle_rad{0.0};
  CapabilityMap::Task best_angle,
      own_angle;   ///< forces from the present base: at the best arm angle, and at the cell's arm angle
  int outside{0};  ///< number of the task's poses outside the cell's workspace, which are not judged
  std::vector<MapPanel> maps;
  BasePlacementParams search;
  bool searched{false};            ///< whether a better base was looked for
  std::optional<BaseFigure> base;  ///< the best base; nothing if none was searched for or found
  ToolForce base_force;            ///< forces over the task from the best base
  std::vector<BasePanel> base_panels;
  /// Range of the forces that the cell renders truthfully; none: not computed.
  std::optional<Rendering> rendering{};
};

/// "bad": from the cell's own base the arm can't hold CapabilityNeed over the whole task at any arm angle.
/// "look": the arm can hold it, but not at the cell's arm angle; or a part of the task lies outside the
/// workspace; or no better base was found; or the measured arm is not stable with the cell's gains.
[[nodiscard]] session::Verdict Judge(const CapabilityResult& result);

/// The result as rows of a key and a text.
[[nodiscard]] std::vector<report::SummaryRow> Rows(const CapabilityResult& result);
/// JSON, schema osteon.capability/1.
[[nodiscard]] std::string ToJson(const CapabilityResult& result, const std::string& command_line);
/// The map's nodes as CSV, one node per line.
[[nodiscard]] std::string MapCsv(const CapabilityResult& result);
/// The best base's pose and arm angle as YAML, to replace those in the cell's file.
[[nodiscard]] std::string BaseYaml(const CapabilityResult& result, const std::string& command_line);

/// Draws axial and lateral force on two planes, at the best arm angles or at the cell's.
[[nodiscard]] std::string MapSvg(const CapabilityResult& result, bool own_arm_angle);
/// Draws the base panels; empty if there are none.
[[nodiscard]] std::string BaseSvg(const CapabilityResult& result);

/// A base's rotation as turns about the fixed x, then y, then z axis, as the cell's file states them.
[[nodiscard]] Vector3 RollPitchYaw(const Matrix3& R);

}  // namespace osteon::studies
