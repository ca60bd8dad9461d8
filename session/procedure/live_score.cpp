#include "session/procedure/live_score.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "session/procedure/unfinished.h"
#include "session/procedure/wall_watch.h"

namespace osteon::session {
namespace {

// Index of the tool of the last pass that was not undone; empty if there is none.
std::optional<int> LastToolOf(std::span<const SessionPass> passes) {
  std::optional<int> last;
  for (const SessionPass& pass : passes)
    if (!pass.undone) last = pass.tool_index;
  return last;
}

// Whether a metric's value is not known yet: it needs all recordings of the session, or a pass of the last
// tool, which has none yet.
bool IsOpen(const procedure::Metric& metric, bool last_tool_has_cut) {
  switch (metric.known) {
    case procedure::MetricKnown::kWithAnyCut:
      return false;
    case procedure::MetricKnown::kWithRecordings:
      return true;
    case procedure::MetricKnown::kWithLastTool:
      break;
  }
  return !last_tool_has_cut;
}

// Makes an item's row in the message. @param open its value cannot be known yet
nlohmann::json ItemJson(const procedure::ScoredItem& scored, bool open) {
  const procedure::Metric& metric = procedure::MetricNamed(scored.item.metric);
  return {{"metric", scored.item.metric},
          {"text", metric.text},
          {"unit", metric.unit},
          {"value", scored.value ? nlohmann::json(*scored.value * metric.to_unit) : nlohmann::json()},
          {"points", scored.points},
          {"weight", scored.item.weight},
          {"open", open}};
}

}  // namespace

ScoreSoFar ScoreOfNow(const procedure::SurgicalPlan& plan, const procedure::Rubric& rubric,
                      std::span<const SessionPass> passes, const procedure::Assessment& assessment,
                      bool walls_known) {
  const bool last_tool_has_cut = LastToolOf(passes) == static_cast<int>(plan.tools.size()) - 1;
  procedure::MetricValues values = procedure::ValuesOf(plan, assessment);
  std::erase_if(values, [&](const auto& value) {
    return IsOpen(procedure::MetricNamed(value.first), last_tool_has_cut);
  });
  ScoreSoFar now;
  now.score = procedure::ScoreOf(rubric, values, walls_known ? assessment.min_wall_m : std::optional(0.0));
  if (!walls_known)
    for (procedure::Deduction& deduction : now.score.deductions) deduction.name += " (assumed)";
  for (const procedure::ScoredItem& scored : now.score.items) {
    now.open.push_back(!scored.value);
    if (!scored.value) now.open_points += scored.item.weight;
  }
  now.unfinished = UnfinishedOf(plan, passes, assessment.cavity).text;
  return now;
}

void LiveScore::AddFrame(int tool, const simulation::ContactModel& model, double spindle_rad_per_s,
                         bool begins) {
  if (begins) open_ = Trace{};
  if (!cut_.Step(model, spindle_rad_per_s)) return;
  const Pose X_GP = params_.X_WG.inverse() * Pose(model.X_WP);
  // the head's centre lies half a diameter behind the apex, against the feed
  const Vector3 feed = X_GP.linear().col(2);
  const double radius_m = 0.5 * params_.plan.tools[static_cast<std::size_t>(tool)].diameter_m;
  const Vector3 head_m = X_GP.translation() - radius_m * feed;
  open_.axis.Add(feed, std::max(0.0, cut_.removed_m3() - cut_.removed_before_m3()));
  if (open_.heads_m.empty() || (head_m - open_.heads_m.back()).norm() >= kWallStep_m)
    open_.heads_m.push_back(head_m);
}

void LiveScore::EndPass(int number) {
  traces_[number] = std::make_shared<const Trace>(std::exchange(open_, Trace{}));
}

bool LiveScore::SetState(std::shared_ptr<const simulation::CarvedState> state,
                         std::vector<SessionPass> passes, const std::optional<PlainPose>& cup_X_GT,
                         bool guided, rt::Nanoseconds stamp) {
  const std::lock_guard lock(mutex_);
  // with a placed cup the score is always renewed, since the cup may have been placed again in another pose
  if (newest_ && newest_->state == state && newest_->passes.size() == passes.size() &&
      newest_->cup_X_GT.has_value() == cup_X_GT.has_value() && newest_->guided == guided && !cup_X_GT)
    return false;
  newest_ = std::make_shared<const Input>(Input{.state = std::move(state),
                                                .passes = std::move(passes),
                                                .cup_X_GT = cup_X_GT,
                                                .guided = guided,
                                                .stamp = stamp,
                                                .traces = traces_});
  return params_.rubric.has_value();
}

void LiveScore::Update() {
  const std::lock_guard measuring(measuring_);
  std::shared_ptr<const Input> input;
  {
    const std::lock_guard lock(mutex_);
    if (!params_.rubric || !newest_ || newest_ == measured_) return;
    input = newest_;
  }
  ScoreSoFar score = Measure(*input);
  const std::lock_guard lock(mutex_);
  measured_ = std::move(input);
  score_ = std::move(score);
}

ScoreSoFar LiveScore::Measure(const Input& input) const {
  procedure::Assessment assessment;
  procedure::AssessBone(params_.plan, *params_.bone, *input.state, assessment);
  const std::optional<int> last_tool = LastToolOf(input.passes);
  WallWatch walls(*params_.bone, params_.solid, params_.walls);
  procedure::ReamedAxis axis;
  bool traces_known = true, axis_known = true;
  for (const SessionPass& pass : input.passes) {
    if (pass.undone) continue;
    const auto trace = input.traces.find(pass.number);
    if (trace == input.traces.end()) {  // a pass of an earlier process, whose trace was not saved
      traces_known = false;
      axis_known = axis_known && pass.tool_index != last_tool;
      continue;
    }
    if (pass.tool_index == last_tool) axis.Add(trace->second->axis);
    const double radius_m = 0.5 * params_.plan.tools[static_cast<std::size_t>(pass.tool_index)].diameter_m;
    for (const Vector3& head_m : trace->second->heads_m) walls.Add(pass.tool_index, radius_m, head_m);
  }
  if (axis_known) assessment.axis_G = axis.value();
  assessment.min_wall_m = walls.min_wall_m();
  if (input.cup_X_GT) {  // score the placed cup's axis instead of the reamed axis
    assessment.axis_G = -Pose(*input.cup_X_GT).linear().col(2);
    assessment.axis_of_cup = true;
  }
  return ScoreOfNow(params_.plan, *params_.rubric, input.passes, assessment,
                    traces_known || !walls.watches());
}

std::string LiveScore::Json(rt::Nanoseconds now, bool in_pass) const {
  nlohmann::json json{{"type", "score"}, {"known", false}, {"why", params_.without_rubric}};
  const std::lock_guard lock(mutex_);
  if (!measured_) return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  double max_points = 0.0;
  json["items"] = nlohmann::json::array();
  for (std::size_t i = 0; i < score_.score.items.size(); ++i) {
    max_points += score_.score.items[i].item.weight;
    json["items"].push_back(ItemJson(score_.score.items[i], score_.open[i]));
  }
  json["deductions"] = nlohmann::json::array();
  for (const procedure::Deduction& deduction : score_.score.deductions)
    json["deductions"].push_back({{"name", deduction.name}, {"points", deduction.points}});
  json["known"] = true;
  json["rubric"] = params_.rubric->name;
  json["total"] = score_.score.total;
  json["of"] = max_points;
  json["open_points"] = score_.open_points;
  json["unfinished"] = score_.unfinished;
  json["guided"] = measured_->guided;
  json["passes"] = std::ranges::count_if(measured_->passes, [](const auto& pass) { return !pass.undone; });
  json["age_s"] = std::floor(std::max(0.0, rt::ToSeconds(now - measured_->stamp)));
  json["newer"] = in_pass || newest_ != measured_;  // a pass is open, or a newer state is not measured yet
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace osteon::session
