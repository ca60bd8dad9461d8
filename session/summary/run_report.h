#pragma once

#include <filesystem>
#include <string>

#include <tl/expected.hpp>

#include "report/report.h"
#include "session/run/cell_run.h"
#include "session/setup/cell_setup.h"
#include "session/summary/run_accumulator.h"
#include "session/summary/summary.h"

namespace osteon::session {

/// Writes the report of a run: one page with verdict, figures, pictures of the bone and charts.
/// @param run  read from the run's recording  @param command  "demo", "run"
/// @param command_line  the command that repeats the run
/// @returns the figures of the report's section on the cavity; the error names the file.
[[nodiscard]] tl::expected<report::ReportFigures, std::string> WriteRunReport(
    const CellSetup& setup, const CellRunResult& result, const RunAccumulator& run, const RunSummary& summary,
    const std::string& command, const std::string& command_line, const std::filesystem::path& page);

}  // namespace osteon::session
