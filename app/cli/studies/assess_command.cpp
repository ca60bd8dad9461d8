#include "app/cli/studies/studies.h"

#include <string>

#include <fmt/format.h>

#include "app/cli/usage/study_commands.h"
#include "app/cli/usage/usage.h"
#include "config/reading/named_file.h"
#include "session/process/exit_code.h"
#include "studies/assess/assess_result.h"

namespace osteon::app {
namespace {

class AssessCommand final : public Subcommand {
 public:
  explicit AssessCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  studies::AssessOptions options_;
  std::string rubric_;
};

AssessCommand::AssessCommand(CLI::App& app) : Subcommand(AddStudy(app, "assess")) {
  sub_->add_option("session", options_.session, "the folder of a session")->type_name("FOLDER")->required();
  sub_->add_option("--rubric", rubric_,
                   "norms and points: a name under rubrics/, or a YAML file; without it rubric for a cup, "
                   "opening for an opening")
      ->type_name("RUBRIC");
  sub_->add_option("--pass-at", options_.pass_at,
                   "exit code 1 below this score, and where the plan is not finished")
      ->check(NumberWithin(0, 100));
  sub_->add_option(
          "--norms", options_.norms,
          "finished sessions of experts at the same site, with guidance if this one has it, without if not: "
          "their medians stand beside each figure")
      ->type_name("FOLDER")
      ->check(CLI::ExistingDirectory);
  sub_->add_option(
          "--against", options_.against,
          "another session of the plan, beside this one in compare.html and compare.png; a guided one is "
          "marked and not ranked with one that was not")
      ->type_name("FOLDER")
      ->check(CLI::ExistingDirectory);
  sub_->add_option(
          "--trend", options_.trend,
          "further assessed sessions of the plan for the trend, beside those in folders beside this one")
      ->type_name("FOLDER")
      ->check(CLI::ExistingDirectory);
  sub_->add_option("--json", options_.json, "also write the result there, as JSON")->type_name("FILE");
  sub_->footer(
      "Writes assess.html, assess.json and trend.csv into the folder. The trend has the results of the same "
      "plan and rubric in the folders beside it, in the order in which the sessions began.\n\n"
      "Exit code 1: the score is below --pass-at, or the plan is not finished with it\n\n"
      "Examples:\n  osteon assess session_1\n  osteon assess session_1 --pass-at 70 --norms expert_1 "
      "expert_2\n  osteon assess expert/session --against novice/session");
}

int AssessCommand::Run(const Invocation& invocation) {
  const std::filesystem::path rubrics = invocation.config_root / "rubrics";
  options_.rubrics = rubrics;
  if (!rubric_.empty()) {
    const auto rubric = config::FindNamedFile(rubrics, rubric_);
    if (!rubric)
      return session::Fail("assess", fmt::format("--rubric: found {}, accepted a YAML file, or one of {}: {}",
                                                 rubric_, rubrics.string(), config::YamlNamesIn(rubrics)));
    options_.rubric = *rubric;
  }
  options_.command_line = invocation.command_line;
  return studies::RunAssess(options_);
}

}  // namespace

void AddAssessCommand(CLI::App& app, Subcommands& all) {
  all.push_back(std::make_unique<AssessCommand>(app));
}

}  // namespace osteon::app
