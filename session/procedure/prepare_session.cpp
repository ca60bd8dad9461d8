#include "session/procedure/prepare_session.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <numbers>
#include <set>
#include <utility>
#include <variant>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/json_value.h"
#include "base/read_text.h"
#include "base/write_text.h"
#include "config/reading/check_plan_in_cell.h"
#include "config/reading/config_file_tracker.h"
#include "config/reading/load_rubric.h"
#include "session/procedure/plan_guidance.h"
#include "session/procedure/session_bone.h"
#include "session/setup/config_checksum.h"

namespace osteon::session {
namespace {

namespace fs = std::filesystem;

constexpr double kSameSize_m = 1e-6;  // a reamer is the same if the radii differ by less

// The hand of a novice. Its axis deviates by 14 ± 7 degrees from the planned axis (PMC6494316). Reaming
// without guidance moves the centre by 3.7 ± 2.6 mm superiorly and 5.0 ± 3.3 mm medially (PMID 27909120). So
// the simulated hand aims 6 mm to the side; the cup's walls hold it back, and about 4 mm remain. It aims at a
// floor 5 mm too deep. An unsure person's arm stiffens by kStiffnessFactor to 8 N/mm; published values reach
// 10 N/mm (hil/operator/operator_hand.h). The hand presses with 140 N, near its own limit, until it gives up
// (assumed). Its target lies kPastPlan_m below the floor at which it aims.
struct NoviceHand {
  static constexpr double kTilt_rad = 14.0 * std::numbers::pi / 180.0, kAside_m = 0.006, kTooDeep_m = 0.005;
  static constexpr double kStiffnessFactor = 4.0, kPush_N = 140.0, kPastPlan_m = 0.020;
};

// The hand of a novice with a burr. Its fields mean the same as those of NoviceHand; kPushFactor multiplies
// the push force of the cell's script. All values are assumed: in a tooth, the errors of unguided hands are
// as large as the burr.
struct NoviceBurr {
  static constexpr double kTilt_rad = 10.0 * std::numbers::pi / 180.0, kAside_m = 0.0008, kTooDeep_m = 0.001;
  static constexpr double kPushFactor = 1.5, kPastPlan_m = 0.001;
};
// A hand that leads a burr rests its fingers on the teeth. This makes the hand stiffer by kFingerRestFactor,
// to 8 N/mm; published values reach 10 N/mm (hil/operator/operator_hand.h). The hand leads the burr a little
// beyond the planned circle, so that it still presses when the burr has reached the circle; kLead_m is this
// distance. Along the axis an expert stops pressing kExpertPastPlan_m beyond the plan. Both distances are
// assumed.
constexpr double kFingerRestFactor = 4.0, kExpertPastPlan_m = 0.1e-3, kLead_m = 0.3e-3;
constexpr double kClearOfOpening_m = 3e-3;  // a burr is retracted if it is this far over the opening's rim

// Returns the frame of the plan in G: origin at the plan's centre, +z along its axis, x and y as near to the
// axes of G as possible.
Pose PlanFrame(const procedure::SurgicalPlan& plan) {
  Pose X_GC = Pose::Identity();
  X_GC.linear() = Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), plan.axis_G).toRotationMatrix();
  X_GC.translation() = plan.centre_m;
  return X_GC;
}

// Collects the cell's gains for session.json.
SessionGains GainsOfCell(const control::ServoParams& servo) {
  SessionGains gains{.law = servo.law == control::Law::kAdmittance ? "admittance" : "impedance",
                     .stiffness_N_per_mm = 1e-3 * servo.coupling.max_stiffness_N_per_m,
                     .damping_Ns_per_m = servo.coupling.damping_Ns_per_m};
  if (servo.law != control::Law::kAdmittance) return gains;
  for (std::size_t i = 0; i < 3; ++i) {
    gains.mass_kg[i] = servo.admittance.mass_kg[static_cast<Eigen::Index>(i)];
    gains.drag_Ns_per_m[i] = servo.admittance.damping_Ns_per_m[static_cast<Eigen::Index>(i)];
  }
  return gains;
}

// Sets the mesh of the procedure, with the plan's cup; a session that is resumed keeps its own mesh.
// @returns what is wrong; empty: nothing
std::string TakeMesh(const ProcedureChoice& choice, const config::CellConfig& cell, Procedure& made) {
  const auto& cup = made.plan.mesh_cup;
  if (choice.resume && !made.mesh && !made.file.mesh_file.empty())
    made.mesh = MeshChoice{.file = made.file.mesh_file, .scale = made.file.mesh_scale};
  if (made.mesh && !cup)
    return fmt::format("--mesh: found with --plan {}, accepted without: the plan names its bone",
                       choice.plan.string());
  if (cup && !made.mesh && !cell.bone)
    return fmt::format(
        "--plan {}: found a plan for a mesh and no --mesh, accepted with it, or with a cell whose bone it is",
        choice.plan.string());
  if (!made.mesh) return "";
  made.mesh->cup = cup;
  made.file.mesh_file = fs::absolute(made.mesh->file).lexically_normal().string();
  made.file.mesh_scale = made.mesh->scale;
  return "";
}

}  // namespace

std::string ValidateNewSession(const fs::path& folder) {
  if (folder.empty()) return "--session: found no name, accepted a folder";
  std::error_code error;
  if (!fs::exists(folder, error)) return "";
  if (!fs::is_directory(folder, error))
    return fmt::format("--session {}: found a file, accepted a folder", folder.string());
  if (fs::exists(folder / kSessionFileName, error))
    return fmt::format("--session {}: found a session, accepted a new folder, or --resume", folder.string());
  if (LastNumber(folder, kRecordingPrefix, kRecordingEnding) > 0 ||
      LastNumber(folder, kStatePrefix, kStateEnding) > 0)
    return fmt::format(
        "--session {}: found recordings or states of a session whose {} is missing, accepted a new folder",
        folder.string(), kSessionFileName);
  return "";
}

tl::expected<double, std::string> GainFrom(const fs::path& folder, const std::string& plan_checksum) {
  constexpr double kLessForEach = 0.25;  // each passed session reduces the gain by this much
  std::error_code error;
  if (!fs::is_directory(folder, error))
    return tl::make_unexpected(
        fmt::format("{}: found no folder, accepted one with a trainee's sessions", folder.string()));
  double gain = 1.0;
  for (const auto& entry : fs::directory_iterator(folder, error))
    for (const char* inner : {"", "session"}) {
      std::ifstream stream(entry.path() / inner / "assess.json");
      if (!stream) continue;
      const auto json = nlohmann::json::parse(stream, nullptr, false);
      if (base::FlagAt(json, "passed") &&
          base::TextAt(base::ValueAt(json, "plan"), "checksum") == plan_checksum)
        gain -= kLessForEach;
    }
  return std::max(0.0, gain);
}

tl::expected<Procedure, std::string> OpenProcedure(const ProcedureChoice& choice, const fs::path& cell_yaml,
                                                   const std::optional<config::ToolChoice>& tool) {
  Procedure made{.plan = config::LoadSurgicalPlan(choice.plan),
                 .plan_text = base::ReadText(choice.plan),
                 .file = {},
                 .folder = choice.session,
                 .tool = {},
                 .in_use = {},
                 .tools = {},
                 .recording = {},
                 .mesh = choice.mesh,
                 .guidance = choice.guidance};
  const config::CellConfig cell = config::LoadCell(cell_yaml, tool);
  config::CheckPlanInCell(made.plan, cell, choice.plan, cell_yaml);
  for (const procedure::PlannedTool& reamer : made.plan.plan.tools)
    made.tools.diameters_mm.push_back(1e3 * reamer.diameter_m);
  made.tools.physical = made.plan.plan.tool_change == procedure::ToolChange::kPhysical;
  const std::string plan_checksum = TextChecksum(made.plan_text);
  if (!choice.gain_from.empty()) {
    const auto gain = GainFrom(choice.gain_from, plan_checksum);
    if (!gain) return tl::make_unexpected("--gain-from: " + gain.error());
    made.guidance = *gain;
    fmt::print(stderr, "guidance: a gain of {:g}, by the sessions in {}\n", *gain, choice.gain_from.string());
  }
  if (choice.resume) {
    auto file = ReadSession(choice.session);
    if (!file) return tl::make_unexpected("--resume: " + file.error());
    if (file->plan_checksum != plan_checksum)
      return tl::make_unexpected(fmt::format("--plan {}: found another plan, accepted the session's own, {}",
                                             choice.plan.string(),
                                             (choice.session / file->plan_file).string()));
    if (file->segments.empty())
      return tl::make_unexpected("--resume: the session has not begun: start it anew");
    made.file = std::move(*file);
    made.tools.first = made.file.segments.back().tool_index;
  } else {
    if (std::string wrong = ValidateNewSession(choice.session); !wrong.empty())
      return tl::make_unexpected(std::move(wrong));
    made.file.cell = cell_yaml.stem().string();
    made.file.cell_file = cell_yaml.string();
    made.file.plan_name = made.plan.plan.name;
    made.file.plan_checksum = plan_checksum;
    made.file.tool = cell.tool_file.stem().string();
    made.file.diameters_mm = made.tools.diameters_mm;
    made.file.tool_change = made.tools.physical ? "physical" : "virtual";
    if (!choice.virtual_time)
      made.file.began = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  }
  if (std::string wrong = TakeMesh(choice, cell, made); !wrong.empty())
    return tl::make_unexpected(std::move(wrong));
  std::set<std::string> recordings;
  for (const SessionSegment& segment : made.file.segments) recordings.insert(segment.recording);
  // include recordings that session.json does not name, so that none is overwritten
  const int last = std::max(static_cast<int>(recordings.size()),
                            LastNumber(choice.session, kRecordingPrefix, kRecordingEnding));
  made.recording = fmt::format("{}{}{}", kRecordingPrefix, last + 1, kRecordingEnding);
  const auto reamer = [&](int index) {
    return config::ToolChoice{.file = cell.tool_file,
                              .diameter_m = 1e-3 * made.tools.diameters_mm[static_cast<std::size_t>(index)]};
  };
  made.tool = reamer(0);
  made.in_use = reamer(made.tools.first);
  return made;
}

int ReamerOf(const procedure::SurgicalPlan& plan, const config::CellConfig& cell) {
  const simulation::ToolBall* head = simulation::CuttingHead(cell.tool.tool);
  for (std::size_t i = 0; head && i < plan.tools.size(); ++i)
    if (std::abs(0.5 * plan.tools[i].diameter_m - head->radius_m) < kSameSize_m) return static_cast<int>(i);
  return 0;
}

namespace {

// Sets script and hand for an opening: the script's heights are measured from the rim, the hand is stiffer,
// leads the burrs around the planned circle, and presses with the force of the cell's own script.
// @param first  index of the first tool  @param rim_m  height of the rim over the plan's centre
void LeadBurrs(const procedure::SurgicalPlan& plan, std::size_t first, double rim_m, double push_force_N,
               hil::ProcedureScriptParams& script, hil::OperatorHandParams& hand) {
  script.hand_stiffness_N_per_m *= kFingerRestFactor;
  hand.stiffness_N_per_m *= kFingerRestFactor;
  hand.damping_Ns_per_m *= std::sqrt(kFingerRestFactor);
  script.start_height_m += rim_m;
  script.retract_height_m += rim_m;
  script.approach_m = std::max(0.0, rim_m);
  script.push_force_N = push_force_N;
  script.past_plan_m = kExpertPastPlan_m;
  for (std::size_t i = first; i < plan.tools.size(); ++i)
    script.around_m.push_back(plan.tools[i].around_m > 0.0 ? plan.tools[i].around_m + kLead_m : 0.0);
}

}  // namespace

double RimOver(const procedure::SurgicalPlan& plan, const simulation::CutSite& site) {
  return (Vector3(site.center_m) - plan.centre_m).dot(plan.axis_G);
}

void UseHandOfPlan(const procedure::SurgicalPlan& plan, const std::string& hand, const Pose& X_WG,
                   const simulation::CutSite& site, int first, config::CellConfig& cell) {
  const bool is_opening = plan.kind == procedure::PlanKind::kOpening;
  hil::ProcedureScriptParams script;
  double push_force_N = 0.0;
  std::visit(
      [&](const auto& own) {  // the cell's own script
        push_force_N = own.push_force_N;
        script.head_radius_m = own.head_radius_m;
        script.tool_yaw_rad = own.tool_yaw_rad;
        script.start_height_m = own.start_height_m;
        script.retract_height_m = own.retract_height_m;
        script.hand_stiffness_N_per_m = own.hand_stiffness_N_per_m;
        script.max_target_m_per_s = own.max_target_m_per_s;
        script.approach_force_N = own.approach_force_N;
      },
      cell.script);
  script.X_WC = X_WG * PlanFrame(plan);
  for (std::size_t i = static_cast<std::size_t>(first); i < plan.tools.size(); ++i)
    script.heights_m.push_back(plan.tools[i].height_m);
  if (is_opening)
    LeadBurrs(plan, static_cast<std::size_t>(first), RimOver(plan, site), push_force_N, script,
              cell.simulated.hand);
  script.coupling_N_per_m = cell.servo.coupling.max_stiffness_N_per_m;
  // at an opening even an expert does not watch the plan: the stiff hand leads the burr to its depth
  script.sees_plan = hand != "novice" && !is_opening;
  if (script.sees_plan) {
    script.push_force_N = push_force_N;
    script.last_push_ratio = kExpertLastPush;
  }
  if (hand == "novice" && is_opening) {
    script.tilt_rad = NoviceBurr::kTilt_rad;
    script.aside_m = NoviceBurr::kAside_m;
    for (double& height_m : script.heights_m) height_m -= NoviceBurr::kTooDeep_m;
    script.past_plan_m = NoviceBurr::kPastPlan_m;
    script.push_force_N *= NoviceBurr::kPushFactor;
  } else if (hand == "novice") {
    const Vector3 superior_C = PlanFrame(plan).linear().transpose() * plan.pelvis.superior;
    // turn the script's x axis, along which the hand deviates, to the superior direction; the tool keeps its
    // yaw
    const double turn_rad = std::atan2(superior_C.y(), superior_C.x());
    script.X_WC = Pose(script.X_WC) * Eigen::AngleAxisd(turn_rad, Vector3::UnitZ());
    script.tool_yaw_rad += turn_rad;
    script.tilt_rad = NoviceHand::kTilt_rad;
    script.aside_m = NoviceHand::kAside_m;
    for (double& height_m : script.heights_m) height_m -= NoviceHand::kTooDeep_m;
    script.past_plan_m = NoviceHand::kPastPlan_m;
    script.push_force_N = NoviceHand::kPush_N;
    script.hand_stiffness_N_per_m *= NoviceHand::kStiffnessFactor;
    cell.simulated.hand.stiffness_N_per_m *= NoviceHand::kStiffnessFactor;
    cell.simulated.hand.damping_Ns_per_m *= std::sqrt(NoviceHand::kStiffnessFactor);
  }
  cell.script = script;
}

tl::expected<std::unique_ptr<ProcedureSession>, std::string> MakeSession(
    const Procedure& procedure, const ProcedureChoice& choice, const fs::path& cell_yaml,
    const fs::path& gains, const EngineChoice& engine_choice, bool simulated, bool virtual_time,
    CellSetup& setup, std::unique_ptr<simulation::CuttingEngine>& engine) {
  SessionFile file = procedure.file;
  const std::string cell_checksum = ConfigChecksum(setup.config_source);
  if (file.cell_checksum.empty()) {
    file.cell_checksum = cell_checksum;
    file.scene = setup.bone.name;
    file.clock = virtual_time ? "virtual" : "wall";
    file.gains = GainsOfCell(setup.config.servo);
  } else if (file.cell_checksum != cell_checksum) {
    return tl::make_unexpected(fmt::format("{}: found the cell's checksum {}, accepted the session's, {}",
                                           cell_yaml.string(), cell_checksum, file.cell_checksum));
  }
  ToolList list = procedure.tools;
  for (const procedure::PlannedTool& reamer : procedure.plan.plan.tools) {
    auto guidance = GuidanceOf(procedure.plan.plan, reamer, setup.X_WG);
    if (!guidance) break;  // the plan has none
    guidance->gain = procedure.guidance.value_or(simulated ? 0.0 : guidance->gain);
    list.guidance.push_back(*guidance);
  }
  auto tools = LoadProcedureTools(setup.config, cell_yaml, procedure.tool.file, gains, list);
  PrepareForTools(tools, setup.config);
  KeepToolList(list, setup.config_source);
  if (simulated)
    UseHandOfPlan(procedure.plan.plan, choice.hand, setup.X_WG, setup.bone.site, procedure.tools.first,
                  setup.config);

  std::error_code error;
  fs::create_directories(procedure.folder, error);
  if (error)
    return tl::make_unexpected(procedure.folder.string() + ": cannot make the folder: " + error.message());
  if (!choice.resume) {
    if (const auto written = base::WriteText(procedure.folder / file.plan_file, procedure.plan_text);
        !written)
      return tl::make_unexpected(written.error());
    if (const auto written = WriteSessionBone(procedure.folder, setup.bone); !written)
      return tl::make_unexpected(written.error());
  }
  const simulation::Tool& in_use = tools[static_cast<std::size_t>(procedure.tools.first)].tool;
  if (procedure.tools.first != 0) {
    // the cell's engine was made for the first reamer, but the resumed session continues with a later one
    auto engine_in_use = MakeEngine(engine_choice, setup.bone, in_use, setup.X_WG, setup.config.cutting);
    if (!engine_in_use) return tl::make_unexpected(engine_in_use.error());
    engine = std::move(*engine_in_use);
  }
  const bool physical = procedure.tools.physical;
  ScriptedChanges::Heights heights;
  if (procedure.plan.plan.kind == procedure::PlanKind::kOpening) {
    const double rim_m = RimOver(procedure.plan.plan, setup.bone.site);
    heights = {.down_m = 0.5 * rim_m, .retracted_m = rim_m + kClearOfOpening_m};
  }
  std::optional<procedure::Rubric> rubric;
  std::string without_rubric;
  try {
    rubric = config::LoadRubric(config::ShippedFolder() / "rubrics" /
                                procedure::RubricOf(procedure.plan.plan.kind));
  } catch (const config::ConfigError& wrong) {  // the run goes on without a score
    without_rubric = wrong.what();
  }
  auto session = std::make_unique<ProcedureSession>(ProcedureParams{
      .folder = procedure.folder,
      .plan = procedure.plan.plan,
      .file = std::move(file),
      .tools = std::move(tools),
      .tool = procedure.tools.first,
      .recording = procedure.recording,
      .bone = &setup.bone,
      .solid = setup.solid.get(),
      .events = setup.config.scene.events,
      .X_WG = setup.X_WG,
      .X_GC = PlanFrame(procedure.plan.plan),
      .make_engine =
          [&setup, engine_choice](const simulation::Tool& tool) {
            return MakeEngine(engine_choice, setup.bone, tool, setup.X_WG, setup.config.cutting);
          },
      .confirm_size = physical,
      .confirm_load = physical && setup.config.servo.law == control::Law::kImpedance,
      .period_s = setup.config.servo.period_s,
      .scripted = simulated,
      .scripted_heights = heights,
      .wall_time = !virtual_time,
      .rubric = std::move(rubric),
      .without_rubric = std::move(without_rubric),
      .plan_events = procedure.plan.scene.events});
  if (auto begun = session->Begin(*engine); !begun) return tl::make_unexpected(begun.error());
  return session;
}

}  // namespace osteon::session
