#include "studies/capability/capability.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <system_error>

#include <fmt/format.h>

#include "base/interrupt.h"
#include "base/parallel.h"
#include "base/phase_progress.h"
#include "base/write_text.h"
#include "config/reading/apply_identified.h"
#include "config/reading/load.h"
#include "io/recording/recording_reader.h"
#include "report/page.h"
#include "report/svg_text.h"
#include "session/process/exit_code.h"
#include "session/summary/chart_files.h"
#include "session/summary/summary.h"
#include "studies/capability/capability_result.h"

namespace osteon::studies {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;
// Default ranges of the base's place relative to the site: to each side, downward and upward.
constexpr double kReach_m = 0.9, kLower_m = 0.7, kHigher_m = 0.5;
constexpr double kPanelStep_m = 0.025;  // distance of neighbouring places of the base in a picture
constexpr double kPressing_N = 20.0;    // least force along the tool; smaller forces give no reliable ratio

// Returns the greatest ratio of lateral to axial force in a recorded run, over the ticks with at least
// kPressing_N along the tool.
tl::expected<double, std::string> LateralRatio(const std::filesystem::path& file) {
  auto stream = io::RecordingStream::Open(file);
  if (!stream) return tl::unexpected(stream.error());
  double ratio = -1.0;
  for (;;) {
    const auto topic = stream->Next();
    if (!topic) return tl::unexpected(topic.error());
    if (*topic == io::RecordedTopic::kOther) break;
    if (*topic != io::RecordedTopic::kTick) continue;
    const Vector3 f = stream->tick.F_coupling_T_W.f, feed = Pose(stream->tick.X_WT_cmd).linear().col(2);
    const double axial_N = std::abs(f.dot(feed));
    if (axial_N >= kPressing_N) ratio = std::max(ratio, (f - f.dot(feed) * feed).norm() / axial_N);
  }
  if (const std::string wrong = stream->EndError(); !wrong.empty())
    return tl::unexpected(fmt::format("{}: {}; accepted a whole recording", file.string(), wrong));
  if (ratio < 0.0)
    return tl::unexpected(
        fmt::format("{}: found no tick with {:g} N along the tool, accepted a run that cuts", file.string(),
                    kPressing_N));
  return ratio;
}

// Returns the mount's base orientation, without a turn about the base's axis.
Matrix3 MountOf(const config::CellConfig& cell, Mount mount) {
  if (mount == Mount::kFloor) return Matrix3::Identity();
  if (mount == Mount::kCeiling) return ExpRotation({std::numbers::pi, 0.0, 0.0});
  return cell.X_WB.linear();
}

// The search's parameters, with the default ranges where the options give none.
BasePlacementParams SearchOf(const CapabilityOptions& options, const TaskVolume& task, const Vector3& now_W) {
  const Vector3 site = task.X_WC.translation();
  const auto range = [](const std::optional<std::array<double, 2>>& asked_mm, double from_m, double to_m) {
    if (asked_mm) return AxisRange{1e-3 * (*asked_mm)[0], 1e-3 * (*asked_mm)[1]};
    // Round to whole centimetres, so that the grid's places are at whole centimetres.
    return AxisRange{0.01 * std::round(100.0 * from_m), 0.01 * std::round(100.0 * to_m)};
  };
  return {.x_m = range(options.x_mm, site.x() - kReach_m, site.x() + kReach_m),
          .y_m = range(options.y_mm, site.y() - kReach_m, site.y() + kReach_m),
          .z_m = range(options.z_mm, site.z() - kLower_m, site.z() + kHigher_m),
          .clearance_m = 1e-3 * options.clearance_mm,
          .joint_margin_rad = options.joint_margin_deg * kRadiansPerDegree,
          .now_W_m = now_W,
          .threads = options.threads};
}

// Crops a panel to the places from which the task can be done and to the marks (site, present base, best
// base), with a margin of two places.
BasePanel Cropped(const BasePanel& panel) {
  int low_x = panel.nx, high_x = -1, low_y = panel.ny, high_y = -1;
  const auto keep = [&](int i, int j) {
    low_x = std::min(low_x, i);
    high_x = std::max(high_x, i);
    low_y = std::min(low_y, j);
    high_y = std::max(high_y, j);
  };
  const auto at = [&](const BasePanel& p, int i, int j) {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(p.nx) + static_cast<std::size_t>(i);
  };
  for (int j = 0; j < panel.ny; ++j)
    for (int i = 0; i < panel.nx; ++i)
      if (std::isfinite(panel.force_N[at(panel, i, j)])) keep(i, j);
  for (const std::array<double, 2>& mark : {panel.site, panel.own, panel.best})
    keep(static_cast<int>(std::lround((mark[0] - panel.x_from_m) / panel.step_m)),
         static_cast<int>(std::lround((mark[1] - panel.y_from_m) / panel.step_m)));
  constexpr int kRim = 2;
  low_x = std::max(0, low_x - kRim);
  low_y = std::max(0, low_y - kRim);
  high_x = std::min(panel.nx - 1, high_x + kRim);
  high_y = std::min(panel.ny - 1, high_y + kRim);
  BasePanel cropped = panel;
  cropped.x_from_m += low_x * panel.step_m;
  cropped.y_from_m += low_y * panel.step_m;
  cropped.nx = high_x - low_x + 1;
  cropped.ny = high_y - low_y + 1;
  cropped.force_N.clear();
  for (int j = low_y; j <= high_y; ++j)
    for (int i = low_x; i <= high_x; ++i) cropped.force_N.push_back(panel.force_N[at(panel, i, j)]);
  return cropped;
}

// Computes the axial force that the arm can hold over the task, for bases in a plane through the best base.
// The plane is horizontal, or vertical through site and best base.
BasePanel PanelAround(const BasePlacement& search, const BaseFigure& best, const CapabilityResult& result,
                      bool vertical) {
  const Vector3 site = result.task.X_WC.translation(), p_best = best.X_WB.translation(),
                p_own = result.X_WB.translation();
  BasePanel panel;
  panel.step_m = kPanelStep_m;
  Vector3 origin = site, u = Vector3::UnitX(), v = Vector3::UnitY();
  const BasePlacementParams& s = result.search;
  AxisRange across = {s.x_m.from - site.x(), s.x_m.to - site.x()},
            up = {s.y_m.from - site.y(), s.y_m.to - site.y()};
  if (vertical) {
    u = Vector3(p_best.x() - site.x(), p_best.y() - site.y(), 0.0);
    u = u.norm() > 1e-6 ? Vector3(u.normalized()) : Vector3::UnitX();
    if (u.x() < 0.0) u = -u;  // left and right as in the plan view
    v = Vector3::UnitZ();
    across = {-kReach_m, kReach_m};
    up = {s.z_m.from - site.z(), s.z_m.to - site.z()};
    panel.title = "Side view, through site and best base";
    panel.x_label = "from the site [mm]";
    panel.y_label = "base above the site [mm]";
  } else {
    origin.z() = p_best.z();
    panel.title = fmt::format("Plan view, base at z = {:.0f} mm", 1e3 * p_best.z());
    panel.x_label = "x from the site [mm]";
    panel.y_label = "y from the site [mm]";
  }
  const auto local = [&](const Vector3& p) {
    return std::array<double, 2>{(p - origin).dot(u), (p - origin).dot(v)};
  };
  panel.x_from_m = across.from;
  panel.y_from_m = up.from;
  panel.nx = std::max(2, 1 + static_cast<int>(std::floor((across.to - across.from) / panel.step_m + 1e-9)));
  panel.ny = std::max(2, 1 + static_cast<int>(std::floor((up.to - up.from) / panel.step_m + 1e-9)));
  panel.site = local(site);
  panel.own = local(p_own);
  if (vertical) {
    // The present base may lie beside the vertical plane: rotate it about the site's vertical into the plane.
    const double side = panel.own[0] < 0.0 ? -1.0 : 1.0;
    panel.own[0] = side * std::hypot(p_own.x() - site.x(), p_own.y() - site.y());
  }
  panel.best = local(p_best);
  panel.force_N.assign(static_cast<std::size_t>(panel.nx) * static_cast<std::size_t>(panel.ny), std::nan(""));
  simulation::ParallelFor(
      panel.force_N.size(), s.threads,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end && !base::Interrupted(); ++i) {
          const auto column = static_cast<double>(i % static_cast<std::size_t>(panel.nx));
          const auto row = static_cast<double>(i / static_cast<std::size_t>(panel.nx));
          const BaseFigure figure = search.Judge(origin + (panel.x_from_m + column * panel.step_m) * u +
                                                 (panel.y_from_m + row * panel.step_m) * v);
          if (figure.configurations != 0) panel.force_N[i] = figure.factor * result.need.axial_N;
        }
      },
      16);
  return Cropped(panel);
}

// Searches the best base and maps the bases around it. On Ctrl-C, or if no base is found, the result has no
// base.
void Search(const config::CellConfig& cell, const CapabilityOptions& options, base::PhaseProgress& progress,
            CapabilityResult& result) {
  result.searched = true;
  result.search = SearchOf(options, result.task, result.X_WB.translation());
  const BasePlacement search(cell.robot.lbr()->chain, MountOf(cell, options.mount), cell.tool.X_FT,
                             result.task, result.need, result.search);
  progress.BeginPhase("looking for a base");
  const auto best = search.Best([] { return base::Interrupted().load(); });
  if (!best || base::Interrupted()) return;
  result.base = search.Centred(*best);
  result.base_force = search.Forces(*result.base);
  progress.BeginPhase("mapping the bases round it");
  result.base_panels = {PanelAround(search, *result.base, result, false),
                        PanelAround(search, *result.base, result, true)};
}

// The report as HTML, from its pictures.
std::string Page(const CapabilityResult& result, const CapabilityOptions& options, const std::string& map,
                 const std::string& own_map, const std::string& bases) {
  const std::string title = "Force capability of " + result.cell;
  std::string html =
      report::PageBegin({.title = title, .verdict = Judge(result).ForReport(), .summary = Rows(result)});
  html += "<h2>What the arm holds, where</h2>\n";
  html += report::Figure(
      map,
      "The tool's head centred at each place, the tool along the site's axis and tilted to the cone's edge "
      "all round: the least force of these poses, along the tool (upper row) and in the weakest direction "
      "across it (lower row). Gravity's help is not counted, as in the servo loop's limiter.");
  html +=
      report::Figure(own_map, "The same at the arm angle and the configuration that the cell begins with.");
  if (!bases.empty())
    html +=
        "<h2>Where the base may stand</h2>\n" +
        report::Figure(
            bases,
            "For each place of the base, the axial force that is guaranteed over the whole task, while the "
            "needed share of it acts across the tool as well; at the best single arm angle.") +
        fmt::format(
            "<p>Kept: {:g} deg from every joint limit, elbow and wrist bent by {:g} deg at least and on the "
            "workspace's side of its plane, the base's axis {:g} mm from the site. What the arm may "
            "collide with is not known here.</p>\n",
            result.search.joint_margin_rad / kRadiansPerDegree,
            std::round(result.search.min_bend_rad / kRadiansPerDegree), result.search.clearance_m * 1e3);
  if (result.base) html += "<pre>" + report::Escape(BaseYaml(result, options.command_line)) + "</pre>\n";
  return html + report::RepeatSection(options.command_line) + report::PageEnd();
}

// Writes all files of the result.
tl::expected<void, std::string> Write(const CapabilityResult& result, const CapabilityOptions& options) {
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  if (error) return tl::unexpected(options.out.string() + ": " + error.message());
  const std::string map = MapSvg(result, false), own_map = MapSvg(result, true), bases = BaseSvg(result);
  for (const auto& [name, svg] :
       {std::pair{"capability", &map}, {"capability_own_angle", &own_map}, {"base", &bases}}) {
    if (svg->empty()) continue;
    if (const auto written = session::WriteDrawing(*svg, options.out / name); !written) return written;
  }
  const std::string json = ToJson(result, options.command_line);
  if (const auto written = base::WriteText(options.out / "capability.csv", MapCsv(result)); !written)
    return written;
  if (const auto written = base::WriteText(options.out / "capability.json", json); !written) return written;
  if (result.base)
    if (const auto written =
            base::WriteText(options.out / "base.yaml", BaseYaml(result, options.command_line));
        !written)
      return written;
  if (!options.json.empty())
    if (const auto written = base::WriteText(options.json, json); !written) return written;
  return report::WritePage(Page(result, options, map, own_map, bases), options.out / "capability.html");
}

// Runs the subcommand. Throws if the input is bad.
int Run(const CapabilityOptions& options) {
  if (const std::string wrong = session::ValidateOutputFolder("--out", options.out); !wrong.empty())
    return session::Fail("capability", wrong);
  config::CellConfig cell = config::LoadCell(options.cell);
  config::RequireSimulation(cell, options.cell);
  if (!options.identified.empty()) config::ApplyIdentified(options.identified, cell);
  if (!cell.robot.lbr())
    return session::Fail(
        "capability",
        fmt::format("{}: found a {}, accepted an LBR: what torques an arm of six axes has is not "
                    "published",
                    options.cell.string(), cell.robot.name));
  CapabilityResult result;
  result.cell = options.cell.stem().string();
  result.tool = cell.tool.tool.name;
  std::optional<double> radius_m;
  if (options.radius_mm) radius_m = 1e-3 * *options.radius_mm;
  result.task = TaskOf(cell, radius_m);
  result.need = NeedOf(cell);
  result.X_WB = cell.X_WB;
  result.own_arm_angle_rad = cell.start.arm_angle_rad;
  if (options.axial_N) {
    result.need.lateral_N *= *options.axial_N / result.need.axial_N;
    result.need.axial_N = *options.axial_N;
  }
  if (!options.recording.empty()) {
    const auto ratio = LateralRatio(options.recording);
    if (!ratio) return session::Fail("capability", "--recording: " + ratio.error());
    result.need.lateral_N = *ratio * result.need.axial_N;
    result.need.lateral_from = fmt::format("{:.2f} of the axial force, the most in {}", *ratio,
                                           options.recording.filename().string());
  }
  if (options.lateral_N) {
    result.need.lateral_N = *options.lateral_N;
    result.need.lateral_from = "asked for";
  }
  result.need.torque_Nm = options.torque_Nm;

  base::InstallInterrupt();
  base::PhaseProgress progress("osteon capability", options.search ? 5 : 3);
  const CapabilityMap map(cell, result.task, result.need, options.threads);
  progress.BeginPhase("the task from this base");
  result.best_angle = map.AtBestArmAngle();
  result.own_angle = map.AtOwnArmAngle();
  if (result.best_angle.poses == 0)
    return session::Fail(
        "capability", "the workspace allows no pose of the task; accepted a workspace that holds the site");
  result.outside = SampledPoses(result.task, TaskFineness{}) - static_cast<int>(result.best_angle.poses);
  progress.BeginPhase("what is felt and rendered");
  result.rendering = RenderingOf(cell);
  progress.BeginPhase("mapping the workspace");
  for (const MapPlane plane : {MapPlane::kVertical, MapPlane::kHorizontal})
    result.maps.push_back(map.Panel(plane, options.nodes, [] { return base::Interrupted().load(); }));
  if (options.search && !base::Interrupted()) Search(cell, options, progress, result);
  progress.Done();
  if (base::Interrupted()) return base::kExitInterrupted;

  if (const auto written = Write(result, options); !written)
    return session::Fail("capability", written.error(), session::kFailed);
  session::PrintVerdict(Judge(result), 30);
  for (const report::SummaryRow& row : Rows(result)) fmt::print("  {:<30} {}\n", row.key, row.value);
  fmt::print("  {:<30} {}\n", "Report", (options.out / "capability.html").string());
  if (result.base) fmt::print("  {:<30} {}\n", "For the cell's file", (options.out / "base.yaml").string());
  return 0;
}

}  // namespace

int RunCapability(const CapabilityOptions& options) {
  try {
    return Run(options);
  } catch (const config::ConfigError& error) {
    return session::Fail("capability", error.what());
  } catch (const std::invalid_argument& error) {
    return session::Fail("capability", error.what());
  }
}

}  // namespace osteon::studies
