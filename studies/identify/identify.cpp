#include "studies/identify/identify.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <map>
#include <system_error>

#include <fmt/format.h>

#include "base/interrupt.h"
#include "base/write_text.h"
#include "config/reading/load.h"
#include "config/reading/load_identified.h"
#include "report/page.h"
#include "session/process/exit_code.h"
#include "session/setup/cell_setup.h"
#include "session/summary/run_files.h"
#include "studies/identify/excited_run.h"
#include "studies/identify/identify_estimate.h"
#include "studies/identify/identify_joints.h"
#include "studies/identify/identify_margins.h"
#include "studies/identify/identify_page.h"
#include "studies/identify/identify_table.h"

namespace osteon::studies {
namespace {

namespace fs = std::filesystem;

constexpr double kRest_s = 60.0, kTremor_s = 30.0;  // lengths of the noise run and the tremor run
// Seeds of the runs that are fitted, and of the runs for validation.
constexpr std::uint64_t kSeed = 1, kOtherSeed = 101;
constexpr int kJointDraws = 2, kJointPeriods = 2;  // they take 24 s

// A recording to be made.
struct PlannedRun {
  ExcitationRequest request;
  fs::path file;
  bool validates{false};  // the run is not fitted: it validates another run's fit
};

// Plans the runs that move one joint after another, at each speed.
void PlanJoints(const IdentifyOptions& options, int joints, std::vector<PlannedRun>& runs) {
  std::vector<int> moved = options.joints;
  for (int joint = 1; joint <= joints && options.joints.empty(); ++joint) moved.push_back(joint);
  for (const int joint : moved)
    for (const double speed : options.joint_speeds_rad_per_s)
      runs.push_back({.request = {.peak_speed_m_per_s = speed,
                                  .seed = kSeed,
                                  .draws = kJointDraws,
                                  .periods = kJointPeriods,
                                  .joint = joint},
                      .file = options.out / fmt::format("joint_A{}_{:g}.mcap", joint, Degrees(speed))});
}

// Plans the requested runs and their files, in the order in which they are made.
// @param joints         number of joints of the cell's arm
// @param overlay        the cell has the impedance law: the excitation is a force on the arm's own impedance
// @param has_no_tremor  the simulated hand has no tremor that could be measured
std::vector<PlannedRun> PlanRuns(const IdentifyOptions& options, int joints, bool overlay,
                                 bool has_no_tremor) {
  std::vector<PlannedRun> runs;
  const auto file = [&](const std::string& kind, char axis, double speed_m_per_s) {
    return options.out / fmt::format("{}_{}_{:g}.mcap", kind, axis, 1e3 * speed_m_per_s);
  };
  if (options.runs.noise)
    runs.push_back({.request = {.rest_s = kRest_s}, .file = options.out / "noise.mcap"});
  if (options.runs.tremor && !has_no_tremor)
    runs.push_back({.request = {.held = true, .rest_s = kTremor_s}, .file = options.out / "tremor.mcap"});
  for (const char axis : options.axes)
    for (const double speed : options.speeds_m_per_s) {
      if (options.runs.free)
        runs.push_back(
            {.request = {.axis = axis, .peak_speed_m_per_s = speed, .seed = kSeed, .overlay = overlay},
             .file = file("free", axis, speed)});
      if (options.runs.held)
        runs.push_back(
            {.request =
                 {.axis = axis, .peak_speed_m_per_s = speed, .seed = kSeed, .held = true, .overlay = overlay},
             .file = file("held", axis, speed)});
      if (options.runs.free && options.runs.validate)
        runs.push_back({.request = {.axis = axis,
                                    .peak_speed_m_per_s = speed,
                                    .seed = kOtherSeed,
                                    .draws = 2,
                                    .periods = 2,
                                    .overlay = overlay},
                        .file = file("validate", axis, speed),
                        .validates = true});
    }
  if (options.runs.joints) PlanJoints(options, joints, runs);
  return runs;
}

// Whether a file of this name is a recording that PlanRuns names.
bool IsRecording(const std::string& name) {
  constexpr std::array kBegin{"noise.", "tremor.", "free_", "held_", "validate_", "joint_"};
  return name.ends_with(".mcap") &&
         std::ranges::any_of(kBegin, [&](const char* begin) { return name.starts_with(begin); });
}

// Moves the result files of an earlier identification into a subfolder, and its recordings as well if new
// ones are made.
// @returns an error, or an empty text
std::string KeepEarlierFiles(const IdentifyOptions& options) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(options.out, error), end; !error && entry != end;
       entry.increment(error)) {
    const fs::path& file = entry->path();
    const std::string name = file.filename().string();
    const bool is_result = name == "identify.html" || name == "identify.json" || name == "identified.yaml";
    if (is_result || (options.recordings.empty() && IsRecording(name))) files.push_back(file);
  }
  const auto earlier = session::KeepEarlier(options.out, files);
  if (!earlier) return earlier.error();
  if (!earlier->empty()) fmt::print("  {:<30} {}\n", "Earlier files", "moved to " + earlier->string());
  return "";
}

constexpr const char* kNoTremor =
    "left out: the simulated hand has no tremor; found operator: tremor_N: 0, accepted more than 0";

// Whether the run is simulated with a hand that has no tremor to measure.
bool HasNoTremor(const IdentifyOptions& options, const config::CellConfig& cell) {
  return options.simulated && cell.simulated.hand.tremor_N == 0.0;
}

// The recordings of an identification, sorted by their use.
struct Recordings {
  std::vector<fs::path> fits, validations;
};

// Moves the arm by each planned run and records it.
tl::expected<Recordings, std::string> RecordRuns(const IdentifyOptions& options) {
  auto setup = session::PrepareCell(options.cell, std::nullopt);
  if (!setup) return tl::unexpected(setup.error());
  session::PackAsScene(*setup);
  Recordings recordings;
  if (options.runs.tremor && HasNoTremor(options, setup->config)) fmt::print("  tremor run, {}\n", kNoTremor);
  for (const PlannedRun& run :
       PlanRuns(options, JointCount(setup->config), setup->config.servo.law == control::Law::kImpedance,
                HasNoTremor(options, setup->config))) {
    fmt::print("  {}\n", run.request.rest_s > 0.0
                             ? fmt::format("at rest for {:g} s{}", run.request.rest_s,
                                           run.request.held ? ", with a hand at the handle" : "")
                             : (run.validates ? "validation, " : "") + NameOf(run.request));
    std::fflush(stdout);
    const auto done = RunExcited(*setup, {.request = run.request,
                                          .recording = run.file,
                                          .simulated = options.simulated,
                                          .wall_time = options.wall_time,
                                          .stop = options.stop});
    if (!done) return tl::unexpected(fmt::format("{}: {}", run.file.string(), done.error()));
    (run.validates ? recordings.validations : recordings.fits).push_back(run.file);
  }
  return recordings;
}

// Names a recording that is given twice. It would count twice in a fit, or validate the fit that was made
// from it. Empty: there is none.
std::string RepeatedFile(const Recordings& recordings) {
  std::map<std::string, fs::path> known;  // names of recordings by the hashes of their files
  for (const std::vector<fs::path>* files : {&recordings.fits, &recordings.validations})
    for (const fs::path& file : *files)
      if (const auto [first, is_new] = known.emplace(HashOf(file), file); !is_new)
        return fmt::format("{}: found the recording of {} again, accepted each once{}", file.string(),
                           first->second.string(),
                           files == &recordings.validations ? ", and other data to validate with" : "");
  return "";
}

// Estimates from all recordings, then judges the estimates, and the cell's present gains by the estimates.
tl::expected<IdentifyResult, std::string> EstimateAll(const IdentifyOptions& options,
                                                      const Recordings& recordings) {
  const config::CellConfig cell = config::LoadCell(options.cell);
  const bool without_tremor = options.recordings.empty() && options.runs.tremor && HasNoTremor(options, cell);
  if (std::string wrong = RepeatedFile(recordings); !wrong.empty()) return tl::unexpected(std::move(wrong));
  IdentifyResult result = EmptyResult(options.cell.stem().string(), cell);
  if (without_tremor) result.warnings.push_back({"tremor run", kNoTremor});
  if (const auto added = AddAll(recordings.fits, recordings.validations, cell, result); !added)
    return tl::unexpected(added.error());
  UseFreeRuns(result);
  for (AxisResult& axis : result.axes) {
    axis.crossing_hz = CrossingOf(cell, axis);
    JudgeAxis(axis, result);
  }
  JudgeJoints(result);
  JudgeSpeeds(result);
  JudgeTremor(result);
  JudgePassive(result);
  FillFeltMasses(result);
  JudgeGains(cell, result);
  return result;
}

void Print(const IdentifyResult& result) {
  fmt::print("Osteon identify: {}\n", result.cell);
  for (const report::SummaryRow& row : session::VerdictRows(Judge(result)))
    fmt::print("  {:<30} {}\n", row.key, row.value);
  for (const report::SummaryRow& row : Rows(result)) fmt::print("  {:<30} {}\n", row.key, row.value);
  fmt::print("  {:<30} {:.0f} s of data in {:.2g} s\n", "Estimated", result.data_s, result.estimated_s);
}

// Whether the result contains anything that a cell or a study can use.
bool HasContent(const config::IdentifiedCell& identified) {
  return !identified.arm.empty() || !identified.response.empty() || !identified.hands.empty() ||
         identified.vibration || identified.dead_zone_N;
}

// The line that names the next command for the written file: `osteon tune`, or a run if neither arm nor hand
// was measured.
std::string WrittenText(const fs::path& file, const config::IdentifiedCell& identified) {
  const bool tunes = !identified.arm.empty() || !identified.response.empty() || !identified.hands.empty();
  return fmt::format("{0}: osteon {1} CELL --identified {0} takes it", file.string(), tunes ? "tune" : "run");
}

// Prints the same figures as lines for the cell's file, for a user who does not want `identified: FILE`.
void PrintCellLines(const config::IdentifiedCell& identified) {
  const auto line = [](const std::string& text) { fmt::print("  {:<30} {}\n", "In the cell's file", text); };
  if (identified.dead_zone_N) line(fmt::format("admittance: dead_zone_N: {:.3g}", *identified.dead_zone_N));
  if (!identified.vibration) return;
  if (identified.vibration->tremor_N > 0.0)
    line(fmt::format("vibration: tremor_N: {:.3g}", identified.vibration->tremor_N));
  if (!identified.vibration->notch_hz.empty())
    line(fmt::format("vibration: notch_hz: {:.3g}", identified.vibration->notch_hz.front()));
}

// Writes identify.json, the page, and identified.yaml if nothing was refused and a cell can use the result.
tl::expected<void, std::string> Write(const IdentifyOptions& options, const IdentifyResult& result) {
  std::error_code error;
  fs::create_directories(options.out, error);
  if (error) return tl::unexpected(options.out.string() + ": cannot make the folder: " + error.message());
  const std::string json = ToJson(result, options.command_line);
  for (const fs::path& file : {options.out / "identify.json", options.json})
    if (!file.empty())
      if (auto written = base::WriteText(file, json); !written) return written;
  if (auto written =
          report::WritePage(IdentifyPage(result, options.command_line), options.out / "identify.html");
      !written)
    return written;
  fmt::print("  {:<30} {}\n", "Page", (options.out / "identify.html").string());
  const fs::path file = options.out / "identified.yaml";
  const config::IdentifiedCell identified = ToIdentified(result);
  if (!result.refused.empty()) return {};
  if (!HasContent(identified)) {
    fmt::print("  {:<30} {}\n", "Written", "no identified.yaml: nothing in it that a cell would take");
    return {};
  }
  if (auto written = base::WriteText(
          file, config::WriteIdentified(
                    identified, "Measured, not assumed. Written by\n  " + options.command_line, result.law));
      !written)
    return written;
  fmt::print("  {:<30} {}\n", "Written", WrittenText(file, identified));
  PrintCellLines(identified);
  return {};
}

// Prints the table that shows the accuracy of identification: the cell's simulated arm is identified from
// synthetic recordings.
// @returns the process's exit code
int RunTable(const IdentifyOptions& options, const config::CellConfig& cell) {
  config::RequireSimulation(cell, options.cell);
  const auto& kr = cell.simulated.kr;
  const IdentifyTableParams params{.arm = kr ? kr->controller.servo : cell.simulated.servo,
                                   .period_s = cell.servo.period_s,
                                   .seeds = options.table_seeds};
  fmt::print(
      "Osteon identify: {}, synthetic recordings of an arm of {:g} Hz, damping {:g}, dead time {:g} ms, "
      "{} seeds, ± 2 sd\n",
      options.cell.stem().string(), params.arm.bandwidth_hz, params.arm.damping_ratio,
      1e3 * params.arm.dead_cycles * params.period_s, params.seeds);
  std::vector<TableRow> rows;
  for (const SyntheticRun& run : TableRuns()) {
    if (options.stop && options.stop->load()) return base::kExitInterrupted;
    rows.push_back(IdentifyRow(run, params));
  }
  fmt::print("{}", TableText(rows));
  if (options.json.empty()) return 0;
  const auto written = base::WriteText(options.json, TableJson(rows, params, options.command_line));
  return written ? 0 : session::Fail("identify", written.error(), session::kFailed);
}

// Says why the cell's joints cannot be moved as requested; empty: they can be moved, or no joint run is
// requested.
std::string WrongJoints(const IdentifyOptions& options, const config::CellConfig& cell) {
  if (!options.runs.joints || !options.recordings.empty()) return "";
  if (cell.servo.law == control::Law::kImpedance)
    return fmt::format(
        "{}: --do joints: found law: impedance, accepted law: admittance: under an impedance a force moves "
        "all joints at once; --do free,validate finds them",
        options.cell.string());
  const int count = JointCount(cell);
  for (const int joint : options.joints)
    if (joint > count)
      return fmt::format("--joints: found {}, accepted 1 … {}: the joints of {}", joint, count,
                         cell.robot.name);
  return "";
}

}  // namespace

int RunIdentify(const IdentifyOptions& options) {
  Recordings recordings{.fits = options.recordings, .validations = options.validations};
  const config::CellConfig cell = config::LoadCell(options.cell);
  if (options.table_seeds > 0) return RunTable(options, cell);
  if (const std::string wrong = WrongJoints(options, cell); !wrong.empty())
    return session::Fail("identify", wrong);
  if (recordings.fits.empty()) {
    if (options.simulated) config::RequireSimulation(cell, options.cell);
    fmt::print("Osteon identify: {} runs {}\n", options.cell.stem().string(),
               !options.simulated  ? "on the connected arm"
               : options.wall_time ? "on the simulated arm's real wires, in wall time"
                                   : "in virtual time");
    if (const std::string wrong = KeepEarlierFiles(options); !wrong.empty())
      return session::Fail("identify", wrong, session::kFailed);
    auto recorded = RecordRuns(options);
    if (!recorded) return session::Fail("identify", recorded.error(), session::kFailed);
    recordings = std::move(*recorded);
  }
  const auto begin = std::chrono::steady_clock::now();
  auto result = EstimateAll(options, recordings);
  if (!result) return session::Fail("identify", result.error());
  result->estimated_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  Print(*result);
  if (!options.recordings.empty())
    if (const std::string wrong = KeepEarlierFiles(options); !wrong.empty())
      return session::Fail("identify", wrong, session::kFailed);
  if (const auto written = Write(options, *result); !written)
    return session::Fail("identify", written.error(), session::kFailed);
  const bool found = !result->axes.empty() || !result->joints.empty() || !result->passive.empty() ||
                     result->noise.has_value() || result->tremor.has_value();
  return result->refused.empty() && found && GainsStand(*result) ? 0 : session::kFailed;
}

}  // namespace osteon::studies
