#include "studies/plan/plan_result.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/interrupt.h"
#include "base/phase_progress.h"
#include "base/write_text.h"
#include "report/page.h"
#include "report/svg_plot.h"
#include "session/process/exit_code.h"

namespace osteon::studies {
namespace {

std::size_t CountCuttingBalls(const simulation::Tool& tool) {
  return static_cast<std::size_t>(
      std::ranges::count_if(tool.balls, [](const simulation::ToolBall& ball) { return ball.cutting; }));
}

struct Radii {
  double min_m{0.0}, max_m{0.0};
};

Radii RadiiOf(const std::vector<simulation::Ball>& balls) {
  if (balls.empty()) return {};
  const auto [least, greatest] = std::ranges::minmax_element(balls, {}, &simulation::Ball::radius_m);
  return {.min_m = least->radius_m, .max_m = greatest->radius_m};
}

// JSON of the timed frames of one packing.
nlohmann::json GroupJson(const simulation::FrameGroup& group) {
  return {{"frames", group.frames},
          {"frames_interrupted", group.interrupted},
          {"active_spheres", group.active_balls},
          {"frame_us_p50", group.p50_us},
          {"frame_us_p999", group.p999_us}};
}

// Fraction of the timed frames above which the verdict warns that other programs interrupted them.
constexpr double kSomeInterrupted = 0.2;

struct FrameCounts {
  std::size_t frames{0}, interrupted{0};
};

// Sums over the frames of all packings.
FrameCounts CountsOf(const std::vector<simulation::FrameGroup>& groups) {
  FrameCounts counts;
  for (const simulation::FrameGroup& group : groups) {
    counts.frames += group.frames;
    counts.interrupted += group.interrupted;
  }
  return counts;
}

// "rate: 700 Hz of 1000": the demand that is not met, with its predicted and its requested value.
std::string UnmetDemandText(const session::UnmetDemand& demand) {
  return demand.what == "rate"
             ? fmt::format("rate: {:.0f} Hz of {:g}", demand.predicted, demand.asked)
             : fmt::format("error: {:.4f} mm instead of {:g}", demand.predicted, demand.asked);
}

report::SummaryRow Row(const char* name, const std::string& value) { return {.key = name, .value = value}; }

// The value of the compliance option as the cell's file writes it.
const char* ChoiceName(config::GivesWay choice) {
  return choice == config::GivesWay::kOff ? "off" : choice == config::GivesWay::kOn ? "on" : "auto";
}

// JSON of the parts of the cell that may be compliant, with the stiffness and the effect of each.
nlohmann::json ComplianceJson(const session::PlanScene& scene) {
  nlohmann::json parts = nlohmann::json::array();
  for (const config::CompliancePart& part : scene.gives_way) {
    nlohmann::json json{{"part", part.name}, {"cell", ChoiceName(part.asked)}, {"known", part.known}};
    if (part.known)
      json.update({{"on", part.on},
                   {"matters", part.effect.matters()},
                   {"stiffness_N_per_mm", 1e-3 * part.stiffness_N_per_m},
                   {"force_N", part.force_N},
                   {"gives_mm", 1e3 * part.effect.gives_m},
                   {"coupling_product", part.effect.product},
                   {"felt_change", part.effect.felt_share},
                   {"thrust_ratio", part.thrust_ratio}});
    if (part.felt_at_N > 0.0)
      json.update({{"stiffness_at_N", part.felt_at_N}, {"seated_mm2", 1e6 * part.seated_m2}});
    parts.push_back(std::move(json));
  }
  return parts;
}

// Says whether a part should be compliant in this scene, and why.
std::string ComplianceText(const config::CompliancePart& part) {
  if (!part.known) return fmt::format("rigid: no file of the cell says how the {} gives way", part.name);
  const simulation::ComplianceEffect& e = part.effect;
  // felt: the hand notices the change of stiffness; displaced: the part yields by more than the packing's
  // error
  const char* why = e.is_felt ? (e.is_displaced ? "felt, and off by more than the error" : "felt")
                              : (e.is_displaced ? "off by more than the error" : "not noticed");
  const std::string at = part.felt_at_N > 0.0 ? fmt::format(" at {:.3g} N; on {:.0f} mm² it", part.felt_at_N,
                                                            1e6 * part.seated_m2)
                                              : std::string();
  std::string text =
      fmt::format("{} ({}): {:.4g} N/mm{} gives {:.3f} mm under {:.3g} N, felt {:+.1f} %, K c {:.3g}",
                  e.matters() ? "on" : "off", why, 1e-3 * part.stiffness_N_per_m, at, 1e3 * e.gives_m,
                  part.force_N, 100.0 * e.felt_share, e.product);
  if (part.thrust_ratio > 0.0) text += fmt::format(", thrust {:.3f} of buckling", part.thrust_ratio);
  return text + fmt::format("; the cell says {}", ChoiceName(part.asked));
}

}  // namespace

session::Verdict Judge(const session::FidelityPlan& plan, const std::optional<session::PlanCheck>& check) {
  session::Verdict verdict;
  if (check)
    for (const std::string& missed : check->missed)
      verdict.Add(session::VerdictLevel::kBad, "measured otherwise than promised: " + missed);
  for (const session::UnmetDemand& demand : plan.unmet)
    verdict.Add(session::VerdictLevel::kWarning,
                "error and rate can't both be had; given up is the " + UnmetDemandText(demand));
  const auto [frames, interrupted] = CountsOf(plan.calibration);
  if (static_cast<double>(interrupted) > kSomeInterrupted * static_cast<double>(frames))
    verdict.Add(
        session::VerdictLevel::kWarning,
        fmt::format("in {} of the {} frames that the predicted times come from, a thread waited for a "
                    "processor: other programs ran, or a software driver has more threads than there are "
                    "processors",
                    interrupted, frames));
  return verdict;
}

nlohmann::json PlanJson(const session::PlanScene& scene, const session::PlanRequest& request,
                        const session::FidelityPlan& plan, const std::optional<session::PlanCheck>& check) {
  const Radii radii = RadiiOf(plan.packed.balls);
  const simulation::PackingFineness& fine = plan.packed.level.fine;
  nlohmann::json json{{"schema", "osteon.plan/1"},
                      {"subcommand", "plan"},
                      {"scene", scene.name},
                      {"cell", scene.cell_name},
                      {"tool", scene.work.tool.name},
                      {"engine", plan.engine},
                      {"device", plan.device},
                      {"error_mm", request.error_m * 1e3},
                      {"rate_hz", request.rate_hz},
                      {"packing", std::string(simulation::KindName(plan.packed.level.kind))},
                      {"spheres", plan.packed.balls.size()},
                      {"spheres_uniform", nullptr},
                      {"spheres_uniform_disjoint", static_cast<std::size_t>(plan.disjoint_balls)},
                      {"r_min_mm", radii.min_m * 1e3},
                      {"r_max_mm", radii.max_m * 1e3},
                      {"zone_spacing_mm", fine.spacing_m * 1e3},
                      {"zone_r_max_mm", fine.radius_m * 1e3},
                      {"zone_depth_mm", plan.packed.level.zone_depth_m * 1e3},
                      {"surface_gap_mm", fine.surface_gap_m * 1e3},
                      {"children", fine.children},
                      {"tool_spheres", CountCuttingBalls(plan.tool)},
                      {"tool_touching_spheres", plan.tool.balls.size() - CountCuttingBalls(plan.tool)},
                      {"arm_level", std::string(simulation::ArmFidelityName(plan.arm))},
                      {"turn_parts", plan.turn_parts},
                      {"compliance", ComplianceJson(scene)},
                      {"predicted_error_mm", plan.error_m * 1e3},
                      {"promised_error_mm", plan.promised_m * 1e3},
                      {"predicted_error_parts_mm",
                       {{"face", plan.removal.face_m * 1e3},
                        {"rim", plan.removal.rim_m * 1e3},
                        {"tool", plan.tool_gap_m * 1e3}}},
                      {"predicted_arm_error_mm", plan.arm_error_m * 1e3},
                      {"predicted_leak_mm", plan.leak_m * 1e3},
                      {"leak_probe_mm", plan.leak_probe_m * 1e3},
                      {"predicted_cogging", plan.cogging},
                      {"predicted_active_spheres", plan.active_balls},
                      {"predicted_frame_us", plan.frame_us},
                      {"predicted_frame_us_p999", plan.frame_p999_us},
                      {"frame_cost",
                       {{"base_us", plan.cost.base_us},
                        {"sphere_us", plan.cost.ball_us},
                        {"tail_ratio", plan.cost.tail_ratio}}},
                      {"calibration", nlohmann::json::array()},
                      {"given_up", nlohmann::json::array()},
                      {"check", nullptr}};
  if (plan.uniform_balls > 0.0) json["spheres_uniform"] = static_cast<std::size_t>(plan.uniform_balls);
  for (const simulation::FrameGroup& group : plan.calibration)
    json["calibration"].push_back(GroupJson(group));
  for (const session::UnmetDemand& demand : plan.unmet)
    json["given_up"].push_back({{"what", demand.what},
                                {"unit", demand.what == "rate" ? "Hz" : "mm"},
                                {"asked", demand.asked},
                                {"predicted", demand.predicted}});
  json["unmet"] = json["given_up"];  // the key that older programs read
  if (check) {
    json["check"] = {{"error_mm", check->error_m * 1e3}, {"standard_error_mm", check->standard_error_m * 1e3},
                     {"lost_mm", check->lost_m * 1e3},   {"left_mm", check->left_m * 1e3},
                     {"leak_mm", check->leak_m * 1e3},   {"frame_us_by_others_in_turn", check->same_time_us},
                     {"missed", check->missed}};
    json["check"].update(GroupJson(check->frames));
  }
  return json;
}

namespace {

// Rows for terminal and page: the plan, its predictions and, after a check, the measured figures.
std::vector<report::SummaryRow> PlanRows(const session::PlanScene& scene, const session::FidelityPlan& plan,
                                         const std::optional<session::PlanCheck>& check) {
  const Radii radii = RadiiOf(plan.packed.balls);
  const simulation::PackingLevel& level = plan.packed.level;
  std::vector<report::SummaryRow> rows;
  rows.push_back(
      Row("packing", fmt::format("{}, {} spheres of {:.3f} to {:.2f} mm", simulation::KindName(level.kind),
                                 plan.packed.balls.size(), radii.min_m * 1e3, radii.max_m * 1e3)));
  rows.push_back(Row(
      "zone", fmt::format("{:.3f} mm apart, radii up to {:.3f} mm, down to {:g} mm below it",
                          level.fine.spacing_m * 1e3, level.fine.radius_m * 1e3, level.zone_depth_m * 1e3)));
  if (level.fine.children > 0)
    rows.push_back(
        Row("splitting", fmt::format("{} children of a ball that is touched", level.fine.children)));
  const auto packing_row = [&](const char* name, double balls) {
    return Row(name, fmt::format("{:.0f} spheres, {:.1f} times as many", balls,
                                 balls / static_cast<double>(plan.packed.balls.size())));
  };
  if (plan.uniform_balls > 0.0) rows.push_back(packing_row("all of it alike", plan.uniform_balls));
  rows.push_back(packing_row("and disjoint", plan.disjoint_balls));
  rows.push_back(Row(
      "tool", fmt::format("{} spheres that cut, {} that touch; {:g} frames a turn at most",
                          CountCuttingBalls(plan.tool), plan.tool.balls.size() - CountCuttingBalls(plan.tool),
                          static_cast<double>(plan.turn_parts))));
  rows.push_back(Row("arm", fmt::format("{}, off by {:.3f} mm", simulation::ArmFidelityName(plan.arm),
                                        plan.arm_error_m * 1e3)));
  for (const config::CompliancePart& part : scene.gives_way)
    rows.push_back({.key = fmt::format("{} gives way", part.name), .value = ComplianceText(part)});
  rows.push_back(Row("predicted error", fmt::format("{:.4f} mm: face {:.4f}, rim {:.4f}, tool {:.4f}",
                                                    plan.error_m * 1e3, plan.removal.face_m * 1e3,
                                                    plan.removal.rim_m * 1e3, plan.tool_gap_m * 1e3)));
  rows.push_back(
      Row("leak, cogging", fmt::format("{:.4f} mm of a {:g} mm probe; {:.1f} % of the normal force",
                                       plan.leak_m * 1e3, plan.leak_probe_m * 1e3, plan.cogging * 100.0)));
  rows.push_back(Row(
      "predicted frame",
      fmt::format("{:.0f} us, p99.9 {:.0f} us: {:.0f} + {:.4f} us times {:.0f} active spheres", plan.frame_us,
                  plan.frame_p999_us, plan.cost.base_us, plan.cost.ball_us, plan.active_balls)));
  const auto [frames, interrupted] = CountsOf(plan.calibration);
  rows.push_back(Row("calibrated on", fmt::format("{} frames of {} other packings, {} of them interrupted",
                                                  frames, plan.calibration.size(), interrupted)));
  if (plan.unmet.empty()) rows.push_back(Row("given up", "nothing"));
  for (const session::UnmetDemand& demand : plan.unmet)
    rows.push_back(Row("given up", UnmetDemandText(demand)));
  if (!check) return rows;
  rows.push_back(Row("measured error",
                     fmt::format("{:.4f} ± {:.4f} mm: lost {:.4f}, left {:.4f}", check->error_m * 1e3,
                                 check->standard_error_m * 1e3, check->lost_m * 1e3, check->left_m * 1e3)));
  rows.push_back(Row("measured leak", fmt::format("{:.4f} mm", check->leak_m * 1e3)));
  rows.push_back(
      Row("measured frame",
          fmt::format("{:.0f} us, p99.9 {:.0f} us; {:.0f} active spheres; {} of {} frames interrupted",
                      check->frames.p50_us, check->frames.p999_us, check->frames.active_balls,
                      check->frames.interrupted, check->frames.frames)));
  rows.push_back(
      Row("", fmt::format("{:+.0f} % of the prediction, {:+.0f} % of what the others in turn with it say",
                          100.0 * (check->frames.p50_us / plan.frame_us - 1.0),
                          100.0 * (check->frames.p50_us / check->same_time_us - 1.0))));
  for (const std::string& missed : check->missed) rows.push_back(Row("missed", missed));
  return rows;
}

std::string PlanTitle(const session::PlanScene& scene, const session::PlanRequest& request,
                      const session::FidelityPlan& plan) {
  return fmt::format("Osteon plan: {}, {}, {:g} mm at {:g} Hz, {} on {}", scene.name, scene.work.tool.name,
                     request.error_m * 1e3, request.rate_hz, plan.engine, plan.device);
}

}  // namespace

std::string PlanText(const session::PlanScene& scene, const session::PlanRequest& request,
                     const session::FidelityPlan& plan, const std::optional<session::PlanCheck>& check) {
  std::string text = PlanTitle(scene, request, plan) + "\n";
  std::vector<report::SummaryRow> rows = session::VerdictRows(Judge(plan, check));
  std::ranges::move(PlanRows(scene, plan, check), std::back_inserter(rows));
  for (const report::SummaryRow& row : rows) text += fmt::format("  {:<18} {}\n", row.key, row.value);
  return text;
}

namespace {

// Draws the frame time over the number of active spheres: the timed packings, the line fitted to them, and
// the plan's prediction on that line.
std::string FrameChart(const session::FidelityPlan& plan, const std::optional<session::PlanCheck>& check) {
  report::Series timed{.name = "other packings, timed", .width_px = 0.0, .marker = report::Marker::kCircle};
  double max_active_balls = plan.active_balls;
  for (const simulation::FrameGroup& group : plan.calibration) {
    timed.x.push_back(group.active_balls);
    timed.y.push_back(group.p50_us);
    max_active_balls = std::max(max_active_balls, group.active_balls);
  }
  std::vector<report::Series> series{
      {.name = "fitted",
       .x = {0.0, max_active_balls},
       .y = {plan.cost.base_us, plan.cost.base_us + plan.cost.ball_us * max_active_balls}},
      std::move(timed),
      {.name = "this plan, predicted",
       .x = {plan.active_balls},
       .y = {plan.frame_us},
       .width_px = 0.0,
       .marker = report::Marker::kDiamond}};
  if (check)
    series.push_back({.name = "this plan, measured",
                      .x = {check->frames.active_balls},
                      .y = {check->frames.p50_us},
                      .width_px = 0.0,
                      .marker = report::Marker::kCross});
  return report::Svg(report::LineChart{.title = "Frame time",
                                       .x_label = "active spheres",
                                       .y_label = "median frame [µs]",
                                       .series = std::move(series)});
}

// Writes plan.html: verdict, figures and the chart of the frame time.
tl::expected<void, std::string> WritePlanPage(const PlanOptions& options, const session::PlanScene& scene,
                                              const session::FidelityPlan& plan,
                                              const std::optional<session::PlanCheck>& check) {
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  if (error) return tl::unexpected(options.out.string() + ": " + error.message());
  std::string html = report::PageBegin({.title = PlanTitle(scene, options.request, plan),
                                        .verdict = Judge(plan, check).ForReport(),
                                        .summary = PlanRows(scene, plan, check)});
  html +=
      "<h2>What the frame time was predicted from</h2>\n" +
      report::Figure(
          FrameChart(plan, check),
          "Two other packings of the scene were timed on this machine; the frame time grows with the spheres "
          "that are near the tool.");
  if (!options.command_line.empty()) html += report::RepeatSection(options.command_line);
  return report::WritePage(html + report::PageEnd(), options.out / "plan.html");
}

}  // namespace

int RunPlan(const PlanOptions& options) {
  base::InstallInterrupt();
  base::PhaseProgress progress("osteon plan", options.check ? 4 : 3);
  progress.BeginPhase("load");
  const auto scene = session::LoadPlanScene(options.choice);
  if (!scene) return session::Fail("plan", scene.error());
  const auto plan = session::MakePlan(*scene, options.request,
                                      [&](const std::string& phase) { progress.BeginPhase(phase); });
  if (!plan)
    return session::Fail("plan", plan.error(),
                         base::Interrupted() ? base::kExitInterrupted : session::kFailed);
  std::optional<session::PlanCheck> check;
  if (options.check) {
    progress.BeginPhase("check");
    auto checked = session::CheckPlan(*scene, options.request, *plan);
    if (!checked)
      return session::Fail("plan", checked.error(),
                           base::Interrupted() ? base::kExitInterrupted : session::kFailed);
    check = std::move(*checked);
  }
  progress.Done();
  fmt::print(stderr, "osteon plan: engine: {}\n", session::EngineText(options.request.engine, plan->device));
  fmt::print("{}", PlanText(*scene, options.request, *plan, check));
  if (!options.json.empty())
    if (const auto written = base::WriteText(
            options.json,
            session::ResultText(Judge(*plan, check), PlanJson(*scene, options.request, *plan, check)));
        !written)
      return session::Fail("plan", written.error(), session::kFailed);
  if (!options.out.empty()) {
    if (const auto written = WritePlanPage(options, *scene, *plan, check); !written)
      return session::Fail("plan", written.error(), session::kFailed);
    fmt::print("report: {}\n", (options.out / "plan.html").string());
  }
  return plan->unmet.empty() && (!check || check->missed.empty()) ? 0 : 1;
}

}  // namespace osteon::studies
