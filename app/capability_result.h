#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "app/base_search.h"
#include "app/capability_map.h"
#include "app/report/report.h"
#include "app/verdict.h"

// What `osteon capability` found, and how it is said: rows, JSON, CSV, pictures, an overlay for the cell.

namespace osteon::app {

/// How the forces change with where the base stands: the guaranteed axial force while all of the need acts at
/// once [N]; NaN where the task can't be done.
struct BasePanel {
  std::string title, x_label, y_label;
  double x_from_m{0.0}, y_from_m{0.0}, step_m{0.0};
  int nx{0}, ny{0};
  std::vector<double> force_N;
  std::array<double, 2> site{}, own{}, best{};  ///< [m]
};

struct CapabilityResult {
  std::string cell, tool;
  TaskVolume task;
  CapabilityNeed need;
  Pose X_WB{Pose::Identity()};
  double own_arm_angle_rad{0.0};
  CapabilityMap::Task best_angle, own_angle;
  std::vector<MapPanel> maps;
  BaseSearchParams search;
  bool searched{false};
  std::optional<BaseFigure> base;  ///< the best; nothing where none was looked for or found
  ToolForce base_force;
  std::vector<BasePanel> base_panels;
};

/// Bad where the arm can't hold both needs over the whole task from the cell's own base, whatever its arm
/// angle; to be looked at where it can, but not at the cell's arm angle, or where no better base was found.
[[nodiscard]] Verdict Judge(const CapabilityResult& result);

[[nodiscard]] std::vector<SummaryRow> Rows(const CapabilityResult& result);
/// schema osteon.capability/1
[[nodiscard]] std::string ToJson(const CapabilityResult& result, const std::string& command_line);
/// The map's nodes, one a line.
[[nodiscard]] std::string MapCsv(const CapabilityResult& result);
/// What to put into the cell's file in place of its own lines.
[[nodiscard]] std::string BaseYaml(const CapabilityResult& result, const std::string& command_line);

/// Axial and lateral force on two planes.
[[nodiscard]] std::string MapSvg(const CapabilityResult& result, bool own_arm_angle);
/// Empty where there are no panels.
[[nodiscard]] std::string BaseSvg(const CapabilityResult& result);

/// A base's turns about the fixed x, then y, then z axis, as its file says them.
[[nodiscard]] Vector3 RollPitchYaw(const Matrix3& R);

}  // namespace osteon::app
