#include "report/report.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <list>
#include <regex>
#include <sstream>

#include <gtest/gtest.h>

#include "control/ports.h"
#include "report/run_charts.h"
#include "report_markup.h"
#include "report_synthetic.h"
#include "tests/temporary_path.h"

namespace osteon::report {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

RunCurves CurvesOf(const SyntheticRun& run) {
  RunCurves curves;
  for (const control::TickRecord& tick : run.ticks) curves.Add(tick);
  for (const simulation::FrameRecord& frame : run.frames) curves.Add(frame);
  return curves;
}

// Makes a report's input from a run. The input refers to curves and a path that live as long as the program.
ReportInput InputOf(const SyntheticRun& run) {
  static std::list<RunCurves> curves;
  static std::list<std::vector<Pose>> paths;
  return {.subtitle = "reference engine",
          .summary = {{"ticks", "2000"}, {"peak force", "126.0 N"}, {"removed volume", "2400 mm³"}},
          .run = curves.emplace_back(CurvesOf(run)),
          .X_GP = paths.emplace_back(PathOf(run)),
          .bone = run.bone,
          .after = run.after,
          .tool = run.tool,
          .tool_speed_limit_m_per_s = 0.25,
          .faults = {},
          .config_text = "tool: reamer_50.yaml\n",
          .command_line = "./osteon demo --seconds 2",
          .version = "0.1.0",
          .pictures = {.width = 240, .height = 190}};
}

// A run of the usual length in a bone of few balls, for tests that look at the page's charts alone.
const SyntheticParams kCoarseBone{.spacing_m = 2e-3, .cap_m = 1.8e-3, .point_spacing_m = 2e-3};

/// Returns the first address in a page that a browser would fetch; empty if the page needs no other file.
std::string OutsideReference(const std::string& html) {
  static const std::regex address("(https?:)?//[a-zA-Z0-9]");
  const std::string xmlns = "xmlns=\"http://www.w3.org/2000/svg\"";
  std::string rest = html;
  for (std::size_t at = rest.find(xmlns); at != std::string::npos; at = rest.find(xmlns, at))
    rest.erase(at, xmlns.size());
  // base64 may hold any letters and slashes
  rest = std::regex_replace(rest, std::regex("base64,[A-Za-z0-9+/=]*"), "");
  std::smatch match;
  if (std::regex_search(rest, match, address)) return match.str();
  for (const char* word : {"<script ", "<link", "<iframe", "@import", "url(http"})
    if (rest.find(word) != std::string::npos) return word;
  return {};
}

// The page without the data of its base64 pictures.
std::string WithoutPictures(const std::string& html) {
  std::string out;
  std::size_t from = 0;
  for (std::size_t at = html.find("base64,"); at != std::string::npos; at = html.find("base64,", from)) {
    out += html.substr(from, at - from);
    from = html.find('"', at);
  }
  return out + html.substr(from);
}

// Expects well-formed markup without references to other files and without nan or inf.
void ExpectValidPage(const std::string& page) {
  const std::string html = WithoutPictures(page);
  EXPECT_EQ(MarkupError(html), "");
  EXPECT_EQ(OutsideReference(html), "");
  static const std::regex not_finite("[\" ,>(-](nan|inf)[\" ,<)]");
  std::smatch match;
  EXPECT_FALSE(std::regex_search(html, match, not_finite))
      << match.prefix().str().substr(match.prefix().length() - 60);
}

void ExpectValid(const ReportInput& input) {
  const auto report = MakeReport(input);
  ASSERT_TRUE(report.has_value()) << report.error();
  ExpectValidPage(report->html);
}

TEST(Report, TheReportOfARunIsOneValidFileWithEverythingInIt) {
  const SyntheticRun run = MakeSyntheticRun({.tilt_rad = 0.17});
  ReportInput input = InputOf(run);
  input.pictures = {};
  const auto file = TemporaryPath("osteon_report.html");
  const auto figures = WriteReport(input, file);
  ASSERT_TRUE(figures.has_value()) << figures.error();
  EXPECT_GT(figures->cavity_section.samples, 100);
  EXPECT_LT(figures->cavity_section.mean_abs_m, 0.3e-3);
  EXPECT_GT(figures->cavity_direction.samples, 100);
  EXPECT_LT(figures->cavity_direction.mean_abs_m, 0.3e-3);
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  const std::string html = text.str();
  ExpectValidPage(html);
  for (const char* part : {"limit 200 N", "Removed volume", "Apex below the first floor",
                           "message to wake-up", "wake-up to answer", "Simulation frame", "swept by the tool",
                           "class=\"verdict good\"", "Commanded tool beyond its collision-free pose",
                           "./osteon demo --seconds 2", "reamer_50.yaml", "data:image/png;base64,"})
    EXPECT_NE(html.find(part), std::string::npos) << part;
  EXPECT_LT(html.size(), 4u << 20u);
  for (const auto& entry : std::filesystem::directory_iterator(file.parent_path()))
    EXPECT_FALSE(entry.path().filename().string().starts_with("osteon_report.html.")) << entry.path();
}

TEST(Report, ChartsTheShareOfTheCouplingOnlyIfALimitReducedIt) {
  SyntheticRun run = MakeSyntheticRun(kCoarseBone);
  const std::string title = "Share of the coupling";
  const auto whole = MakeReport(InputOf(run));
  ASSERT_TRUE(whole) << whole.error();
  EXPECT_EQ(whole->html.find(title), std::string::npos) << "nothing was cut off";
  run.ticks[1000].wrench_scale = 0.6;
  run.ticks[1000].arm_share = 0.8;
  const auto cut = MakeReport(InputOf(run));
  ASSERT_TRUE(cut) << cut.error();
  EXPECT_NE(cut->html.find(title), std::string::npos);
  EXPECT_NE(cut->html.find("arm&#39;s torques can hold"), std::string::npos);
}

// In a tick without the arm's message nothing was rendered: the chart must not depend on that tick's forces.
TEST(Report, ATickWithoutTheArmsMessageIsNotDrawnAsAForceOfZero) {
  SyntheticRun run = MakeSyntheticRun();
  control::TickRecord& silent = run.ticks.at(run.ticks.size() / 2);
  ASSERT_GT(Wrench(silent.F_coupling_T_W).f.norm(), 10.0);
  silent.input.received = static_cast<std::uint8_t>(control::ReceiveResult::kTimeout);
  const std::string chart = ForceChart(CurvesOf(run), 200.0);
  silent.F_coupling_T_W = silent.F_operator_T_W = {};
  EXPECT_EQ(ForceChart(CurvesOf(run), 200.0), chart);
  silent.input.received = static_cast<std::uint8_t>(control::ReceiveResult::kOk);
  EXPECT_NE(ForceChart(CurvesOf(run), 200.0), chart) << "a force of 0 that was rendered is drawn";
}

TEST(Report, ChartsOnlyTheCompliantPartsThatMoved) {
  SyntheticRun run = MakeSyntheticRun(kCoarseBone);
  EXPECT_EQ(ComplianceChart(CurvesOf(run)), "") << "a rigid cell";
  const auto rigid = MakeReport(InputOf(run));
  ASSERT_TRUE(rigid) << rigid.error();
  EXPECT_EQ(rigid->html.find("What gave way"), std::string::npos);
  for (control::TickRecord& tick : run.ticks) {
    tick.compliance.present = true;
    tick.compliance.bend_m = {3e-4, 4e-4, 0.0};
  }
  const RunCurves curves = CurvesOf(run);
  ASSERT_EQ(curves.bend_mm.points().size(), run.ticks.size());
  EXPECT_NEAR(curves.bend_mm.points().front().value, 0.5, 1e-12);
  const auto bent = MakeReport(InputOf(run));
  ASSERT_TRUE(bent) << bent.error();
  EXPECT_NE(bent->html.find("What gave way"), std::string::npos);
  EXPECT_NE(bent->html.find("The tool bends"), std::string::npos);
  EXPECT_EQ(bent->html.find("Bone on its mount"), std::string::npos) << "it never moved";
}

TEST(Report, ListsTheAssumedMaterialFigures) {
  SyntheticRun run = MakeSyntheticRun(
      {.spacing_m = 2e-3, .cap_m = 1.8e-3, .point_spacing_m = 2e-3, .ticks = 5, .frames = 5});
  for (simulation::Material& material : run.bone.materials)
    material.density_source = material.cutting_energy_source = material.cutting_force_source =
        material.friction_source = {.text = "measured", .assumed = false};
  const auto sourced = MakeReport(InputOf(run));
  ASSERT_TRUE(sourced.has_value());
  EXPECT_EQ(sourced->html.find("<h2>Assumed</h2>"), std::string::npos);
  run.bone.materials[2].friction = 0.25;
  run.bone.materials[2].friction_source = {.text = "wet & rough", .assumed = true};
  ExpectValid(InputOf(run));
  const auto report = MakeReport(InputOf(run));
  EXPECT_NE(report->html.find("<li>cancellous: friction 0.25 (wet &amp; rough)</li>"), std::string::npos);
  EXPECT_EQ(report->html.find("cartilage: friction"), std::string::npos);
}

TEST(Report, ListsTheLimitsThatActedWithTheLongestFirst) {
  const SyntheticRun run = MakeSyntheticRun(
      {.spacing_m = 2e-3, .cap_m = 1.8e-3, .point_spacing_m = 2e-3, .ticks = 5, .frames = 5});
  ReportInput input = InputOf(run);
  const auto none = MakeReport(input);
  ASSERT_TRUE(none.has_value());
  EXPECT_EQ(none->html.find("Limits that acted"), std::string::npos);
  input.limits = {{.name = "tool <speed>", .first_s = 0.5, .total_s = 0.02, .longest_s = 0.01, .times = 3},
                  {.name = "depth limit", .first_s = 2.25, .total_s = 1.5, .longest_s = 1.25, .times = 2}};
  ExpectValid(input);
  const auto report = MakeReport(input);
  ASSERT_TRUE(report.has_value());
  const auto speed = report->html.find("<td>tool &lt;speed&gt;</td><td class=\"n\">0.500</td>");
  const auto depth = report->html.find(
      "<td>depth limit</td><td class=\"n\">2.250</td><td class=\"n\">1.500</td><td class=\"n\">1.250</td>"
      "<td class=\"n\">2</td>");
  ASSERT_NE(speed, std::string::npos);
  ASSERT_NE(depth, std::string::npos);
  EXPECT_LT(depth, speed);
}

// In bone the commanded tool is deeper than the proxy, because the proxy stays outside the bone. The chart
// must then draw both depths.
TEST(Report, DrawsTheCommandedDepthBesideTheProxys) {
  SyntheticRun run = MakeSyntheticRun({.tilt_rad = 0.17});
  for (control::TickRecord& tick : run.ticks) {
    tick.X_WT_cmd.p.z = -1e-3 - 1e-6 * static_cast<double>(tick.tick);
    tick.tool_in_bone_m = tick.tick < 500 ? 0.0 : 1e-3;
  }
  const std::string without = ProgressChart(CurvesOf(run));
  RunCurves curves;
  curves.depth_of = [](const Pose& X_WT) { return -X_WT.translation().z(); };
  for (const simulation::FrameRecord& frame : run.frames) curves.Add(frame);
  for (const control::TickRecord& tick : run.ticks) curves.Add(tick);
  const auto [times_s, depths_mm] = curves.commanded_depth_mm.Columns(curves.Start());
  ASSERT_EQ(depths_mm.size(), run.ticks.size());
  for (std::size_t i = 0; i < run.ticks.size(); ++i) {
    const control::TickRecord& tick = run.ticks[i];
    EXPECT_EQ(std::isfinite(depths_mm[i]), tick.tool_in_bone_m > 0.0) << i;
    if (!std::isfinite(depths_mm[i])) continue;
    EXPECT_DOUBLE_EQ(depths_mm[i], 1.0 + 1e-3 * static_cast<double>(i));
  }
  EXPECT_NE(ProgressChart(curves), without);
}

TEST(Report, AReportOfVirtualTimeSaysThatNothingWasMeasured) {
  SyntheticRun run = MakeSyntheticRun(
      {.spacing_m = 2e-3, .cap_m = 1.8e-3, .point_spacing_m = 2e-3, .ticks = 50, .frames = 20});
  for (control::TickRecord& tick : run.ticks) tick.wakeup_ns = tick.compute_ns = 0;
  for (simulation::FrameRecord& frame : run.frames) frame.duration_ns = 0;
  const auto report = MakeReport(InputOf(run));
  ASSERT_TRUE(report.has_value());
  EXPECT_NE(report->html.find("Virtual time: not measured"), std::string::npos);
  EXPECT_EQ(report->html.find("99.9 %"), std::string::npos);
}

TEST(Report, RunsWithoutTicksFramesOrBoneGiveAValidPage) {
  const SyntheticParams coarse{
      .spacing_m = 2e-3, .cap_m = 1.8e-3, .point_spacing_m = 2e-3, .ticks = 5, .frames = 5};
  SyntheticRun run = MakeSyntheticRun(coarse);
  run.ticks.clear();
  ExpectValid(InputOf(run));
  run.frames.clear();
  ExpectValid(InputOf(run));
  run.after = {};
  ExpectValid(InputOf(run));
  run.bone.points.clear();
  ExpectValid(InputOf(run));
  run.bone.balls.clear();
  run.tool.balls.clear();
  ExpectValid(InputOf(run));

  SyntheticRun gone = MakeSyntheticRun(coarse);
  for (float& value : gone.after.balls) value = 0.0f;
  ExpectValid(InputOf(gone));
  gone.after.balls.resize(7);
  ExpectValid(InputOf(gone));
}

TEST(Report, ValuesThatAreNotFiniteLeaveGaps) {
  SyntheticRun run = MakeSyntheticRun(
      {.spacing_m = 2e-3, .cap_m = 1.8e-3, .point_spacing_m = 2e-3, .ticks = 60, .frames = 30});
  run.ticks[7].F_coupling_T_W.f.x = kNaN;
  run.ticks[9].v_WT_cmd_m_per_s.y = std::numeric_limits<double>::infinity();
  run.frames[3].model.X_WP.p.z = kNaN;
  run.frames[4].cup_depth_m = kNaN;
  run.frames[5].model.removed_volume_m3 = -std::numeric_limits<double>::infinity();
  run.bone.balls[11].center_m.x = kNaN;
  run.after.balls[3] = std::numeric_limits<float>::quiet_NaN();
  run.bone.points[2].p_m.y = kNaN;
  ReportInput input = InputOf(run);
  input.faults = {{"contact model stale", kNaN, "Stop 1"}};
  input.force_limit_N = kNaN;
  ExpectValid(input);
}

TEST(Report, TextIsEscaped) {
  SyntheticRun run = MakeSyntheticRun(
      {.spacing_m = 2e-3, .cap_m = 1.8e-3, .point_spacing_m = 2e-3, .ticks = 5, .frames = 5});
  run.bone.materials[0].name = "<script>alert(1)</script> & cartilage";
  ReportInput input = InputOf(run);
  input.title = "a \"title\" <b>";
  input.summary.push_back({"<i>", "1 < 2 & 3 > 2"});
  input.faults = {{"<fault>", 1.5, "\"Stop\" & 'hold'"}};
  input.command_line = "./osteon demo --out '<here>'";
  input.config_text = "a: <b>\nc: \xff\n";
  ExpectValid(input);
}

TEST(Report, ASummaryRowLinksToAFileInTheReportsFolder) {
  const SyntheticRun run = MakeSyntheticRun(
      {.spacing_m = 2e-3, .cap_m = 1.8e-3, .point_spacing_m = 2e-3, .ticks = 5, .frames = 5});
  ReportInput input = InputOf(run);
  input.summary = {{"How the run ended", "out/run 1:\"a\"_stop_1.html", "run 1:\"a\"_stop_1.html"}};
  ExpectValid(input);
  const auto report = MakeReport(input);
  ASSERT_TRUE(report.has_value()) << report.error();
  EXPECT_NE(
      report->html.find("<a href=\"./run%201%3A%22a%22_stop_1.html\">run 1:&quot;a&quot;_stop_1.html</a>"),
      std::string::npos);
}

TEST(Report, TheErrorNamesAPathThatCannotBeWritten) {
  const SyntheticRun run = MakeSyntheticRun(
      {.spacing_m = 3e-3, .cap_m = 2.8e-3, .point_spacing_m = 3e-3, .ticks = 1, .frames = 1});
  const auto result = WriteReport(InputOf(run), "/no/such/folder/report.html");
  ASSERT_FALSE(result.has_value());
  EXPECT_NE(result.error().find("/no/such/folder/report.html"), std::string::npos);
}

}  // namespace
}  // namespace osteon::report
