#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "config/reading/cell_config.h"
#include "report/report.h"
#include "session/summary/verdict.h"

// The forces that a cell renders truthfully: from the smallest force that the sensor distinguishes from its
// own errors, to the stiffest wall with which the loop is stable along each axis of the tool. The figures
// follow from `identified:` where they were measured, otherwise from the assumptions of the cell's file.

namespace osteon::studies {

/// A figure, and whether it was measured.
struct SourcedFigure {
  double value{0.0};
  bool measured{false};
};
/// "measured" or "assumed".
[[nodiscard]] const char* SourceOf(const SourcedFigure& figure);

/// Rendering along one axis of the tool's frame, at the cell's start.
struct RenderedAxis {
  char axis{'z'};
  /// Lag of the arm behind its command: dead time + 2 zeta / omega of the second-order response; with the
  /// impedance law only the dead time.
  SourcedFigure lag_s{};
  /// Effective mass of the arm along this axis: force on the tool divided by its acceleration. None for an
  /// arm without masses.
  std::optional<SourcedFigure> felt_mass_kg{};
  /// Only with the admittance law: the smallest drag with which the cell's virtual mass is stable with every
  /// hand and contact of `osteon tune`; infinite if no drag is enough.
  std::optional<double> least_drag_Ns_per_m{};
  /// Stiffest wall that is stable with the cell's own gains and every hand, up to kMaxWall_N_per_m. None with
  /// the impedance law, and if only the measured response may be used.
  std::optional<double> greatest_wall_N_per_m{};
  double asked_drag_Ns_per_m{0.0}, asked_wall_N_per_m{0.0};  ///< drag and wall that the cell's file states
  /// Whether the loop is stable with the drag and wall of the cell's file, also by the measured response if
  /// there is one.
  bool stands{true};
  /// Whether drag, wall and `stands` follow from a model or a response that was measured along this axis.
  bool loop_measured{false};
};
inline constexpr double kMaxWall_N_per_m = 1e6;  ///< largest wall that is tried

/// Rendering of a cell: the errors of its force sensor, and the loop along each axis of the tool.
struct Rendering {
  SourcedFigure dead_zone_N{}, noise_N{}, drift_N{}, sensor_delay_s{};
  std::vector<RenderedAxis> axes;  ///< x, y, z
  bool admittance{true};

  /// The smallest force of a hand that the loop distinguishes from the sensor's own errors: the dead zone, or
  /// three standard deviations of noise and drift, whichever is larger.
  [[nodiscard]] double force_floor_N() const;
  /// Whether dead zone, noise and drift were all measured.
  [[nodiscard]] bool floor_measured() const;
};

/// Computes a cell's rendering, from `cell.identified` where it has measured figures. Takes some seconds.
[[nodiscard]] Rendering RenderingOf(const config::CellConfig& cell);

/// Adds a remark for each axis along which the drag and wall of the cell's file are not stable by the
/// measured figures.
void JudgeRendering(const Rendering& rendering, session::Verdict& verdict);

/// @param greatest_N  force that the arm holds along the tool over the task
[[nodiscard]] std::vector<report::SummaryRow> RenderingRows(const Rendering& rendering, double greatest_N);
/// `rendering` of osteon.capability/1.
[[nodiscard]] nlohmann::json RenderingJson(const Rendering& rendering, double greatest_N);

}  // namespace osteon::studies
