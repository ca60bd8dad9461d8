#include "studies/tune/tune_study.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "simulation/tools/tool.h"
#include "studies/tune/tune_measured.h"

namespace osteon::studies {
namespace {

constexpr double kMaxDrag_Ns_per_m = 3000.0;  // largest drag that is tried
constexpr double kMinWall_N_per_m = 100.0;    // softest wall that is tried
// Figures of the runs with the vibration index: the tool's speed when a stiff hand closes its grip, the
// sensor's noise, and the length of a stiff hand's run.
constexpr double kGripSpeed_m_per_s = 0.04, kNoise_N = 0.1, kStiffHandRun_s = 10.0;
// A run with a stiff hand counts as calm if its force between 5 and 40 Hz stays below kEnlarged times the
// tremor that the index permits, or below kCalm_N if that is larger.
constexpr double kCalm_N = 0.5, kEnlarged = 2.2;

// The task's largest age of a contact model, rounded up to whole ticks.
int WorstAge(const TuneTask& task) {
  return static_cast<int>(std::ceil(task.worst_age_s / task.loop.period_s - 1e-9));
}

// The task's loop with these gains, and with a hand whose stiffness, damping and mass are multiplied by
// `gain`; without a wall.
hil::AdmittanceLoopParams LoopOf(const TuneTask& task, const TuneGains& gains, const hil::GridHand& hand,
                                 double gain) {
  hil::AdmittanceLoopParams loop = task.loop;
  loop.mass_kg = gains.mass_kg;
  loop.damping_Ns_per_m = gains.damping_Ns_per_m;
  loop.hand = {hand.name, gain * hand.stiffness_N_per_m, gain * hand.damping_Ns_per_m, gain * hand.mass_kg};
  return loop;
}

// Parameters of a simulated run with lost and late commands, noise, and the cell's vibration index.
AdmittanceRunParams WithIndex(const TuneTask& task, const TuneGains& gains, const hil::GridHand& hand,
                              TuneContact contact) {
  AdmittanceRunParams run{.loop = LoopOf(task, gains, hand, 1.0),
                          .command_loss = task.command_loss,
                          .command_jitter = task.command_jitter,
                          .noise_N = kNoise_N,
                          .vibration = task.vibration};
  run.loop.wall = WallOf(task, contact, 1.0);
  return run;
}

// Dead time [periods] if a command has its largest delay. Lost commands are only simulated, because the
// linear analysis has no random events.
double LatestDeadCycles(const TuneTask& task) { return task.loop.arm.dead_cycles + task.command_jitter; }

}  // namespace

const char* NameOf(TuneContact contact) {
  if (contact == TuneContact::kFree) return "free";
  return contact == TuneContact::kWall ? "wall" : "planes";
}

hil::LoopWall WallOf(const TuneTask& task, TuneContact contact, double gain) {
  if (contact == TuneContact::kFree) return {};
  // the coupling's own damping is limited to a part of the force, so the analysis ignores it
  if (contact == TuneContact::kWall) return {.stiffness_N_per_m = gain * task.wall_N_per_m};
  return {.stiffness_N_per_m = gain * task.plane_N_per_m, .age_ticks = WorstAge(task)};
}

TuneTask TuneTaskOf(const config::CellConfig& cell) {
  TuneTask task;
  task.loop.arm = cell.simulated.servo;
  task.loop.period_s = cell.servo.period_s;
  task.loop.mass_kg = cell.servo.admittance.mass_kg.z();
  task.loop.damping_Ns_per_m = cell.servo.admittance.damping_Ns_per_m.z();
  task.wall_N_per_m = cell.servo.coupling.max_stiffness_N_per_m;
  const simulation::ToolBall* head = simulation::CuttingHead(cell.tool.tool);
  const double radius_m = head ? head->radius_m : cell.tool.tool.balls.front().radius_m;
  task.plane_N_per_m = cell.servo.wrench.max_force_N / radius_m;
  task.vibration = cell.servo.vibration;
  task.index_acts = task.vibration.acts;
  task.vibration.acts = true;
  return task;
}

std::vector<hil::GridHand> HandsUpTo(double stiffness_N_per_m) {
  std::vector<hil::GridHand> hands = hil::HandGrid();
  std::erase_if(hands, [&](const hil::GridHand& hand) { return hand.stiffness_N_per_m > stiffness_N_per_m; });
  hands.push_back({fmt::format("{:g} N/m, firm", stiffness_N_per_m), stiffness_N_per_m, 20.0, 1.5});
  // the stiffest hands come first, because they are the most likely to be unstable: the test then ends early
  std::ranges::stable_sort(hands, std::ranges::greater{}, &hil::GridHand::stiffness_N_per_m);
  return hands;
}

std::vector<hil::GridHand> HandsUpTo(const TuneTask& task, double stiffness_N_per_m) {
  std::vector<hil::GridHand> hands = HandsUpTo(stiffness_N_per_m);
  hands.insert(hands.end(), task.measured_hands.begin(), task.measured_hands.end());
  std::ranges::stable_sort(hands, std::ranges::greater{}, &hil::GridHand::stiffness_N_per_m);
  return hands;
}

bool IsStable(const TuneTask& task, const TuneGains& gains, const std::vector<hil::GridHand>& hands,
              double gain) {
  if (task.measured_only) return IsStableAsMeasured(task, gains, hands, gain);
  for (const TuneContact contact : kTuneContacts)
    for (const hil::GridHand& hand : hands) {
      hil::AdmittanceLoopParams loop = LoopOf(task, gains, hand, gain);
      loop.arm.dead_cycles = LatestDeadCycles(task);
      loop.wall = WallOf(task, contact, gain);
      if (!(hil::AdmittanceLoop(loop).SpectralRadius() < 1.0)) return false;
    }
  return true;
}

bool IsStable(const TuneTask& task, const TuneGains& gains, const std::vector<hil::GridHand>& hands) {
  return IsStable(task, gains, hands, task.margin) && IsStable(task, gains, hands, 1.0);
}

double GainMargin(const TuneTask& task, const TuneGains& gains, const std::vector<hil::GridHand>& hands,
                  double max_gain) {
  return hil::FirstCrossing([&](double gain) { return IsStable(task, gains, hands, gain); },
                            {.from = 1.0, .to = max_gain, .factor = 1.1, .tolerance = 1e-3})
      .value;
}

double MinDragFor(const TuneTask& task, double mass_kg, const std::vector<hil::GridHand>& hands) {
  // searches upward in 1 / drag, thus from the largest drag down: the first crossing is the lower end of the
  // range of drags that are all stable
  const hil::Boundary found = hil::FirstCrossing(
      [&](double inverse) {
        return IsStable(task, {.mass_kg = mass_kg, .damping_Ns_per_m = 1.0 / inverse}, hands);
      },
      {.from = 1.0 / kMaxDrag_Ns_per_m, .to = 1.0, .factor = 1.25, .tolerance = 2e-3});
  if (found.value == 0.0) return std::numeric_limits<double>::infinity();
  return 1.0 / found.value;
}

TuneBoundary BoundaryAt(const TuneTask& task, const TuneGains& gains, const std::vector<hil::GridHand>& hands,
                        double max_N_per_m) {
  TuneBoundary boundary{.damping_Ns_per_m = gains.damping_Ns_per_m, .predicted_N_per_m = max_N_per_m};
  for (std::size_t i = 0; i < hands.size(); ++i) {
    const hil::AdmittanceLoopParams loop = LoopOf(task, gains, hands[i], 1.0);
    double max_wall = 0.0;
    if (hil::AdmittanceLoop(loop).SpectralRadius() < 1.0)
      max_wall =
          hil::MaxWallStiffness(loop, {.from = kMinWall_N_per_m, .to = max_N_per_m, .factor = 1.1}).value;
    if (i > 0 && max_wall >= boundary.predicted_N_per_m) continue;
    boundary.predicted_N_per_m = max_wall;
    boundary.hand = i;
  }

  AdmittanceRunParams run{.loop = LoopOf(task, gains, hands[boundary.hand], 1.0)};
  // the simulated boundary, searched from min_share to 1.6 times the predicted boundary; 0: unstable without
  // a wall
  const auto simulated = [&](double min_share) {
    if (SimulatedGrowth(run) >= 0.0) return 0.0;
    const double center = std::max(boundary.predicted_N_per_m, 10.0 * kMinWall_N_per_m);
    AdmittanceRunParams walls = run;
    return SimulatedMaxWallStiffness(walls, {.from = std::max(kMinWall_N_per_m, min_share * center),
                                             .to = std::min(max_N_per_m, 1.6 * center),
                                             .factor = 1.08,
                                             .tolerance = 2e-3})
        .value;
  };
  boundary.simulated_N_per_m = simulated(0.6);
  run.command_loss = task.command_loss;
  run.command_jitter = task.command_jitter;
  boundary.degraded_N_per_m = simulated(0.2);
  return boundary;
}

double DecayRate(const TuneTask& task, const TuneGains& gains, const std::vector<hil::GridHand>& hands,
                 double wall_N_per_m) {
  double worst = 0.0;
  for (const hil::GridHand& hand : hands) {
    hil::AdmittanceLoopParams loop = LoopOf(task, gains, hand, 1.0);
    loop.wall.stiffness_N_per_m = wall_N_per_m;
    worst = std::max(worst, hil::AdmittanceLoop(loop).SpectralRadius());
  }
  return -std::log(worst) / task.loop.period_s;
}

TuneCheck CheckInTime(const TuneTask& task, const TuneGains& gains, const std::vector<hil::GridHand>& hands) {
  TuneCheck check;
  for (const TuneContact contact : kTuneContacts)
    for (const hil::GridHand& hand : hands) {
      AdmittanceRunParams run{.loop = LoopOf(task, gains, hand, 1.0),
                              .command_loss = task.command_loss,
                              .command_jitter = task.command_jitter};
      run.loop.wall = WallOf(task, contact, 1.0);
      ++check.runs;
      if (SimulatedGrowth(run) >= 0.0)
        check.grew.push_back(fmt::format("{}, {}", hand.name, NameOf(contact)));
    }
  return check;
}

std::vector<StiffHandRun> RunStiffHands(const TuneTask& task, const TuneGains& gains) {
  const double calm_N = std::max(kCalm_N, kEnlarged * task.vibration.reference.tremor_N);
  std::vector<StiffHandRun> list;
  for (const hil::GridHand& hand : hil::HandGrid()) {
    if (hand.stiffness_N_per_m <= task.human_grip_N_per_m) continue;
    StiffHandRun worst{.hand = hand, .contact = {}, .run = {}, .calm_N = calm_N};
    for (const TuneContact contact : kTuneContacts) {
      AdmittanceRunParams run = WithIndex(task, gains, hand, contact);
      run.kick_m_per_s = kGripSpeed_m_per_s;
      run.seconds = kStiffHandRun_s;
      const GripRun found = RunGrip(run);
      if (!worst.contact.empty() && worst.run.valid && found.valid && found.one_s_N <= worst.run.one_s_N)
        continue;
      worst.contact = NameOf(contact);
      worst.run = found;
      if (!found.valid) break;
    }
    list.push_back(worst);
  }
  return list;
}

double IndexWith(const TuneTask& task, const TuneGains& gains, const std::vector<hil::GridHand>& hands) {
  double largest = 0.0;
  for (const hil::GridHand& hand : hands)
    for (const TuneContact contact : kTuneContacts)
      largest = std::max(largest, RunGrip(WithIndex(task, gains, hand, contact)).max_index);
  return largest;
}

}  // namespace osteon::studies
