#include "studies/assess/assess_result.h"

#include <algorithm>
#include <fstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "base/json_text.h"
#include "base/json_value.h"
#include "base/units.h"
#include "base/write_text.h"
#include "config/reading/load_rubric.h"
#include "session/process/exit_code.h"
#include "session/summary/verdict.h"
#include "studies/assess/assess_page.h"
#include "studies/assess/compare_page.h"

namespace osteon::studies {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using procedure::CupDefinition;

constexpr const char* kResultName = "assess.json";
constexpr const char* kSchema = "osteon.assess/1";
constexpr int kKeyWidth = 40;

Json Triple(const Vector3& v, double scale = 1.0) { return {scale * v.x(), scale * v.y(), scale * v.z()}; }

template <class T>
Json OrNull(const std::optional<T>& value, double scale = 1.0) {
  return value ? Json(scale * *value) : Json();
}

Json AnglesJson(const procedure::SurgicalPlan& plan, const Vector3& axis_G) {
  Json json;
  for (const CupDefinition definition :
       {CupDefinition::kRadiographic, CupDefinition::kOperative, CupDefinition::kAnatomic}) {
    const procedure::CupAngles angles = procedure::AnglesOf(definition, plan.pelvis.FromG(axis_G));
    json[procedure::NameOf(definition)] = {{"inclination_deg", angles.inclination_rad / kDegree},
                                           {"anteversion_deg", angles.anteversion_rad / kDegree}};
  }
  return json;
}

Json ShiftJson(const procedure::AnatomicShift& shift) {
  return {{"medial_mm", 1e3 * shift.medial_m},
          {"superior_mm", 1e3 * shift.superior_m},
          {"posterior_mm", 1e3 * shift.posterior_m}};
}

Json PlanJson(const AssessedSession& session) {
  const procedure::SurgicalPlan& plan = session.plan.plan;
  if (plan.kind == procedure::PlanKind::kOpening)
    return {{"name", plan.name},
            {"kind", "opening"},
            {"target", plan.target},
            {"checksum", session.file.plan_checksum},
            {"axis_G", Triple(plan.axis_G)},
            {"centre_mm", Triple(plan.cavity().centre_m, 1e3)},
            {"width_mm", 2e3 * plan.cavity().opening_radius_m()},
            {"burrs_mm", session.file.diameters_mm}};
  return {{"name", plan.name},
          {"kind", "cup"},
          {"side", procedure::NameOf(plan.side)},
          {"checksum", session.file.plan_checksum},
          {"axis_G", Triple(plan.axis_G)},
          {"angles", AnglesJson(plan, plan.axis_G)},
          {"centre_mm", Triple(plan.cavity().centre_m, 1e3)},
          {"diameter_mm", 2e3 * plan.cavity().radius_m},
          {"reamers_mm", session.file.diameters_mm}};
}

Json OpeningJson(const AssessedSession& session) {
  const procedure::Assessment& found = session.assessment;
  const procedure::CavityResult& cavity = found.cavity;
  Json json;
  if (found.axis_G) json["axis_G"] = Triple(*found.axis_G);
  json["axis_error_deg"] = OrNull(procedure::AxisError(session.plan.plan, found), 1.0 / kDegree);
  json["opening_shift_mm"] = OrNull(found.opening->shift_m, 1e3);
  json["depth_error_mm"] = OrNull(found.opening->depth_error_m, 1e3);
  json["unroofed"] = OrNull(found.opening->unroofed);
  json["removed_mm3"] = 1e9 * cavity.removed_m3;
  json["over_mm3"] = 1e9 * cavity.over_m3;
  json["under_mm3"] = 1e9 * cavity.under_m3;
  json["least_wall_mm"] = OrNull(found.min_wall_m, 1e3);
  json["rim_preserved"] = OrNull(cavity.rim_preserved);
  return json;
}

Json ResultJson(const AssessedSession& session) {
  if (session.assessment.opening) return OpeningJson(session);
  const procedure::SurgicalPlan& plan = session.plan.plan;
  const procedure::Assessment& found = session.assessment;
  const procedure::CavityResult& cavity = found.cavity;
  Json json;
  if (cavity.fit) {
    json["diameter_mm"] = 2e3 * cavity.fit->radius_m;
    json["diameter_sd_mm"] = 2e3 * cavity.fit->radius_sd_m;
    json["centre_mm"] = Triple(cavity.fit->centre_m, 1e3);
    json["depth_sd_mm"] = 1e3 * cavity.fit->depth_sd_m;
    json["cap_deg"] = cavity.fit->cap_rad / kDegree;
    json["form_p95_mm"] = 1e3 * cavity.fit->residual_p95_m;
    json["shift_from_plan"] = ShiftJson(cavity.from_plan);
    json["shift_from_native"] = ShiftJson(cavity.from_native);
  } else {
    json["fit_refused"] = cavity.fit_refused;
  }
  if (found.axis_G) {
    json["axis_G"] = Triple(*found.axis_G);
    json["axis_of"] = found.axis_of_cup ? "cup" : "reamer";
    json["angles"] = AnglesJson(plan, *found.axis_G);
  }
  if (const char* place = CupConePlace(plan, found); *place != '\0') json["cup_cone"] = place;
  json["axis_error_deg"] = OrNull(procedure::AxisError(plan, found), 1.0 / kDegree);
  json["coverage"] = cavity.coverage;
  json["removed_mm3"] = 1e9 * cavity.removed_m3;
  json["over_mm3"] = 1e9 * cavity.over_m3;
  json["under_mm3"] = 1e9 * cavity.under_m3;
  json["cartilage_left"] = OrNull(cavity.cartilage_left);
  json["least_wall_mm"] = OrNull(found.min_wall_m, 1e3);
  json["rim_preserved"] = OrNull(cavity.rim_preserved);
  return json;
}

Json FiguresJson(const procedure::ProcessFigures& figures) {
  return {{"time_s", figures.time_s},
          {"cutting_s", figures.cutting_s},
          {"path_mm", 1e3 * figures.path_m},
          {"force_mean_N", figures.force_mean_N},
          {"force_peak_N", figures.force_peak_N},
          {"wrong_way", figures.wrong_way},
          {"outside_s", figures.outside_s},
          {"tremor_N", figures.tremor_N},
          {"guidance_J", figures.guidance_J}};
}

Json ProcessJson(const AssessedSession& session) {
  Json json = FiguresJson(session.assessment.process);
  json["passes"] = session.passes.size();
  json["guidance_gain"] = session.guidance_gain;
  for (const ToolFigures& tool : session.tools) {
    Json row{{"diameter_mm", tool.diameter_mm}, {"passes", tool.passes}};
    row.update(FiguresJson(tool.figures));
    json["by_tool"].push_back(std::move(row));
  }
  json["by_pass"] = Json::array();
  for (const PassFigures& pass : session.passes) {
    Json row{{"number", pass.pass.number},
             {"diameter_mm", session.file.diameters_mm[static_cast<std::size_t>(pass.pass.tool_index)]},
             {"undone", pass.pass.undone},
             {"removed_mm3", pass.pass.removed_mm3}};
    row.update(FiguresJson(pass.figures));
    json["by_pass"].push_back(std::move(row));
  }
  return json;
}

Json ScoreJson(const AssessResult& result) {
  Json items = Json::array(), deductions = Json::array();
  for (const procedure::ScoredItem& scored : result.score.items) {
    const procedure::Metric& metric = procedure::MetricNamed(scored.item.metric);
    items.push_back({{"metric", scored.item.metric},
                     {"unit", metric.unit},
                     {"value", OrNull(scored.value, metric.to_unit)},
                     {"full", scored.item.full * metric.to_unit},
                     {"zero", scored.item.zero * metric.to_unit},
                     {"weight", scored.item.weight},
                     {"points", scored.points},
                     {"source", scored.item.source}});
  }
  for (const procedure::Deduction& deduction : result.score.deductions)
    deductions.push_back(
        {{"name", deduction.name}, {"points", deduction.points}, {"source", deduction.source}});
  return {{"rubric", result.rubric.name},
          {"total", result.score.total},
          {"items", items},
          {"deductions", deductions}};
}

// Medians of the metrics over sessions of a site's own experts.
tl::expected<Norms, std::string> ReadNorms(const std::vector<fs::path>& folders) {
  std::map<std::string, std::vector<double>> found;
  for (const fs::path& folder : folders) {
    const auto session = ReadAssessedSession(folder);
    if (!session) return tl::make_unexpected("--norms: " + session.error());
    for (const auto& [name, value] : procedure::ValuesOf(session->plan.plan, session->assessment))
      found[name].push_back(value);
  }
  Norms norms;
  for (auto& [name, values] : found) {
    std::ranges::sort(values);
    const std::size_t n = values.size();
    norms[name] = {.median = 0.5 * (values[(n - 1) / 2] + values[n / 2]), .sessions = static_cast<int>(n)};
  }
  return norms;
}

}  // namespace

Unfinished UnfinishedOf(const procedure::SurgicalPlan& plan, std::span<const session::SessionPass> passes) {
  const int last = static_cast<int>(plan.tools.size()) - 1;
  std::optional<double> to_go_mm;
  bool by_a_tool = true;
  for (const session::SessionPass& pass : passes)
    if (!pass.undone && pass.tool_index == last) {
      by_a_tool = false;
      if (pass.to_go_mm) to_go_mm = std::min(to_go_mm.value_or(*pass.to_go_mm), *pass.to_go_mm);
    }
  if (by_a_tool)
    return {
        .text = fmt::format("no pass of its last tool, {:g} mm, counts", 1e3 * plan.tools.back().diameter_m),
        .by_a_tool = true};
  if (!to_go_mm)
    return {.text = "how far its last tool went is not in session.json (`to_go_mm`; an older session)"};
  if (*to_go_mm <= kMaxToGo_mm) return {};
  return {.text = fmt::format("its last tool stopped {:.1f} mm short of its planned depth, accepted {:g} mm",
                              *to_go_mm, kMaxToGo_mm)};
}

namespace {

// Below this share of an item's points, or of the planned cavity, a person should look.
constexpr double kFairShare = 0.5;

// Says how much of the planned cavity is left, where that is most of it; empty: it is not.
std::string LeftOf(const procedure::CavityResult& cavity) {
  const double whole_m3 = cavity.under_m3 + cavity.removed_m3 - cavity.over_m3;
  if (!(cavity.under_m3 > kFairShare * whole_m3)) return "";
  return fmt::format("of the planned cavity {:.0f} of {:.0f} mm³ are left: the last tool is not at its depth",
                     1e9 * cavity.under_m3, 1e9 * whole_m3);
}

// Reads, measures and scores a session.
tl::expected<AssessResult, std::string> Measure(const fs::path& folder, const AssessOptions& options) {
  auto session = ReadAssessedSession(folder);
  if (!session) return tl::make_unexpected(session.error());
  AssessResult result;
  result.session = std::move(*session);
  result.rubric = config::LoadRubric(
      !options.rubric.empty() ? options.rubric
                              : options.rubrics / procedure::RubricOf(result.session.plan.plan.kind));
  result.values = procedure::ValuesOf(result.session.plan.plan, result.session.assessment);
  result.score = procedure::ScoreOf(result.rubric, result.values, result.session.assessment.min_wall_m);
  result.guided = result.session.guidance_gain > 0.0;
  result.pass_at = options.pass_at;
  result.unfinished = UnfinishedOf(result.session.plan.plan, result.session.file.passes);
  if (result.unfinished.text.empty()) result.unfinished.text = LeftOf(result.session.assessment.cavity);
  auto norms = ReadNorms(options.norms);
  if (!norms) return tl::make_unexpected(norms.error());
  result.norms = std::move(*norms);
  return result;
}

// The results of other sessions of the same plan, in folders beside this one, and this one's.
std::vector<TrendPoint> ReadTrend(const AssessResult& result) {
  const fs::path own = fs::weakly_canonical(result.session.folder);
  std::vector<TrendPoint> trend{
      {.session = own.filename().string(), .score = result.score.total, .guided = result.guided}};
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(own.parent_path(), error)) {
    if (entry.path() == own) continue;
    std::ifstream stream(entry.path() / kResultName);
    if (!stream) continue;
    const Json json = Json::parse(stream, nullptr, false);
    const Json &plan = base::ValueAt(json, "plan"), &score = base::ValueAt(json, "score");
    if (base::TextAt(json, "schema") != kSchema ||
        base::TextAt(plan, "checksum") != result.session.file.plan_checksum ||
        base::TextAt(score, "rubric") != result.rubric.name || !base::ValueAt(score, "total").is_number())
      continue;
    trend.push_back({.session = entry.path().filename().string(),
                     .score = base::NumberAt(score, "total"),
                     .guided = base::FlagAt(json, "guided")});
  }
  std::ranges::sort(trend, {}, &TrendPoint::session);
  return trend;
}

// The metric's words for people.
std::string TextOf(const std::string& metric) {
  for (const procedure::Metric& known : procedure::Metrics())
    if (metric == known.name) return known.text;
  return metric;
}

bool Passes(const AssessResult& result, double pass_at) {
  return result.score.total >= pass_at && result.unfinished.text.empty() && result.session.missing.empty();
}

session::Verdict Judge(const AssessResult& result, const std::optional<double>& pass_at) {
  session::Verdict verdict;
  if (!result.unfinished.text.empty())
    verdict.Add(result.unfinished.by_a_tool ? session::VerdictLevel::kBad : session::VerdictLevel::kWarning,
                fmt::format("The plan is not finished: {}. The score says nothing of bone that is left.",
                            result.unfinished.text));
  if (!result.session.missing.empty())
    verdict.Add(session::VerdictLevel::kBad,
                fmt::format("The recordings are not whole: {}. Every figure of the process lacks that.",
                            result.session.missing));
  const auto& min_wall_m = result.session.assessment.min_wall_m;
  if (min_wall_m && *min_wall_m <= 0.0) verdict.Add(session::VerdictLevel::kBad, "A wall is cut through.");
  if (pass_at && result.score.total < *pass_at)
    verdict.Add(session::VerdictLevel::kBad,
                fmt::format("The score is {:.1f}, accepted from {:g} on.", result.score.total, *pass_at));
  if (!result.session.assessment.opening && !result.session.assessment.cavity.fit)
    verdict.Add(session::VerdictLevel::kWarning,
                fmt::format("No sphere was fitted: {}.", result.session.assessment.cavity.fit_refused));
  for (const procedure::ScoredItem& scored : result.score.items)
    if (scored.item.weight > 0.0 && scored.points < kFairShare * scored.item.weight)
      verdict.Add(session::VerdictLevel::kWarning,
                  fmt::format("{}: {:.1f} of {:g} points.", TextOf(scored.item.metric), scored.points,
                              scored.item.weight));
  if (!result.session.file.ended)
    verdict.Add(session::VerdictLevel::kWarning, "The session's last process did not end in order.");
  return verdict;
}

void PrintResult(const AssessResult& result, const session::Verdict& verdict) {
  fmt::print("Osteon assess: {}\n", result.session.folder.string());
  session::PrintVerdict(verdict, kKeyWidth - 1);
  fmt::print("  {:<{}}{:.1f} ({})\n", "Score", kKeyWidth, result.score.total,
             result.guided ? "guided: not to be ranked with sessions without guidance" : "without guidance");
  for (const procedure::ScoredItem& scored : result.score.items) {
    const procedure::Metric& metric = procedure::MetricNamed(scored.item.metric);
    fmt::print(
        "  {:<{}}{}  {:.1f} of {:g} points\n", metric.text, kKeyWidth,
        scored.value ? fmt::format("{:.3g} {}", *scored.value * metric.to_unit, metric.unit) : "not measured",
        scored.points, scored.item.weight);
  }
  for (const procedure::Deduction& deduction : result.score.deductions)
    fmt::print("  {:<{}}-{:g} points\n", deduction.name, kKeyWidth, deduction.points);
}

}  // namespace

Json AssessJson(const AssessResult& result) {
  Json norms = Json::object();
  for (const auto& [name, norm] : result.norms) {
    const procedure::Metric& metric = procedure::MetricNamed(name);
    norms[name] = {
        {"median", norm.median * metric.to_unit}, {"unit", metric.unit}, {"sessions", norm.sessions}};
  }
  return {{"schema", kSchema},
          {"plan", PlanJson(result.session)},
          {"result", ResultJson(result.session)},
          {"process", ProcessJson(result.session)},
          {"score", ScoreJson(result)},
          {"guided", result.guided},
          {"pass_at", OrNull(result.pass_at)},
          {"finished", result.unfinished.text.empty()},
          {"recordings_whole", result.session.missing.empty()},
          {"passed", result.pass_at ? Json(Passes(result, *result.pass_at)) : Json()},
          {"norms", norms}};
}

const char* CupConePlace(const procedure::SurgicalPlan& plan, const procedure::Assessment& found) {
  const procedure::GuidanceGains::CupCone& cone = plan.guidance.cup_cone;
  const auto error_rad = procedure::AxisError(plan, found);
  if (!found.axis_of_cup || !error_rad || !(cone.stop_rad > 0.0)) return "";
  return *error_rad <= cone.free_rad ? "free" : *error_rad <= cone.stop_rad ? "within stop" : "beyond stop";
}

int RunAssess(const AssessOptions& options) {
  auto read = Measure(options.session, options);
  if (!read) return session::Fail("assess", read.error());
  AssessResult& result = *read;
  result.trend = ReadTrend(result);
  std::optional<AssessResult> other;
  if (!options.against.empty()) {
    auto measured = Measure(options.against, options);
    if (!measured) return session::Fail("assess", "--against: " + measured.error());
    if (measured->session.file.plan_checksum != result.session.file.plan_checksum)
      return session::Fail(
          "assess", fmt::format("--against {}: found a session of another plan ({}), accepted one of {}",
                                options.against.string(), measured->session.file.plan_checksum,
                                result.session.file.plan_checksum));
    other = std::move(*measured);
  }

  const session::Verdict verdict = Judge(result, options.pass_at);
  const std::string text = session::ResultText(verdict, AssessJson(result));
  for (const fs::path& file : {options.session / kResultName, options.json})
    if (!file.empty())
      if (const auto written = base::WriteText(file, text); !written)
        return session::Fail("assess", written.error(), session::kFailed);
  const fs::path page = options.session / "assess.html";
  if (const auto written = WriteAssessPage(result, verdict, options.command_line, page); !written)
    return session::Fail("assess", written.error(), session::kFailed);
  if (other)
    if (const auto written = WriteComparison(result, *other, options.command_line, options.session); !written)
      return session::Fail("assess", written.error(), session::kFailed);
  PrintResult(result, verdict);
  if (other) {
    fmt::print("  {:<{}}{:.1f} ({})\n", "Score of the other session", kKeyWidth, other->score.total,
               NameOfSession(other->session));
    fmt::print("comparison: {}\n", (options.session / "compare.html").string());
  }
  fmt::print("report: {}\n", page.string());
  return options.pass_at && !Passes(result, *options.pass_at) ? session::kFailed : 0;
}

}  // namespace osteon::studies
