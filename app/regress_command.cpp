#include "app/regress_command.h"

#include "app/usage.h"

namespace osteon::app {

RegressCommand::RegressCommand(CLI::App& app)
    : sub_(app.add_subcommand("regress",
                              "runs scenarios in virtual time and holds them against their golden traces")) {
  RegressOptions& o = options_;
  sub_->add_option("scenarios", o.scenarios,
                   "YAML files, folders of them, or names under scenarios/; without any, all of scenarios/");
  sub_->add_option("--junit", o.junit, "write the verdicts there, for a CI server");
  sub_->add_option("--json", o.json, "write the figures there");
  sub_->add_option("--out", o.out, "folder for regress.html, written where something differs")
      ->capture_default_str();
  sub_->add_flag("--exact", o.exact,
                 "a bit that differs fails: for the compiler and processor that the golden traces are from");
  auto* set =
      sub_->add_option(
              "--set", o.set,
              "KEY=VALUE, laid over every scenario's cell, e.g. limits.max_force_N=150; several times")
          ->expected(1)
          ->take_all();
  auto* update = sub_->add_flag(
      "--update", o.update,
      "what does not pass, or comes of files that have changed, is the golden trace from now on");
  update->excludes(set);
  sub_->add_flag("--all", o.all, "with --update: all scenarios, without their names")->needs(update);
  sub_->add_option("--reason", o.reason, "why that is right: it is written into the golden traces' heads");
  sub_->add_option("--jobs", o.jobs, "scenarios at a time; 0: one a core. The result does not depend on it")
      ->check(NumberWithin(0, 1024))
      ->capture_default_str();
  sub_->add_option("--device", o.device, "part of a Vulkan device's name, for scenarios of engine vulkan");
  sub_->footer(
      "A scenario passes where every sampled quantity is within its tolerance of the golden trace and every "
      "event comes at its "
      "tick.\nWhether every bit is the same stands beside it: another compiler or processor may round "
      "otherwise.\n"
      "Exit code 1: a scenario differs, can not be run, or has no golden trace.\n\n"
      "Examples:\n  osteon regress\n  osteon regress --junit regress.xml --json regress.json\n"
      "  osteon regress reaming_lbr my_scenarios/wall.yaml\n"
      "  osteon regress reaming_lbr --set coupling.stiffness_N_per_mm=20.2\n"
      "  osteon regress reaming_lbr --update --reason \"the reamer's mass was weighed anew\"");
}

int RegressCommand::Run(const std::filesystem::path& config_root, const std::string& command_line) {
  options_.config_root = config_root;
  options_.command_line = command_line;
  return RunRegress(options_);
}

}  // namespace osteon::app
