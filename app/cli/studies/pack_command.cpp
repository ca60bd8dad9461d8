#include "app/cli/studies/studies.h"

#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/cli/usage/study_commands.h"
#include "app/cli/usage/usage.h"
#include "session/planning/pack_source.h"
#include "session/process/exit_code.h"
#include "session/setup/cell_setup.h"
#include "studies/pack/pack.h"

namespace osteon::app {
namespace {

class PackCommand final : public Subcommand {
 public:
  explicit PackCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  // Values that are texts on the command line and have other types in PackOptions.
  struct Texts {
    std::string mode{"overlap"}, cup, region;
    std::vector<std::string> path;
  };

  // Converts texts_ into options_. @returns what is wrong with the first bad text; empty if none is.
  [[nodiscard]] std::string Read();

  studies::PackOptions options_;
  Texts texts_;
};

PackCommand::PackCommand(CLI::App& app) : Subcommand(AddStudy(app, "pack")) {
  sub_->add_option("input", options_.source.input,
                   "a closed mesh (.stl, .obj, .ply, in mm); a scene, by name or YAML file; ball:R or "
                   "box:X,Y,Z (mm); or a packing (.osp) to convert")
      ->type_name("SCENE")
      ->required();
  sub_->add_option(
          "-o,--out", options_.outputs,
          "FILE.osp: the packing; FILE.ply or FILE.csv: its spheres alone; may be given several times")
      ->type_name("FILE")
      ->required()
      ->expected(1)
      ->take_all();
  const auto packing = [&](CLI::Option* option) { return option->group("Packing"); };
  packing(sub_->add_option("--mode", texts_.mode,
                           "overlap: spheres may overlap, for cutting; disjoint: they may not")
              ->check(OneOf({"overlap", "disjoint"}))
              ->capture_default_str());
  packing(sub_->add_option("--count", options_.count,
                           "number of spheres; without it as many as a surface gap of 0.08 mm needs, or 10 "
                           "000 disjoint ones")
              ->check(NumberWithin(1, 100e6)));
  packing(
      sub_->add_option("--r-min-mm", options_.r_min_mm, "smallest radius")->check(NumberWithin(0.001, 100)));
  packing(sub_->add_option("--r-max-mm", options_.r_max_mm, "largest radius in the cut zone")
              ->check(NumberWithin(0.001, 500)));
  packing(sub_->add_option("--grade", options_.grade,
                           "growth of the largest radius for each mm of depth below the cut zone, in mm")
              ->check(NumberWithin(0, 100)));
  packing(
      sub_->add_option("--seed", options_.seed,
                       "seed of the random numbers; another seed gives another packing of the same quality")
          ->capture_default_str());
  packing(sub_->add_option("--threads", options_.threads,
                           "number of threads; 0: one for each core. The result does not depend on it")
              ->check(NumberWithin(0, 1024))
              ->capture_default_str());
  packing(sub_->add_flag("--points,!--no-points", options_.points,
                         "add mass points to the spheres, or leave them out; by default they are added"));
  packing(sub_->add_option("--point-spacing-mm", options_.point_spacing_mm,
                           "mean spacing of the mass points where they are finest")
              ->check(NumberWithin(0.02, 20)));
  const auto mesh = [](CLI::Option* option) { return option->group("Mesh and site"); };
  mesh(sub_->add_option("--scale", options_.source.scale, "mm for each unit of the mesh file")
           ->check(NumberWithin(1e-6, 1e6)));
  mesh(sub_->add_option("--scene", options_.source.scene,
                        "scene whose bone the mesh replaces: gives the tissue and, with --cup, the cut zone; "
                        "without it acetabulum")
           ->type_name("SCENE"));
  mesh(sub_->add_option("--materials", options_.source.materials, "YAML file with the materials")
           ->type_name("FILE"));
  auto* cup =
      mesh(sub_->add_option("--cup", texts_.cup,
                            "the cup, or the entry of a drill: centre, axis out of the bone, radius; mm")
               ->type_name("X,Y,Z,NX,NY,NZ,R"));
  auto* region = mesh(
      sub_->add_option("--region", texts_.region, "ball within which the surface is cut: centre, radius; mm")
          ->type_name("X,Y,Z,R"));
  auto* path =
      mesh(sub_->add_option("--path", texts_.path,
                            "path of the cut, a CSV file with x_mm,y_mm,z_mm, and the tool's radius in mm")
               ->type_name("FILE R")
               ->expected(2));
  region->excludes(path);
  path->excludes(region);
  static_cast<void>(cup);
  sub_->add_option("--report", options_.report, "folder for report.html")->type_name("FOLDER");
  sub_->add_option("--json", options_.json, "also write the figures there, as JSON")->type_name("FILE");
  sub_->footer(
      "Exit code 1: the packing protrudes or overlaps more than accepted, or a file could not be written\n\n"
      "Examples:\n  osteon pack hip.obj -o hip.osp --report hip_report\n"
      "  osteon pack hip.obj -o hip.osp --cup 8.8,-131.9,517.9,-0.983,-0.175,0.052,21 --count 25000 --grade "
      "0.3\n"
      "  osteon pack tooth.obj -o tooth.osp --scene molar --count 36000\n"
      "  osteon pack acetabulum -o acetabulum.osp\n"
      "  osteon pack ball:20 -o ball.ply --mode disjoint --count 5000\n"
      "  osteon pack hip.osp -o hip.ply -o hip.csv");
}

std::string PackCommand::Read() {
  options_.disjoint = texts_.mode == "disjoint";
  if (sub_->count("--cup") > 0) {
    const auto parsed = session::ParseCup(texts_.cup);
    if (!parsed) return parsed.error();
    options_.source.cup = *parsed;
  }
  if (sub_->count("--region") > 0) {
    const auto parsed = session::ParseRegion(texts_.region);
    if (!parsed) return parsed.error();
    options_.source.region = *parsed;
  }
  if (sub_->count("--path") > 0) {
    const auto radius = session::ParseNumbers(texts_.path[1], 1, "--path: R");
    if (!radius) return radius.error();
    if (!(radius->front() >= 0.1 && radius->front() <= 100.0))
      return fmt::format("--path: R: found {} mm, accepted 0.1 … 100", radius->front());
    options_.source.path = {.file = texts_.path[0], .radius_m = 1e-3 * radius->front()};
  }
  options_.source.graded = options_.grade.value_or(0.0) > 0.0;
  // Store the names of the given options that determine the packing. --threads does not change it.
  for (const CLI::Option* option : sub_->get_options())
    if (option->count() > 0 && (option->get_group() == "Packing" || option->get_group() == "Mesh and site") &&
        option->get_name() != "--threads")
      options_.packing_options.push_back(option->get_name());
  return "";
}

int PackCommand::Run(const Invocation& invocation) {
  options_.command_line = invocation.command_line;
  options_.source.config_root = invocation.config_root;
  if (const std::string wrong = Read(); !wrong.empty()) return session::Fail("pack", wrong);
  return studies::RunPack(options_);
}

}  // namespace

void AddPackCommand(CLI::App& app, Subcommands& all) { all.push_back(std::make_unique<PackCommand>(app)); }

}  // namespace osteon::app
