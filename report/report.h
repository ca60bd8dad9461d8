#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

#include "report/page.h"
#include "report/render.h"
#include "report/run_curves.h"
#include "report/section.h"
#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/tools/tool.h"

namespace osteon::report {

/// A row of the table of faults.
struct FaultRow {
  std::string name;
  double time_s{0.0};    ///< since the run's start; not finite: unknown
  std::string reaction;  ///< what the cell did
  std::string seen{};    ///< the measured values that caused the fault, if known
};

/// A row of the table of limits: a limit that acted in the run.
struct LimitRow {
  std::string name;        ///< readable name
  double first_s{0.0};     ///< time of its first action, counted from the first tick
  double total_s{0.0};     ///< time for which it acted
  double longest_s{0.0};   ///< longest time without an interruption
  std::uint64_t times{0};  ///< how often the limit began to act
};

/// The contents of a report. Spans, pointers and references must stay valid during the call.
struct ReportInput {
  std::string title{"Reaming an acetabulum"};
  std::string subtitle{};  ///< e.g. engine, device, date
  ReportVerdict verdict{};
  std::vector<SummaryRow> summary{};  ///< as the terminal shows it
  const RunCurves& run;               ///< curves of the run's ticks and frames
  std::span<const Pose> X_GP{};       ///< the proxy's path
  const simulation::Bone& bone;       ///< the bone before the run
  const simulation::CarvedState& after;
  const simulation::Tool& tool;
  /// The solid from which the bone was packed; null: unknown. With a solid, material boundaries are drawn
  /// sharply.
  const simulation::Solid* solid{nullptr};
  double force_limit_N{200.0};
  double tool_speed_limit_m_per_s{0.0};                                ///< 0: no line drawn
  double max_tool_in_bone_m{std::numeric_limits<double>::infinity()};  ///< infinite: no line drawn
  /// Tools that cut before `tool` in the same session, in the order of use.
  std::vector<simulation::ToolPath> earlier{};
  /// Signed distance of a point in G to the planned cavity [m], negative inside it. Empty: there is no plan.
  std::function<double(const Vector3& p_G_m)> planned{};
  std::vector<FaultRow> faults{};
  std::vector<LimitRow> limits{};  ///< the limits that acted
  /// Figures that are assumed because no source was found, one line each. Absent: the assumed figures of the
  /// bone's materials are listed.
  std::optional<std::vector<std::string>> assumptions{};
  std::string config_text{};   ///< the configuration as read
  std::string command_line{};  ///< the command that repeats the run
  std::string version{};
  RenderParams pictures{};
};

/// The figures that the report computes itself.
struct ReportFigures {
  CavityError cavity_section;    ///< errors measured along the section's outline
  CavityError cavity_direction;  ///< errors measured over directions in space
  /// Errors of the carved surface against the planned cavity; without a plan, against the tools' ideal cavity
  /// (CarveSurface).
  CavityError cavity_ideal;
};

/// The report as one HTML page, which needs no other file.
struct Report {
  std::string html;
  ReportFigures figures;
};
[[nodiscard]] tl::expected<Report, std::string> MakeReport(const ReportInput& input);

/// Writes MakeReport's page to a file, completely or not at all. @returns the figures, or an error that names
/// the file.
[[nodiscard]] tl::expected<ReportFigures, std::string> WriteReport(const ReportInput& input,
                                                                   const std::filesystem::path& path);

}  // namespace osteon::report
