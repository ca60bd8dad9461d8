#include "studies/assess/assess_result.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/json_text.h"
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

constexpr int kKeyWidth = 40;  // width of the column of printed names [characters]

// A vector's three coordinates, multiplied by a scale that converts the unit.
Json Triple(const Vector3& v, double scale = 1.0) { return {scale * v.x(), scale * v.y(), scale * v.z()}; }

template <class T>
Json OrNull(const std::optional<T>& value, double scale = 1.0) {
  return value ? Json(scale * *value) : Json();
}

// The angles of an axis by each of the three definitions.
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

// If an item gets less than this share of its points, the verdict warns of it.
constexpr double kFairShare = 0.5;

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
  result.guided = result.session.guided();
  result.pass_at = options.pass_at;
  result.unfinished = UnfinishedOf(result.session);
  return result;
}

// The metric's text as pages show it; for an unknown metric, its key.
std::string TextOf(const std::string& metric) {
  for (const procedure::Metric& known : procedure::Metrics())
    if (metric == known.name) return known.text;
  return metric;
}

// Whether the session's score is at least pass_at, the session is finished, and its recordings are complete.
bool Passes(const AssessResult& result, double pass_at) {
  return result.score.total >= pass_at && result.unfinished.text.empty() && result.session.missing.empty();
}

// Finds faults and warnings that a reader should know in addition to the score.
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
             GuidanceText(result.session) +
                 (result.guided ? ": not to be ranked with sessions without guidance" : ""));
  for (const procedure::ScoredItem& scored : result.score.items) {
    const procedure::Metric& metric = procedure::MetricNamed(scored.item.metric);
    fmt::print("  {:<{}}{}  {}\n", metric.text, kKeyWidth,
               scored.value ? ValueText(*scored.value, metric) : "not measured",
               scored.item.weight > 0.0
                   ? fmt::format("{:.1f} of {:g} points", scored.points, scored.item.weight)
                   : "shown, not scored");
  }
  for (const procedure::Deduction& deduction : result.score.deductions)
    fmt::print("  {:<{}}-{:g} points\n", deduction.name, kKeyWidth, deduction.points);
}

void PrintComparison(const AssessResult& result, const AssessResult& other, const fs::path& page) {
  fmt::print("  {:<{}}{:.1f} ({}, {})\n", "Score of the other session", kKeyWidth, other.score.total,
             NameOfSession(other.session), MarkOf(other));
  if (const std::string why = WhyNotRanked(result, other); !why.empty()) fmt::print("{}\n", why);
  fmt::print("comparison: {}\n", page.string());
}

Json PublishedJson(const procedure::Assessment& assessment) {
  Json rows = Json::array();
  const auto spread = [](const procedure::MeanAndSpread& s) {
    return Json{{"mean_mm", 1e3 * s.mean_m}, {"sd_mm", 1e3 * s.sd_m}};
  };
  for (const procedure::PublishedShift& shift : procedure::PublishedShifts(assessment))
    rows.push_back({{"shift", shift.direction},
                    {"value_mm", 1e3 * shift.value_m},
                    {"peripheral_reaming", spread(shift.peripheral)},
                    {"standard_reaming", spread(shift.standard)},
                    {"source", shift.source}});
  return rows;
}

Json TrendJson(const Trend& trend) {
  Json points = Json::array();
  for (const TrendPoint& point : trend.points)
    points.push_back({{"session", point.session},
                      {"began", point.began.empty() ? Json() : Json(point.began)},
                      {"score", point.score},
                      {"guided", point.guided},
                      {"finished", point.finished ? Json(*point.finished) : Json()}});
  return points;
}

}  // namespace

Json AssessJson(const AssessResult& result) {
  Json norms = Json::object();
  for (const auto& [name, norm] : result.norms) {
    const procedure::Metric& metric = procedure::MetricNamed(name);
    norms[name] = {
        {"median", norm.median * metric.to_unit}, {"unit", metric.unit}, {"sessions", norm.sessions}};
  }
  return {{"schema", kAssessSchema},
          {"plan", PlanJson(result.session)},
          {"result", ResultJson(result.session)},
          {"process", ProcessJson(result.session)},
          {"score", ScoreJson(result)},
          {"guided", result.guided},
          {"began", result.session.file.began.empty() ? Json() : Json(result.session.file.began)},
          {"pass_at", OrNull(result.pass_at)},
          {"finished", result.unfinished.text.empty()},
          {"recordings_whole", result.session.missing.empty()},
          {"passed", result.pass_at ? Json(Passes(result, *result.pass_at)) : Json()},
          {"norms", norms},
          {"published", PublishedJson(result.session.assessment)},
          {"trend", TrendJson(result.trend)}};
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
  auto norms = ReadNorms(options.norms, result.guided);
  if (!norms) return session::Fail("assess", norms.error());
  result.norms = std::move(*norms);
  auto trend = ReadTrend(result, options.trend);
  if (!trend) return session::Fail("assess", trend.error());
  result.trend = std::move(*trend);
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
  if (const auto written = base::WriteText(options.session / kTrendName, TrendCsv(result.trend)); !written)
    return session::Fail("assess", written.error(), session::kFailed);
  const fs::path page = options.session / "assess.html";
  if (const auto written = WriteAssessPage(result, verdict, options.command_line, page); !written)
    return session::Fail("assess", written.error(), session::kFailed);
  if (other)
    if (const auto written = WriteComparison(result, *other, options.command_line, options.session); !written)
      return session::Fail("assess", written.error(), session::kFailed);
  PrintResult(result, verdict);
  if (other) PrintComparison(result, *other, options.session / "compare.html");
  fmt::print("report: {}\n", page.string());
  return options.pass_at && !Passes(result, *options.pass_at) ? session::kFailed : 0;
}

}  // namespace osteon::studies
