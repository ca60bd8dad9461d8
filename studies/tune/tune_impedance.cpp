#include "studies/tune/tune_impedance.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/interrupt.h"
#include "base/parallel.h"
#include "base/phase_progress.h"
#include "session/process/exit_code.h"
#include "studies/tune/overlay_tuning.h"
#include "studies/tune/tune_measured.h"

namespace osteon::studies {
namespace {

// Ranges in which boundaries are searched: the law's damping [N s/m], and the wall's stiffness.
constexpr double kMinDamping = 5.0, kMaxDamping = 1000.0, kMinWall_N_per_m = 500.0, kMaxWall_N_per_m = 100e3;
// ratio between a search's steps; relative tolerance at which the search ends
constexpr double kScan = 1.25, kTolerance = 5e-3;
constexpr double kMaxMargin = 3.0;  // gain margins are searched up to this factor

// The loop of a cell with an LBR at the cell's start posture, without hand and wall.
OverlayLoopParams LoopOf(const config::CellConfig& cell) {
  // never null: the impedance law needs FRI, and an arm with FRI is an LBR
  const config::LbrConfig* lbr = cell.robot.lbr();
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

// The cell's loop with this damping, and with a hand whose stiffness, damping and mass are multiplied by
// `gain`; without a wall.
OverlayLoopParams LoopWith(const OverlayTuning& t, double damping_Ns_per_m, const hil::GridHand& hand,
                           double gain) {
  OverlayLoopParams loop = t.loop;
  // Scale the damping of all three axes, so that their ratio stays as in the cell's file.
  if (t.own_damping() > 0.0)
    loop.law.damping_Ns_per_m *= damping_Ns_per_m / t.own_damping();
  else
    loop.law.damping_Ns_per_m.setConstant(damping_Ns_per_m);
  loop.hand = {hand.name, gain * hand.stiffness_N_per_m, gain * hand.damping_Ns_per_m, gain * hand.mass_kg};
  return loop;
}

// Largest additional delay of a command beyond the measured delay [s].
double MaxExtraDelay_s(const OverlayTuning& t) { return t.task.command_jitter * t.loop.period_s; }

// Whether the loop is stable with the arm's model, and with the measured response if there is one. Hand and
// wall are multiplied by `gain`. Every command has the largest possible delay.
bool IsStableWith(const OverlayTuning& t, double damping_Ns_per_m, const hil::GridHand& hand,
                  const hil::LoopWall& wall, double gain) {
  OverlayLoopParams loop = LoopWith(t, damping_Ns_per_m, hand, gain);
  loop.wall = wall;
  loop.wall.stiffness_N_per_m *= gain;
  OverlayLoopParams late = loop;
  late.arm.dead_cycles =
      std::min(loop.arm.dead_cycles + t.task.command_jitter, hil::DynamicArm::kMaxDeadCycles);
  return OverlayLoop(late).IsStable() && IsStableAsMeasured(t.response, loop, MaxExtraDelay_s(t));
}

// Whether the loop is stable with every hand, both free and at a wall of this stiffness. False also after an
// interrupt.
bool IsStable(const OverlayTuning& t, double damping_Ns_per_m, double wall_N_per_m, double gain) {
  return std::ranges::all_of(t.hands, [&](const hil::GridHand& hand) {
    return !base::Interrupted() &&
           IsStableWith(t, damping_Ns_per_m, hand, {.stiffness_N_per_m = wall_N_per_m}, gain) &&
           IsStableWith(t, damping_Ns_per_m, hand, {}, gain);
  });
}

// The largest stiffness of contact planes at the task's age that is stable with the recommended damping and
// every hand. The search ends at the task's own plane stiffness.
double PlanesAt(const OverlayTuning& t) {
  const hil::LoopWall planes = WallOf(t.task, TuneContact::kPlanes, 1.0);
  return hil::FirstCrossing(
             [&](double stiffness) {
               hil::LoopWall wall = planes;
               wall.stiffness_N_per_m = stiffness;
               return std::ranges::all_of(t.hands, [&](const hil::GridHand& hand) {
                 return !base::Interrupted() && IsStableWith(t, t.recommended_Ns_per_m, hand, wall, 1.0);
               });
             },
             {.from = kMinWall_N_per_m,
              .to = std::max(2.0 * kMinWall_N_per_m, t.task.plane_N_per_m),
              .factor = kScan,
              .tolerance = kTolerance})
      .value;
}

// The largest factor on hands and wall, between 1 and kMaxMargin, up to which the loop is stable. 0: unstable
// even at factor 1.
double MarginOf(const OverlayTuning& t, double damping_Ns_per_m, double wall_N_per_m) {
  return hil::FirstCrossing([&](double gain) { return IsStable(t, damping_Ns_per_m, wall_N_per_m, gain); },
                            {.from = 1.0, .to = kMaxMargin, .factor = 1.1, .tolerance = kTolerance})
      .value;
}

// The least damping with which this wall is stable at gain 1 and at the task's margin; 0: none. The search
// goes upward, because the loop's delay makes too much damping unstable as well.
double LeastDamping(const OverlayTuning& t, double wall_N_per_m) {
  const auto stands = [&](double damping) {
    return IsStable(t, damping, wall_N_per_m, t.task.margin) && IsStable(t, damping, wall_N_per_m, 1.0);
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

// Finds the worst hand with the linear loop, then simulates the boundary with this hand.
OverlayBoundary BoundaryAt(const OverlayTuning& t, double damping_Ns_per_m) {
  OverlayBoundary boundary{.damping_Ns_per_m = damping_Ns_per_m, .predicted_N_per_m = kMaxWall_N_per_m};
  OverlayLoopParams loop;
  // stiffest wall that is stable with a hand; 0: unstable without a wall
  const auto max_wall = [&](const hil::GridHand& hand, const auto& stable) {
    loop = LoopWith(t, damping_Ns_per_m, hand, 1.0);
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
        max_wall(t.hands[i], [](const OverlayLoopParams& p) { return OverlayLoop(p).IsStable(); });
    if (i > 0 && found >= boundary.predicted_N_per_m) continue;
    boundary.predicted_N_per_m = found;
    boundary.hand = i;
  }
  boundary.simulated_N_per_m =
      max_wall(t.hands[boundary.hand], [](const OverlayLoopParams& p) { return !OverlayGrows(p); });
  return boundary;
}

// Simulates the recommended gains with every hand, both free and at the recommended wall.
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
          OverlayLoopParams loop = LoopWith(t, t.recommended_Ns_per_m, *cases[i].hand, 1.0);
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

// One case for each hand, both free and at the wall, with these gains.
std::vector<OverlayCase> CasesOf(const OverlayTuning& t, double damping_Ns_per_m, double wall_N_per_m) {
  TuneTask task = t.task;
  task.wall_N_per_m = wall_N_per_m;
  std::vector<OverlayCase> cases;
  for (const TuneContact contact : {TuneContact::kFree, TuneContact::kWall})
    for (const hil::GridHand& hand : t.hands) {
      cases.push_back({.loop = LoopWith(t, damping_Ns_per_m, hand, 1.0), .contact = contact});
      cases.back().loop.wall = WallOf(task, contact, 1.0);
    }
  return cases;
}

// Judges the cell's own and the recommended gains by the measured response: computes their margins and the
// Nyquist plot.
void JudgeByResponse(OverlayTuning& t) {
  std::vector<OverlayCase> own = CasesOf(t, t.own_damping(), t.task.wall_N_per_m), recommended;
  if (t.HasRecommendation()) recommended = CasesOf(t, t.recommended_Ns_per_m, t.recommended_N_per_m);
  for (const auto& [name, cases] : {std::pair{"recommended", &recommended}, {"own", &own}}) {
    const std::vector<TuneMargin> found = MeasuredMargins(t.response, name, *cases, MaxExtraDelay_s(t));
    t.margins.insert(t.margins.end(), found.begin(), found.end());
  }
  std::vector<NamedCurve> named;
  for (const auto& [name, cases] : {std::pair{"recommended", &recommended}, {"own", &own}})
    if (const TuneMargin* worst = WorstOf(t.margins, name))
      named.push_back({.worst = worst, .curve = WorstCurve(t.response, *worst, *cases, MaxExtraDelay_s(t))});
  if (!named.empty()) t.nyquist_svg = NyquistSvg(named);
}

// Recommends the first of these that has the task's margin:  1. the cell's own damping and stiffness,  2. the
// cell's own stiffness with the least damping,  3. the largest smaller stiffness that some damping makes
// stable, with the least damping.
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

// Copies the measured figures into the task. The arm's dead time and springs are in the cell already
// (config::ApplyIdentified).
void UseIdentified(const config::IdentifiedCell& identified, const TuneOptions& options, OverlayTuning& t) {
  t.task.identified = identified;
  for (const config::IdentifiedArm& arm : identified.arm) {
    if (!arm.felt_mass_kg) continue;
    if (!t.measured || arm.dead_time_s > t.measured->dead_time_s) t.measured = arm;
    if (arm.axis == "z") t.along_tool_kg = *arm.felt_mass_kg;
    t.on_mount |= arm.impedance && arm.impedance->on_mount;
  }
  // The measured dead time includes the mean of the jitter, so only the jitter beyond its mean is added.
  // Without a measured dead time, the jitter stays assumed.
  if (identified.link && t.measured && !options.jitter_ms)
    t.task.command_jitter = JitterOf(*identified.link, t.loop.period_s);
  UseHands(identified, t.task);
  t.response = MeasuredAxesOf(identified, t.loop);
}

// Computes all results: margin, recommended gains, boundaries, check in time and measured margins.
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
  if (t.HasRecommendation() && !base::Interrupted()) t.check = CheckInTime(t, options.threads);
  if (!base::Interrupted()) JudgeByResponse(t);
}

}  // namespace

int RunTuneImpedance(const TuneOptions& options, const config::CellConfig& cell) {
  if (options.sharding.shard || options.sharding.parts != nullptr)
    return session::Fail("tune", "--shard: found with the impedance law, accepted with the admittance law");
  if (!options.plan.empty())
    return session::Fail("tune", "--plan: found with the impedance law, accepted with the admittance law");
  OverlayTuning t{.cell = options.cell.stem().string(), .task = TuneTaskOf(cell), .loop = LoopOf(cell)};
  const double period_s = t.loop.period_s,
               jitter = options.jitter_ms.value_or(1e3 * period_s) / (1e3 * period_s);
  if (std::abs(jitter - std::round(jitter)) > 1e-6)
    return session::Fail(
        "tune", fmt::format("--jitter-ms: found {:g}, accepted a multiple of the cell's period, {:g} ms",
                            *options.jitter_ms, 1e3 * period_s));
  t.task.command_jitter = static_cast<int>(std::lround(jitter));
  if (cell.identified) UseIdentified(*cell.identified, options, t);
  t.task.worst_age_s = 1e-3 * options.worst_age_ms;
  t.task.margin = options.margin;
  t.task.human_grip_N_per_m = options.human_grip_N_per_m;
  t.hands = HandsUpTo(t.task, t.task.human_grip_N_per_m);
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
