#include "studies/tune/tune_items.h"

#include "studies/sharding/exact_number.h"

namespace osteon::studies {
namespace {

using nlohmann::json;

// Calls visit(name, number) for each number of a StiffHandRun. Run may be const.
template <class Run, class Visit>
void VisitNumbers(Run& c, const Visit& visit) {
  visit("stiffness_N_per_m", c.hand.stiffness_N_per_m);
  visit("damping_Ns_per_m", c.hand.damping_Ns_per_m);
  visit("mass_kg", c.hand.mass_kg);
  visit("max_N", c.run.max_N);
  visit("half_s_N", c.run.half_s_N);
  visit("one_s_N", c.run.one_s_N);
  visit("late_N", c.run.late_N);
  visit("max_index", c.run.max_index);
  visit("late_index", c.run.late_index);
  visit("max_damping", c.run.max_damping);
  visit("mean_damping", c.run.mean_damping);
  visit("calm_N", c.calm_N);
}

}  // namespace

json CheckItem(const TuneCheck& check) { return {{"runs", check.runs}, {"grew", check.grew}}; }

TuneCheck CheckFrom(const json& item) {
  TuneCheck check;
  ReadAt(item, "runs", check.runs);
  ReadAt(item, "grew", check.grew);
  return check;
}

json StiffHandsItem(const std::vector<StiffHandRun>& runs) {
  json list = json::array();
  for (const StiffHandRun& one : runs) {
    json item{{"hand", one.hand.name}, {"contact", one.contact}, {"valid", one.run.valid}};
    VisitNumbers(one, [&](const char* name, double value) { item[name] = ExactNumber(value); });
    list.push_back(std::move(item));
  }
  return list;
}

std::vector<StiffHandRun> StiffHandsFrom(const json& list) {
  std::vector<StiffHandRun> runs;
  for (const json& item : list) {
    StiffHandRun& one = runs.emplace_back();
    ReadAt(item, "hand", one.hand.name);
    ReadAt(item, "contact", one.contact);
    ReadAt(item, "valid", one.run.valid);
    VisitNumbers(one, [&](const char* name, double& value) { ReadAt(item, name, value); });
  }
  return runs;
}

}  // namespace osteon::studies
