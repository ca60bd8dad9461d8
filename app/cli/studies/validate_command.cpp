#include "app/cli/studies/studies.h"

#include <string>

#include "app/cli/usage/study_commands.h"
#include "studies/validate/validate.h"

namespace osteon::app {
namespace {

class ValidateCommand final : public Subcommand {
 public:
  explicit ValidateCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  studies::ValidateOptions options_;
};

ValidateCommand::ValidateCommand(CLI::App& app) : Subcommand(AddStudy(app, "validate")) {
  sub_->add_option("--rows", options_.rows,
                   "rows by number or id, such as 9 or 9-1000; without any, all of them")
      ->type_name("ROW");
  sub_->add_option("--json", options_.json, "also write the rows there, as JSON")->type_name("FILE");
  sub_->add_option("--out", options_.out, "folder for validate.html and validate.svg")->type_name("FOLDER");
  sub_->add_flag("--quick", options_.quick,
                 "coarse bones and short runs, as in the tests: seconds instead of minutes");
  sub_->footer(
      "Runs shipped cells, tools and materials in virtual time beside published experiments. A row that "
      "misses is shown as a miss, with what shows the reason (docs/validation.md).\n\n"
      "Exit code 1: a row has no result, or a file could not be written\n\n"
      "Examples:\n  osteon validate\n  osteon validate --json validate.json --out validate\n"
      "  osteon validate --rows 9 14-depth");
}

int ValidateCommand::Run(const Invocation& invocation) {
  options_.config_root = invocation.config_root;
  options_.command_line = invocation.command_line;
  return studies::RunValidate(options_);
}

}  // namespace

void AddValidateCommand(CLI::App& app, Subcommands& all) {
  all.push_back(std::make_unique<ValidateCommand>(app));
}

}  // namespace osteon::app
