#include "studies/tune/tune_impedance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "base/interrupt.h"
#include "base/parallel.h"
#include "base/phase_progress.h"
#include "base/write_text.h"
#include "report/page.h"
#include "report/svg_plot.h"
#include "report/svg_text.h"
#include "session/process/exit_code.h"
#include "session/summary/chart_files.h"
#include "session/summary/verdict.h"
#include "studies/stability/overlay_loop.h"
#include "studies/tune/tune_page.h"
#include "studies/tune/tune_study.h"

namespace osteon::studies {
namespace {

constexpr double kMinDamping = 5.0, kMaxDamping = 1000.0, kMinWall_N_per_m = 500.0, kMaxWall_N_per_m = 100e3;
constexpr double kMaxMassOff = 0.15;  // of the measured mass, which may be along another axis
constexpr double kScan = 1.25, kTolerance = 5e-3, kMaxMargin = 3.0;

struct OverlayBoundary {
  double damping_Ns_per_m{0.0};
  double predicted_N_per_m{0.0}, simulated_N_per_m{0.0};  // 0: unstable without a wall
  std::size_t hand{0};
};

struct OverlayCheck {
  std::size_t runs{0};
  std::vector<std::string> grew{};
};

struct OverlayTuning {
  std::string cell;
  TuneTask task;
  OverlayLoopParams loop;
  std::vector<hil::GridHand> hands{};
  double mass_kg{0.0};  // of the tool along its axis
  std::optional<config::IdentifiedArm> measured{};
  double own_margin{0.0};            // 0: not stable with all
  double recommended_Ns_per_m{0.0};  // 0: none
  double recommended_N_per_m{0.0}, recommended_margin{0.0};
  double planes_N_per_m{0.0};  // stiffest planes at the task's age, at most the task's
  std::vector<OverlayBoundary> boundary{};
  OverlayCheck check{};
  [[nodiscard]] bool Stands() const { return recommended_Ns_per_m > 0.0; }
  /// Whether the recommended gains may be used: run in time, they are stable as well.
  [[nodiscard]] bool MayBeUsed() const { return Stands() && check.grew.empty(); }
  [[nodiscard]] double own_damping() const { return loop.law.damping_Ns_per_m.z(); }
};

OverlayLoopParams LoopOf(const config::CellConfig& cell) {
  const config::LbrConfig* lbr = cell.robot.lbr();  // the impedance law needs FRI, which is an LBR's
  OverlayLoopParams loop{.chain = lbr->chain,
                         .arm = cell.simulated.dynamic,
                         .X_FT = cell.tool.X_FT,
                         .q = cell.start.q,
                         .torque = cell.simulated.fri.command_mode == control::CommandMode::kTorque,
                         .law = cell.servo.impedance,
                         .period_s = cell.servo.period_s};
  loop.gravity_B = cell.X_WB.linear().transpose() * kinematics::kGravity_W_m_per_s2;
  return loop;
}

OverlayLoopParams With(const OverlayTuning& t, double damping_Ns_per_m, const hil::GridHand& hand,
                       double gain) {
  OverlayLoopParams loop = t.loop;
  // all three axes alike, as their ratio in the cell is
  if (t.own_damping() > 0.0)
    loop.law.damping_Ns_per_m *= damping_Ns_per_m / t.own_damping();
  else
    loop.law.damping_Ns_per_m.setConstant(damping_Ns_per_m);
  loop.hand = {hand.name, gain * hand.stiffness_N_per_m, gain * hand.damping_Ns_per_m, gain * hand.mass_kg};
  return loop;
}

bool Stable(const OverlayTuning& t, double damping_Ns_per_m, const hil::GridHand& hand,
            const hil::LoopWall& wall, double gain) {
  OverlayLoopParams loop = With(t, damping_Ns_per_m, hand, gain);
  loop.wall = wall;
  loop.wall.stiffness_N_per_m *= gain;
  loop.arm.dead_cycles =
      std::min(loop.arm.dead_cycles + t.task.command_jitter, hil::DynamicArm::kMaxDeadCycles);
  return OverlayLoop(loop).IsStable();
}

// At a wall of that stiffness, and free: with every hand. False as well if interrupted.
bool StandsAll(const OverlayTuning& t, double damping_Ns_per_m, double wall_N_per_m, double gain) {
  return std::ranges::all_of(t.hands, [&](const hil::GridHand& hand) {
    return !base::Interrupted() &&
           Stable(t, damping_Ns_per_m, hand, {.stiffness_N_per_m = wall_N_per_m}, gain) &&
           Stable(t, damping_Ns_per_m, hand, {}, gain);
  });
}

// The stiffest planes at the task's age with the recommended damping and every hand, up to the task's.
double PlanesAt(const OverlayTuning& t) {
  const hil::LoopWall planes = WallOf(t.task, TuneContact::kPlanes, 1.0);
  return hil::FirstCrossing(
             [&](double stiffness) {
               hil::LoopWall wall = planes;
               wall.stiffness_N_per_m = stiffness;
               return std::ranges::all_of(t.hands, [&](const hil::GridHand& hand) {
                 return !base::Interrupted() && Stable(t, t.recommended_Ns_per_m, hand, wall, 1.0);
               });
             },
             {.from = kMinWall_N_per_m,
              .to = std::max(2.0 * kMinWall_N_per_m, t.task.plane_N_per_m),
              .factor = kScan,
              .tolerance = kTolerance})
      .value;
}

double MarginOf(const OverlayTuning& t, double damping_Ns_per_m, double wall_N_per_m) {
  return hil::FirstCrossing([&](double gain) { return StandsAll(t, damping_Ns_per_m, wall_N_per_m, gain); },
                            {.from = 1.0, .to = kMaxMargin, .factor = 1.1, .tolerance = kTolerance})
      .value;
}

// The least damping with which a wall stands at gain 1 and at the margin; 0: none. Scanned upward: too much
// damping is unstable by its own delay.
double LeastDamping(const OverlayTuning& t, double wall_N_per_m) {
  const auto stands = [&](double damping) {
    return StandsAll(t, damping, wall_N_per_m, t.task.margin) && StandsAll(t, damping, wall_N_per_m, 1.0);
  };
  double high = kMinDamping;
  while (!stands(high)) {
    if (high >= kMaxDamping || base::Interrupted()) return 0.0;
    high *= kScan;
  }
  double low = high / kScan;
  while (high - low > 0.02 * low) {
    const double middle = 0.5 * (low + high);
    (stands(middle) ? high : low) = middle;
  }
  return high;
}

OverlayBoundary BoundaryAt(const OverlayTuning& t, double damping_Ns_per_m) {
  OverlayBoundary boundary{.damping_Ns_per_m = damping_Ns_per_m, .predicted_N_per_m = kMaxWall_N_per_m};
  OverlayLoopParams loop;
  const auto most = [&](const hil::GridHand& hand, const auto& stable) {
    loop = With(t, damping_Ns_per_m, hand, 1.0);
    loop.wall = {};
    if (!stable(loop)) return 0.0;
    return hil::FirstCrossing(
               [&](double stiffness) {
                 loop.wall.stiffness_N_per_m = stiffness;
                 return !base::Interrupted() && stable(loop);
               },
               {.from = kMinWall_N_per_m, .to = kMaxWall_N_per_m, .factor = kScan, .tolerance = kTolerance})
        .value;
  };
  for (std::size_t i = 0; i < t.hands.size(); ++i) {
    const double found =
        most(t.hands[i], [](const OverlayLoopParams& p) { return OverlayLoop(p).IsStable(); });
    if (i > 0 && found >= boundary.predicted_N_per_m) continue;
    boundary.predicted_N_per_m = found;
    boundary.hand = i;
  }
  boundary.simulated_N_per_m =
      most(t.hands[boundary.hand], [](const OverlayLoopParams& p) { return !OverlayGrows(p); });
  return boundary;
}

OverlayCheck CheckInTime(const OverlayTuning& t, int threads) {
  struct Case {
    const hil::GridHand* hand;
    TuneContact contact;
    bool grew{false};
  };
  std::vector<Case> cases;
  for (const TuneContact contact : {TuneContact::kFree, TuneContact::kWall})
    for (const hil::GridHand& hand : t.hands) cases.push_back({.hand = &hand, .contact = contact});
  TuneTask task = t.task;
  task.wall_N_per_m = t.recommended_N_per_m;
  simulation::ParallelFor(
      cases.size(), threads,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end && !base::Interrupted(); ++i) {
          OverlayLoopParams loop = With(t, t.recommended_Ns_per_m, *cases[i].hand, 1.0);
          loop.wall = WallOf(task, cases[i].contact, 1.0);
          cases[i].grew = OverlayGrows(loop);
        }
      },
      1);
  OverlayCheck check{.runs = cases.size()};
  for (const Case& c : cases)
    if (c.grew) check.grew.push_back(fmt::format("{}, {}", c.hand->name, NameOf(c.contact)));
  return check;
}

// The cell's own gains if they stand, else the least damping for its own stiffness, else the stiffest of
// those below that has one.
void Recommend(OverlayTuning& t) {
  if (t.own_margin >= t.task.margin && t.own_damping() > 0.0) {
    t.recommended_N_per_m = t.task.wall_N_per_m;
    t.recommended_Ns_per_m = t.own_damping();
    t.recommended_margin = t.own_margin;
    t.planes_N_per_m = PlanesAt(t);
    return;
  }
  for (double wall_N_per_m = t.task.wall_N_per_m; wall_N_per_m >= kMinWall_N_per_m; wall_N_per_m *= 0.8) {
    const double damping = LeastDamping(t, wall_N_per_m);
    if (damping == 0.0) continue;
    t.recommended_N_per_m = wall_N_per_m;
    t.recommended_Ns_per_m = std::ceil(damping);
    t.recommended_margin = MarginOf(t, t.recommended_Ns_per_m, wall_N_per_m);
    t.planes_N_per_m = PlanesAt(t);
    return;
  }
}

void StudyAll(const TuneOptions& options, base::PhaseProgress& progress, OverlayTuning& t) {
  progress.BeginPhase("the cell's own gains, and the least damping");
  t.mass_kg = OverlayLoop(t.loop).mass_kg();
  t.own_margin = MarginOf(t, t.own_damping(), t.task.wall_N_per_m);
  Recommend(t);
  progress.BeginPhase("boundaries, predicted and simulated");
  t.boundary.resize(static_cast<std::size_t>(options.dampings));
  simulation::ParallelFor(
      t.boundary.size(), options.threads,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end && !base::Interrupted(); ++i)
          t.boundary[i] =
              BoundaryAt(t, kMinDamping * std::pow(kMaxDamping / kMinDamping,
                                                   static_cast<double>(i) / (options.dampings - 1)));
      },
      1);
  progress.BeginPhase("the recommended gains, run in time");
  if (t.Stands() && !base::Interrupted()) t.check = CheckInTime(t, options.threads);
}

session::Verdict Judge(const OverlayTuning& t) {
  session::Verdict verdict;
  if (!t.Stands()) {
    verdict.Add(session::VerdictLevel::kBad, "no stiffness and damping stand what was asked");
    return verdict;
  }
  if (!t.check.grew.empty())
    verdict.Add(session::VerdictLevel::kBad,
                fmt::format("run in time with the recommended gains, {} of {} runs grew: {}",
                            t.check.grew.size(), t.check.runs, fmt::join(t.check.grew, "; ")));
  if (t.recommended_N_per_m < t.task.wall_N_per_m)
    verdict.Add(session::VerdictLevel::kWarning,
                fmt::format("the cell's coupling of {:g} N/mm stands with no damping, {:.3g} N/mm does",
                            1e-3 * t.task.wall_N_per_m, 1e-3 * t.recommended_N_per_m));
  if (t.planes_N_per_m < t.task.plane_N_per_m)
    verdict.Add(
        session::VerdictLevel::kWarning,
        fmt::format("planes that move with the tool and are {:g} ms old stand {:.3g} N/mm of the {:.3g} "
                    "that the force limit over the head's radius makes: across the contact press with "
                    "at most {:.0f} % of the force limit, or keep the model younger",
                    1e3 * t.task.worst_age_s, 1e-3 * t.planes_N_per_m, 1e-3 * t.task.plane_N_per_m,
                    100.0 * t.planes_N_per_m / t.task.plane_N_per_m));
  if (t.measured && !(std::abs(*t.measured->felt_mass_kg / t.mass_kg - 1.0) <= kMaxMassOff))
    verdict.Add(
        session::VerdictLevel::kWarning,
        fmt::format("a force was measured to move {:.2f} kg along {}, and the arm's masses give {:.2f} "
                    "kg along z: the tool's mass, or the robot's file, is off",
                    *t.measured->felt_mass_kg, t.measured->axis, t.mass_kg));
  if (!(t.own_margin >= t.task.margin))
    verdict.Add(
        session::VerdictLevel::kWarning,
        t.own_margin > 0.0
            ? fmt::format("the cell's own gains have a gain margin of {:.2f}, {:g} asked for", t.own_margin,
                          t.task.margin)
            : std::string("the cell's own gains are not stable with all of these hands and contacts"));
  return verdict;
}

std::vector<report::SummaryRow> Rows(const OverlayTuning& t) {
  const TuneTask& task = t.task;
  std::vector<report::SummaryRow> rows{
      {"Cell",
       fmt::format(
           "{}: impedance law, overlay of {}, {:g} ms dead time, {:.2f} kg along the tool without the "
           "hand, period {:g} ms",
           t.cell, t.loop.torque ? "torques" : "a wrench", 1e3 * t.loop.arm.dead_cycles * t.loop.period_s,
           t.mass_kg, 1e3 * t.loop.period_s)},
      {"Must be stable with",
       fmt::format("hands up to {:g} N/m, free and at a wall of {:g} N/mm; {:g} ms jitter; gain margin {:g}",
                   task.human_grip_N_per_m, 1e-3 * task.wall_N_per_m,
                   1e3 * task.command_jitter * t.loop.period_s, task.margin)},
      {"The cell's own gains",
       fmt::format("coupling {:g} N/mm, damping {:.0f} N s/m: {}", 1e-3 * task.wall_N_per_m, t.own_damping(),
                   t.own_margin > 0.0 ? fmt::format("gain margin {:.2f}", t.own_margin)
                                      : std::string("not stable with all of these"))},
      {"Recommended",
       t.Stands() ? fmt::format("coupling {:.3g} N/mm, damping {:.0f} N s/m, gain margin {:.2f}",
                                1e-3 * t.recommended_N_per_m, t.recommended_Ns_per_m, t.recommended_margin)
                  : std::string("none")}};
  if (t.measured)
    rows.push_back(
        {"Measured arm",
         fmt::format("along {}: a force moves {:.2f} kg, with {:.2f} Hz and damping {:.2f} of the arm's "
                     "own impedance, after {:.2f} ms",
                     t.measured->axis, *t.measured->felt_mass_kg, t.measured->bandwidth_hz,
                     t.measured->damping_ratio, 1e3 * t.measured->dead_time_s)});
  if (t.Stands())
    rows.push_back({"Old planes", fmt::format("{}{:.3g} N/mm at {:g} ms",
                                              t.planes_N_per_m < task.plane_N_per_m ? "" : "at least ",
                                              1e-3 * t.planes_N_per_m, 1e3 * task.worst_age_s)});
  if (t.check.runs > 0)
    rows.push_back({"Simulated", t.check.grew.empty()
                                     ? fmt::format("{} runs of the arm with masses; none grew", t.check.runs)
                                     : fmt::format("in {} of {} runs it grew: {}", t.check.grew.size(),
                                                   t.check.runs, fmt::join(t.check.grew, "; "))});
  return rows;
}

std::string GainsYaml(const OverlayTuning& t, const std::string& command_line) {
  return fmt::format(
      "# {}\n# Stands hands up to {:g} N/m with gain margin {:.2f}. For: osteon run CELL.yaml --gains "
      "THIS_FILE\n"
      "# The law's damping is a key of the cell: impedance: damping_Ns_per_m: [{b:.10g}, {b:.10g}, "
      "{b:.10g}]\n"
      "coupling:\n  stiffness_N_per_mm: {:.10g}\n",
      command_line, t.task.human_grip_N_per_m, t.recommended_margin, 1e-3 * t.recommended_N_per_m,
      fmt::arg("b", t.recommended_Ns_per_m));
}

std::string ToJson(const OverlayTuning& t, const std::string& command_line) {
  const TuneTask& task = t.task;
  nlohmann::json json{{"schema", "osteon.tune/1"},
                      {"subcommand", "tune"},
                      {"command_line", command_line},
                      {"cell", t.cell},
                      {"law", "impedance"},
                      {"arm",
                       {{"mass_kg", t.mass_kg},
                        {"dead_cycles", t.loop.arm.dead_cycles},
                        {"overlay", t.loop.torque ? "torque" : "wrench"},
                        {"period_ms", 1e3 * t.loop.period_s}}},
                      {"stands",
                       {{"grip_N_per_m", task.human_grip_N_per_m},
                        {"wall_N_per_m", task.wall_N_per_m},
                        {"plane_N_per_m", task.plane_N_per_m},
                        {"worst_age_ms", 1e3 * task.worst_age_s},
                        {"jitter_ms", 1e3 * task.command_jitter * t.loop.period_s}}},
                      {"margin", task.margin},
                      {"identified", t.measured.has_value()},
                      {"own",
                       {{"damping_Ns_per_m", t.own_damping()},
                        {"stiffness_N_per_m", task.wall_N_per_m},
                        {"margin", t.own_margin}}},
                      {"recommended", nullptr},
                      {"boundary", nlohmann::json::array()},
                      {"check", {{"runs", t.check.runs}, {"grew", t.check.grew}}}};
  if (t.Stands())
    json["recommended"] = {{"damping_Ns_per_m", t.recommended_Ns_per_m},
                           {"stiffness_N_per_m", t.recommended_N_per_m},
                           {"margin", t.recommended_margin},
                           {"planes_N_per_m", t.planes_N_per_m}};
  for (const OverlayBoundary& b : t.boundary)
    json["boundary"].push_back({{"damping", b.damping_Ns_per_m},
                                {"stiffness_predicted", b.predicted_N_per_m},
                                {"stiffness_simulated", b.simulated_N_per_m},
                                {"hand", t.hands[b.hand].name}});
  return session::ResultText(Judge(t), json);
}

std::string BoundarySvg(const OverlayTuning& t) {
  report::LineChart chart{.title = "Greatest wall stiffness with the impedance law",
                          .x_label = "damping of the law [N s/m]",
                          .y_label = "stiffness of the wall [kN/m]",
                          .y_from_zero = false,
                          .log_x = true,
                          .log_y = true,
                          .plot_height_px = 330.0};
  report::Series predicted{.name = "predicted", .width_px = 2.0};
  report::Series simulated{.name = "simulated", .width_px = 0.0, .marker = report::Marker::kRing};
  const auto shown = [](double N_per_m) {
    return N_per_m > 0.0 ? 1e-3 * N_per_m : std::numeric_limits<double>::quiet_NaN();
  };
  for (const OverlayBoundary& b : t.boundary) {
    predicted.x.push_back(b.damping_Ns_per_m);
    predicted.y.push_back(shown(b.predicted_N_per_m));
    simulated.x.push_back(b.damping_Ns_per_m);
    simulated.y.push_back(shown(b.simulated_N_per_m));
  }
  chart.series = {predicted, simulated};
  if (t.Stands())
    chart.series.push_back({.name = "recommended",
                            .x = {t.recommended_Ns_per_m},
                            .y = {1e-3 * t.recommended_N_per_m},
                            .color = "#d55e00",
                            .width_px = 0.0,
                            .marker = report::Marker::kDiamond});
  chart.limits = {{.value = 1e-3 * t.task.wall_N_per_m, .label = "the cell's wall"}};
  return report::Svg(chart);
}

report::ReportVerdict PlainVerdict(const OverlayTuning& t) {
  const session::Verdict verdict = Judge(t);
  report::ReportVerdict plain = verdict.ForReport();
  std::vector<std::string> reasons;
  if (!t.Stands() || verdict.level == session::VerdictLevel::kBad) {
    plain.text = "Not safe";
  } else {
    plain.text = fmt::format("{}: coupling {:.3g} N/mm with damping {:.0f} N s/m",
                             verdict.level == session::VerdictLevel::kGood ? "Safe" : "Safe, with remarks",
                             1e-3 * t.recommended_N_per_m, t.recommended_Ns_per_m);
    reasons.push_back(fmt::format(
        "Why: the loop stays stable with every hand up to {:g} N/m, free and at the wall, {:.2f} times as "
        "stiff and heavy. The arm's dead time and its own damping are {}.",
        t.task.human_grip_N_per_m, t.recommended_margin, t.measured ? "measured" : "assumed, not measured"));
  }
  for (const std::string& reason : verdict.reasons) reasons.push_back("Remark: " + reason + ".");
  reasons.push_back(t.MayBeUsed()
                        ? fmt::format("Next: run with `osteon run {} --gains gains.yaml`, and set the law's "
                                      "damping in the cell's file (its comment says how).",
                                      t.cell)
                        : std::string("Next: soften the coupling, or ask for less (--grip, --margin)."));
  plain.reasons = std::move(reasons);
  return plain;
}

tl::expected<void, std::string> Write(const OverlayTuning& t, const TuneOptions& options) {
  const std::string svg = BoundarySvg(t), json = ToJson(t, options.command_line);
  if (const auto written = session::WriteDrawing(svg, options.out / "tune"); !written) return written;
  std::string csv = "damping_Ns_per_m,predicted_N_per_m,simulated_N_per_m\n";
  for (const OverlayBoundary& b : t.boundary)
    csv +=
        fmt::format("{:.3f},{:.0f},{:.0f}\n", b.damping_Ns_per_m, b.predicted_N_per_m, b.simulated_N_per_m);
  if (const auto written = base::WriteText(options.out / "tune.csv", csv); !written) return written;
  if (const auto written = base::WriteText(options.out / "tune.json", json); !written) return written;
  if (const auto written = WriteGains(options.out, t.MayBeUsed() ? GainsYaml(t, options.command_line) : "");
      !written)
    return written;
  if (!options.json.empty())
    if (const auto written = base::WriteText(options.json, json); !written) return written;
  std::string html =
      report::PageBegin({.title = "Gains for " + t.cell, .verdict = PlainVerdict(t), .summary = Rows(t)});
  html += "<h2>How stiff a wall may be</h2>\n" +
          report::Figure(
              svg,
              "The stiffest wall with the worst hand. Damping beyond the line's right end oscillates by its "
              "own delay, whatever the wall.");
  if (t.MayBeUsed())
    html += "<h2>The recommended gains, as a file (gains.yaml)</h2>\n<pre>" +
            report::Escape(GainsYaml(t, options.command_line)) + "</pre>\n";
  html += "<h2>How to repeat it</h2>\n<pre>" + report::Escape(options.command_line) + "</pre>\n" +
          report::PageEnd();
  return report::WritePage(html, options.out / "tune.html");
}

}  // namespace

int RunTuneImpedance(const TuneOptions& options, const config::CellConfig& cell) {
  if (options.sharding.shard || options.sharding.parts != nullptr)
    return session::Fail("tune", "--shard: found with the impedance law, accepted with the admittance law");
  if (!options.plan.empty())
    return session::Fail("tune", "--plan: found with the impedance law, accepted with the admittance law");
  OverlayTuning t{.cell = options.cell.stem().string(), .task = TuneTaskOf(cell), .loop = LoopOf(cell)};
  if (cell.identified)
    for (const config::IdentifiedArm& arm : cell.identified->arm)
      if (arm.felt_mass_kg && (!t.measured || arm.dead_time_s > t.measured->dead_time_s)) t.measured = arm;
  const double period_s = t.loop.period_s,
               jitter = options.jitter_ms.value_or(1e3 * period_s) / (1e3 * period_s);
  if (std::abs(jitter - std::round(jitter)) > 1e-6)
    return session::Fail(
        "tune", fmt::format("--jitter-ms: found {:g}, accepted a multiple of the cell's period, {:g} ms",
                            *options.jitter_ms, 1e3 * period_s));
  t.task.command_jitter = static_cast<int>(std::lround(jitter));
  t.task.worst_age_s = 1e-3 * options.worst_age_ms;
  t.task.margin = options.margin;
  t.task.human_grip_N_per_m = options.human_grip_N_per_m;
  t.hands = HandsUpTo(t.task.human_grip_N_per_m);
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  if (error) return session::Fail("tune", options.out.string() + ": " + error.message(), session::kFailed);

  base::InstallInterrupt();
  base::PhaseProgress progress("osteon tune", 3);
  StudyAll(options, progress, t);
  progress.Done();
  if (base::Interrupted()) return base::kExitInterrupted;
  if (const auto written = Write(t, options); !written)
    return session::Fail("tune", written.error(), session::kFailed);
  const session::Verdict verdict = Judge(t);
  session::PrintVerdict(verdict, 26);
  for (const report::SummaryRow& row : Rows(t)) fmt::print("  {:<26} {}\n", row.key, row.value);
  fmt::print("  {:<26} {}\n", "Report", (options.out / "tune.html").string());
  return verdict.level == session::VerdictLevel::kBad ? session::kFailed : 0;
}

}  // namespace osteon::studies
