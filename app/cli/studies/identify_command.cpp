#include "app/cli/studies/studies.h"

#include <algorithm>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/cli/usage/cell_file.h"
#include "app/cli/usage/study_commands.h"
#include "app/cli/usage/usage.h"
#include "base/interrupt.h"
#include "session/process/exit_code.h"
#include "studies/identify/identify.h"

namespace osteon::app {
namespace {

class IdentifyCommand final : public Subcommand {
 public:
  explicit IdentifyCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  studies::IdentifyOptions options_;
  std::string cell_;
  std::vector<std::string> runs_{"noise", "free", "validate"}, axes_{"x", "y", "z"};
  std::vector<double> speeds_mm_per_s_{10.0, 50.0}, joint_speeds_deg_per_s_{8.6};
};

IdentifyCommand::IdentifyCommand(CLI::App& app) : Subcommand(AddStudy(app, "identify")) {
  sub_->add_option("cell", cell_, "a name under cells/, or a cell's YAML file")
      ->type_name("CELL")
      ->required();
  sub_->add_flag("--simulated", options_.simulated,
                 "move the simulated cell, in virtual time, instead of the connected arm");
  sub_->add_flag(
      "--wall-time", options_.wall_time,
      "with --simulated: in wall time, the simulated arm and devices at the other end of their real "
      "wires on loopback");
  sub_->add_option("--table", options_.table_seeds,
                   "move and read nothing: fit synthetic recordings of the cell's simulated arm with so many "
                   "seeds, and say how well arm and stability boundaries are found")
      ->type_name("SEEDS")
      ->check(NumberWithin(2, 1000));
  sub_->add_option("--do", runs_,
                   "runs: noise (60 s at rest), free (64 s for each axis and speed), validate (16 s), held "
                   "(64 s, with a hand at the handle), tremor (30 s at rest, with a hand at the handle), "
                   "joints (24 s for each joint and speed)")
      ->type_name("RUN,…")
      ->delimiter(',')
      ->check(CLI::IsMember({"noise", "free", "validate", "held", "tremor", "joints"}))
      ->capture_default_str();
  sub_->add_option("--axes", axes_, "axes of the tool's frame at the start along which the arm is moved")
      ->type_name("AXIS,…")
      ->delimiter(',')
      ->check(CLI::IsMember({"x", "y", "z"}))
      ->capture_default_str();
  sub_->add_option("--speeds", speeds_mm_per_s_, "peak speeds of the tool, in mm/s")
      ->type_name("SPEED,…")
      ->delimiter(',')
      ->check(NumberWithin(1.0, 100.0))
      ->capture_default_str();
  sub_->add_option("--joints", options_.joints,
                   "with --do joints: the joints that are moved, one after another, by their numbers; "
                   "without it all of the arm")
      ->type_name("JOINT,…")
      ->delimiter(',')
      ->check(CLI::IsMember({1, 2, 3, 4, 5, 6, 7}));
  sub_->add_option("--joint-speeds", joint_speeds_deg_per_s_,
                   "with --do joints: peak speeds of a joint, in deg/s; at most 20 % of its own are used")
      ->type_name("SPEED,…")
      ->delimiter(',')
      ->check(NumberWithin(0.1, 50.0))
      ->capture_default_str();
  sub_->add_option(
          "--recording", options_.recordings,
          "estimate from these recordings and move nothing; one without excitation gives total lag only")
      ->type_name("FILE")
      ->check(CLI::ExistingFile);
  sub_->add_option("--validate", options_.validations, "recordings of validation runs, with --recording")
      ->type_name("FILE")
      ->check(CLI::ExistingFile);
  sub_->add_option("--out", options_.out,
                   "folder for recordings, identified.yaml, identify.json and identify.html")
      ->type_name("FOLDER")
      ->capture_default_str();
  sub_->add_option("--json", options_.json, "also write the figures there, as JSON")->type_name("FILE");
  sub_->footer(
      "The arm goes to its start and is held there. Then the tool moves by up to 4 mm along one axis at a "
      "time, or one joint by up to 1 degree. Nobody holds the handle. Release the enabling switch to "
      "pause.\n\n"
      "Exit code 1: the data were refused, and identified.yaml was not written\n\n"
      "Examples:\n  osteon identify demo --simulated --axes z --speeds 50\n"
      "  osteon identify my_cell.yaml --out identify\n"
      "  osteon identify my_cell.yaml --recording identify/free_z_50.mcap --validate "
      "identify/validate_z_50.mcap");
}

int IdentifyCommand::Run(const Invocation& invocation) {
  const auto refuse = [](const std::string& what) { return session::Fail("identify", what); };
  const auto has = [this](const char* run) { return std::ranges::find(runs_, run) != runs_.end(); };
  if (!options_.validations.empty() && options_.recordings.empty())
    return refuse("found --validate without --recording, accepted both");
  if (options_.wall_time && !options_.simulated)
    return refuse("found --wall-time without --simulated, accepted both");
  if (options_.simulated && !options_.recordings.empty())
    return refuse("found --simulated with --recording, accepted one of them: recordings move nothing");
  if (has("validate") && !has("free")) return refuse("found --do validate without free, accepted both");
  const auto found = FindCell(invocation.config_root, cell_);
  if (!found) return refuse(found.error());
  options_.cell = *found;
  options_.runs = {.noise = has("noise"),
                   .free = has("free"),
                   .validate = has("validate"),
                   .held = has("held"),
                   .tremor = has("tremor"),
                   .joints = has("joints")};
  options_.axes.clear();
  for (const std::string& axis : axes_)
    if (options_.axes.find(axis) == std::string::npos) options_.axes += axis;
  options_.speeds_m_per_s.clear();
  // The name of a recording contains the speed, so each speed is used only once.
  std::set<std::string> names;
  for (const double speed : speeds_mm_per_s_)
    if (names.insert(fmt::format("{:g}", speed)).second) options_.speeds_m_per_s.push_back(1e-3 * speed);
  if ((sub_->count("--joints") > 0 || sub_->count("--joint-speeds") > 0) && !options_.runs.joints)
    return refuse("found --joints or --joint-speeds without --do joints, accepted both");
  std::ranges::sort(options_.joints);
  const auto repeated = std::ranges::unique(options_.joints);
  options_.joints.erase(repeated.begin(), repeated.end());
  options_.joint_speeds_rad_per_s.clear();
  names.clear();
  for (const double speed : joint_speeds_deg_per_s_)
    if (names.insert(fmt::format("{:g}", speed)).second)
      options_.joint_speeds_rad_per_s.push_back(speed * std::numbers::pi / 180.0);
  base::InstallInterrupt();
  options_.stop = &base::Interrupted();
  options_.command_line = invocation.command_line;
  return studies::RunIdentify(options_);
}

}  // namespace

void AddIdentifyCommand(CLI::App& app, Subcommands& all) {
  all.push_back(std::make_unique<IdentifyCommand>(app));
}

}  // namespace osteon::app
