#include "app/cli/studies/studies.h"

#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/cli/usage/cell_file.h"
#include "app/cli/usage/study_commands.h"
#include "app/cli/usage/usage.h"
#include "session/process/exit_code.h"
#include "studies/capability/capability.h"

namespace osteon::app {
namespace {

class CapabilityCommand final : public Subcommand {
 public:
  explicit CapabilityCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  studies::CapabilityOptions options_;
  std::string cell_, mount_{"cell"};
  std::vector<double> x_mm_, y_mm_, z_mm_;
  bool no_search_{false};
};

CapabilityCommand::CapabilityCommand(CLI::App& app) : Subcommand(AddStudy(app, "capability")) {
  sub_->add_option("cell", cell_, "a name under cells/, or a cell's YAML file")
      ->type_name("CELL")
      ->required();
  sub_->add_option("--out", options_.out, "folder for capability.html, .json, .csv, pictures and base.yaml")
      ->type_name("FOLDER")
      ->capture_default_str();
  sub_->add_option("--json", options_.json, "write a further copy of capability.json there")
      ->type_name("FILE");
  sub_->add_option("--identified", options_.identified,
                   "a file of `osteon identify` for this cell: sensor and arm as they were measured")
      ->type_name("FILE")
      ->check(CLI::ExistingFile);
  const auto need = [](CLI::Option* option) { return option->group("What is needed"); };
  need(sub_->add_option("--axial-N", options_.axial_N,
                        "force along the tool; without it the cell's force limit")
           ->check(NumberWithin(1, 1000)));
  auto* lateral = need(sub_->add_option("--lateral-N", options_.lateral_N,
                                        "force across the tool at the same time; without it the axial force "
                                        "times the sine of the script's tilt")
                           ->check(NumberWithin(0, 1000)));
  need(sub_->add_option("--recording", options_.recording,
                        "a run's recording.mcap: use the share of lateral force that its tool needed")
           ->type_name("FILE")
           ->check(CLI::ExistingFile)
           ->excludes(lateral));
  need(sub_->add_option("--torque-Nm", options_.torque_Nm, "torque about any axis at the same time")
           ->check(NumberWithin(0, 100))
           ->capture_default_str());
  need(sub_->add_option(
               "--radius-mm", options_.radius_mm,
               "radius of the working volume about the site's axis; without it the radius of the tool's head")
           ->check(NumberWithin(0, 500)));
  const auto base = [](CLI::Option* option) { return option->group("Where the base may stand"); };
  for (const auto& [name, values] : {std::pair{"--x-mm", &x_mm_}, {"--y-mm", &y_mm_}, {"--z-mm", &z_mm_}})
    base(sub_->add_option(name, *values,
                          "range of the base in world coordinates; without it around the site, as far as the "
                          "arm reaches")
             ->type_name("FROM,TO")
             ->delimiter(',')
             ->expected(2)
             ->check(NumberWithin(-5000, 5000)));
  base(sub_->add_option("--mount", mount_,
                        "floor: upright; ceiling: hanging; cell: as the cell's base is mounted")
           ->check(OneOf({"cell", "floor", "ceiling"}))
           ->capture_default_str());
  base(sub_->add_option("--clearance-mm", options_.clearance_mm,
                        "least distance of the base's axis from the site's centre")
           ->check(NumberWithin(0, 3000))
           ->capture_default_str());
  base(sub_->add_option("--joint-margin-deg", options_.joint_margin_deg,
                        "least distance from every joint limit")
           ->check(NumberWithin(0, 60))
           ->capture_default_str());
  base(sub_->add_flag("--no-search", no_search_, "only map the force; do not search a place for the base"));
  sub_->add_option("--nodes", options_.nodes, "nodes of a map across the workspace")
      ->check(NumberWithin(3, 201))
      ->capture_default_str();
  sub_->add_option("--threads", options_.threads, "number of threads; the result does not depend on it")
      ->check(NumberWithin(1, 256))
      ->capture_default_str();
  sub_->footer(
      "Exit code 1: a file could not be written\n\n"
      "Examples:\n  osteon capability config/cells/demo.yaml\n  osteon capability demo --out my_cell "
      "--radius-mm 60\n"
      "  osteon capability demo --recording demo_out/recording.mcap\n"
      "  osteon capability demo --identified identify/identified.yaml\n"
      "  osteon capability demo --mount ceiling --z-mm 900,1500 --x-mm 0,1200");
}

int CapabilityCommand::Run(const Invocation& invocation) {
  options_.command_line = invocation.command_line;
  options_.search = !no_search_;
  options_.mount = mount_ == "floor"     ? studies::Mount::kFloor
                   : mount_ == "ceiling" ? studies::Mount::kCeiling
                                         : studies::Mount::kCell;
  for (const auto& [name, values, range] : {std::tuple{"--x-mm", &x_mm_, &options_.x_mm},
                                            {"--y-mm", &y_mm_, &options_.y_mm},
                                            {"--z-mm", &z_mm_, &options_.z_mm}}) {
    if (values->empty()) continue;
    if (values->front() > values->back())
      return session::Fail("capability", fmt::format("{}: found {:g},{:g}, accepted FROM at most TO", name,
                                                     values->front(), values->back()));
    *range = {values->front(), values->back()};
  }
  const auto found = FindCell(invocation.config_root, cell_);
  if (!found) return session::Fail("capability", found.error());
  options_.cell = *found;
  return studies::RunCapability(options_);
}

}  // namespace

void AddCapabilityCommand(CLI::App& app, Subcommands& all) {
  all.push_back(std::make_unique<CapabilityCommand>(app));
}

}  // namespace osteon::app
