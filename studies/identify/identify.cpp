#include "studies/identify/identify.h"

#include <system_error>

#include <fmt/format.h>

#include "base/write_text.h"
#include "config/reading/load.h"
#include "config/reading/load_identified.h"
#include "report/page.h"
#include "session/process/exit_code.h"
#include "session/setup/cell_setup.h"
#include "studies/identify/excited_run.h"
#include "studies/identify/identify_estimate.h"
#include "studies/identify/identify_page.h"

namespace osteon::app {
namespace {

namespace fs = std::filesystem;

constexpr double kRest_s = 60.0;
constexpr std::uint64_t kSeed = 1, kOtherSeed = 101;

struct PlannedRun {
  ExcitationRequest request;
  fs::path file;
  bool validates{false};
};

std::vector<PlannedRun> PlanRuns(const IdentifyOptions& options) {
  std::vector<PlannedRun> runs;
  const auto file = [&](const std::string& kind, char axis, double speed_m_per_s) {
    return options.out / fmt::format("{}_{}_{:g}.mcap", kind, axis, 1e3 * speed_m_per_s);
  };
  if (options.runs.noise)
    runs.push_back({.request = {.rest_s = kRest_s}, .file = options.out / "noise.mcap"});
  for (const char axis : options.axes)
    for (const double speed : options.speeds_m_per_s) {
      if (options.runs.free)
        runs.push_back({.request = {.axis = axis, .peak_speed_m_per_s = speed, .seed = kSeed},
                        .file = file("free", axis, speed)});
      if (options.runs.held)
        runs.push_back({.request = {.axis = axis, .peak_speed_m_per_s = speed, .seed = kSeed, .held = true},
                        .file = file("held", axis, speed)});
      if (options.runs.free && options.runs.validate)
        runs.push_back(
            {.request =
                 {.axis = axis, .peak_speed_m_per_s = speed, .seed = kOtherSeed, .draws = 2, .periods = 2},
             .file = file("validate", axis, speed),
             .validates = true});
    }
  return runs;
}

// Moves the arm and records. @returns the recordings, by what they are for
struct Recordings {
  std::vector<fs::path> fits, validations;
};

tl::expected<Recordings, std::string> RecordRuns(const IdentifyOptions& options) {
  auto setup = PrepareCell(options.cell, std::nullopt);
  if (!setup) return tl::unexpected(setup.error());
  PackAsScene(*setup);
  Recordings recordings;
  for (const PlannedRun& run : PlanRuns(options)) {
    fmt::print("  {}\n", run.request.rest_s > 0.0
                             ? fmt::format("at rest for {:g} s", run.request.rest_s)
                             : (run.validates ? "validation, " : "") + NameOf(run.request));
    std::fflush(stdout);
    const auto done = RunExcited(*setup, {.request = run.request,
                                          .recording = run.file,
                                          .simulated = options.simulated,
                                          .stop = options.stop});
    if (!done) return tl::unexpected(fmt::format("{}: {}", run.file.string(), done.error()));
    (run.validates ? recordings.validations : recordings.fits).push_back(run.file);
  }
  return recordings;
}

tl::expected<IdentifyResult, std::string> EstimateAll(const IdentifyOptions& options,
                                                      const Recordings& recordings) {
  const config::CellConfig cell = config::LoadCell(options.cell);
  IdentifyResult result = EmptyResult(options.cell.stem().string(), cell);
  for (const fs::path& file : recordings.fits)
    if (const auto added = AddRecording(file, cell, result); !added) return tl::unexpected(added.error());
  for (const fs::path& file : recordings.validations)
    if (const auto added = AddValidation(file, cell, result); !added) return tl::unexpected(added.error());
  for (AxisResult& axis : result.axes) JudgeAxis(axis, result);
  JudgeSpeeds(result);
  return result;
}

void Print(const IdentifyResult& result) {
  fmt::print("Osteon identify: {}\n", result.cell);
  for (const SummaryRow& row : VerdictRows(Judge(result))) fmt::print("  {:<28} {}\n", row.key, row.value);
  for (const SummaryRow& row : Rows(result)) fmt::print("  {:<28} {}\n", row.key, row.value);
}

tl::expected<void, std::string> Write(const IdentifyOptions& options, const IdentifyResult& result) {
  std::error_code error;
  fs::create_directories(options.out, error);
  if (error) return tl::unexpected(options.out.string() + ": cannot make the folder: " + error.message());
  const std::string json = ToJson(result, options.command_line);
  for (const fs::path& file : {options.out / "identify.json", options.json})
    if (!file.empty())
      if (auto written = WriteText(file, json); !written) return written;
  if (auto written = WritePage(IdentifyPage(result, options.command_line), options.out / "identify.html");
      !written)
    return written;
  fmt::print("  {:<28} {}\n", "Page", (options.out / "identify.html").string());
  const fs::path file = options.out / "identified.yaml";
  if (!result.refused.empty() || result.axes.empty()) {
    fs::remove(file, error);  // an earlier one must not outlive a refusal
    return {};
  }
  if (auto written = WriteText(
          file, config::WriteIdentified(ToIdentified(result),
                                        "Measured, not assumed. Written by\n  " + options.command_line));
      !written)
    return written;
  fmt::print("  {:<28} {}\n", "Written", file.string() + ": osteon tune CELL --identified takes it");
  return {};
}

}  // namespace

int RunIdentify(const IdentifyOptions& options) {
  Recordings recordings{.fits = options.recordings, .validations = options.validations};
  const config::CellConfig cell = config::LoadCell(options.cell);
  if (cell.servo.law != control::Law::kAdmittance)
    return Fail("identify",
                options.cell.string() +
                    ": found the impedance law, accepted admittance: the arm's response to positions is "
                    "no part of that loop");
  if (recordings.fits.empty()) {
    if (options.simulated) config::RequireSimulation(cell, options.cell);
    fmt::print("Osteon identify: {} runs {}\n", options.cell.stem().string(),
               options.simulated ? "in virtual time" : "on the connected arm");
    auto recorded = RecordRuns(options);
    if (!recorded) return Fail("identify", recorded.error(), kFailed);
    recordings = std::move(*recorded);
  }
  const auto result = EstimateAll(options, recordings);
  if (!result) return Fail("identify", result.error());
  Print(*result);
  if (const auto written = Write(options, *result); !written)
    return Fail("identify", written.error(), kFailed);
  const bool found = !result->axes.empty() || !result->passive.empty() || result->noise.has_value();
  return result->refused.empty() && found ? 0 : kFailed;
}

}  // namespace osteon::app
