#include "app/cli/run/procedure_options.h"

#include "app/cli/usage/plan_file.h"
#include "app/cli/usage/usage.h"

namespace osteon::app {

void ProcedureOptions::Add(CLI::App& sub, bool with_session) {
  CLI::Option* plan =
      sub.add_option(
             "--plan", plan_,
             std::string("a surgical plan, whose tools ") +
                 (with_session ? "are used in turn"
                               : "the simulated operator uses in turn, from the first one or --tool's on") +
                 ": a name under plans/, or a YAML file")
          ->type_name("PLAN");
  if (with_session) {
    CLI::Option* session =
        sub.add_option("--session", session_,
                       "folder for the session of the plan: recordings, saved states, session.json")
            ->type_name("FOLDER")
            ->needs(plan);
    sub.add_flag("--resume", resume_, "continue the session from its last saved state")->needs(session);
    CLI::Option* guidance =
        sub.add_option(
               "--guidance", guidance_,
               "gain of the plan's guidance; without it the plan's, and none for a simulated operator")
            ->check(NumberWithin(0, 1))
            ->needs(plan);
    sub.add_option(
           "--gain-from", gain_from_,
           "folder of a trainee's sessions: the guidance's gain is 1, and 0.25 less for each session of "
           "the plan that passed (assess --pass-at)")
        ->type_name("FOLDER")
        ->needs(plan)
        ->excludes(guidance);
  }
  sub.add_option("--operator", hand_,
                 "hand of the simulated operator with a plan: expert keeps to it, novice is 14 degrees "
                 "tilted, aims 6 mm aside and 5 mm too deep, and presses hard")
      ->check(CLI::IsMember({"expert", "novice"}))
      ->capture_default_str()
      ->needs(plan);
}

std::string ProcedureOptions::ReadInto(const std::filesystem::path& config_root,
                                       session::ProcedureChoice& choice) const {
  if (!asked()) return "";
  const auto found = FindPlan(config_root, plan_);
  if (!found) return "--plan " + found.error();
  choice = {.plan = *found,
            .session = session_,
            .resume = resume_,
            .hand = hand_,
            .guidance = guidance_,
            .gain_from = gain_from_};
  return "";
}

}  // namespace osteon::app
