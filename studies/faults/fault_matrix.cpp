#include "studies/faults/fault_matrix.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "studies/failures/arm_bench.h"

namespace osteon::studies {
namespace {

using control::TickRecord;
using safety::CellState;
using Records = std::vector<TickRecord>;

constexpr int kBefore = 300;  // ticks for which a fault acts before a waiting cell is handed over
// Ticks until the cell begins after the fault; 200 of them wait for the answer to the request for motion.
constexpr int kAfter = 300;
constexpr int kSettles = 200;               // ticks until everything is at rest
constexpr int kRefused = 20;                // ticks for which a recovery that must be refused is attempted
constexpr double kSlack = 1.0 + 1e-9;       // factor on a limit, for rounding
constexpr double kStands_rad_per_s = 1e-3;  // the arm is at rest if each joint is slower
// Tolerance of the travel: the plane's spring changes the direction of the velocity a little.
constexpr double kDistanceSlack_m = 20e-6;

CellState StateOf(const TickRecord& record) { return static_cast<CellState>(record.cell_state); }
// The commanded tool's apex in W [m].
Vector3 Apex(const TickRecord& record) { return Pose(record.X_WT_cmd).translation(); }
bool IsWaiting(CellState state) { return safety::Waits(state); }

/// One trial: injects a fault in one state, judges the reaction, and keeps the first error found.
class Trial {
 public:
  Trial(const FaultCase& fault, CellState state)
      : fault_(fault),
        state_(state),
        start_path_(state == CellState::kAligning ? FaultRig::StartPath::kToStart
                                                  : FaultRig::StartPath::kNone),
        rig_(start_path_) {
    verdict_.fault = fault.name;
    verdict_.state = state;
    verdict_.expected = fault.ExpectedIn(state);
  }

  FaultVerdict Run() {
    rig_.BringTo(state_);
    first_ = rig_.recorder().records.size();
    Inject();
    const std::size_t inject_end = rig_.recorder().records.size();
    Measure(inject_end);
    const Expected& expected = verdict_.expected;
    switch (expected.reaction) {
      case Reaction::kGoesOn:
        JudgeGoesOn(inject_end);
        break;
      case Reaction::kWaits:
        Need(NoFault(inject_end) && !Any(first_, inject_end, safety::IsMotion), "it began");
        HandOverAgain();
        rig_.Run(kAfter);
        Need(safety::IsMotion(rig_.loop().state()), "it did not begin afterwards");
        break;
      case Reaction::kStops:
        JudgeStop(inject_end);
        break;
      case Reaction::kFaults:
        Need(!Any(first_, inject_end, safety::IsMotion), "it moved");
        JudgeLatched();
        rig_.Run(kSettles);
        JudgeEnd();
        break;
      case Reaction::kBacksOff:
        Need(NoFault(inject_end) && IsWaiting(StateAt(first_)), "it did not leave its way");
        Need(!Any(first_, inject_end, safety::IsMotion), "it moved");
        HandOverAgain();
        rig_.Run(kAfter);
        Need(safety::IsMotion(rig_.loop().state()), "it did not begin again");
        break;
      case Reaction::kPauses:
        JudgePause(inject_end);
        break;
      case Reaction::kAlignsOn:
        Need(NoFault(inject_end), "a fault");
        Need(!Any(first_, inject_end, safety::Renders), "it rendered");
        Need(StateAt(inject_end - 1) == CellState::kAligning && IsAtRest(inject_end - 1),
             "it is not at its start");
        rig_.Run(kAfter);
        Need(safety::Renders(rig_.loop().state()), "it did not render afterwards");
        break;
      case Reaction::kBrakesOn:
        Need(!Any(first_, inject_end, safety::IsMotion), "it moved on");
        Need(NoFault(inject_end), "a fault");
        Need(rig_.loop().state() == (state_ == CellState::kStop2 ? CellState::kPaused : CellState::kOff),
             "the stop did not end");
        JudgeDistance();
        break;
      case Reaction::kRests:
        Need(!Any(first_, inject_end, safety::IsMotion), "it moved");
        break;
    }
    JudgeAll();
    return verdict_;
  }

 private:
  // Sets the verdict's error to `wrong` if the requirement does not hold and no earlier requirement failed.
  void Need(bool holds, const char* wrong) {
    if (!holds && verdict_.wrong.empty())
      verdict_.wrong = fmt::format("{} (ends in state {}, faults {:#x})", wrong,
                                   safety::Describe(rig_.loop().state()).name, rig_.loop().faults().bits());
  }
  [[nodiscard]] const Records& records() { return rig_.recorder().records; }
  [[nodiscard]] CellState StateAt(std::size_t i) { return StateOf(records()[i]); }
  // Whether `holds` is true for the state of any tick in [from, to).
  template <class Holds>
  [[nodiscard]] bool Any(std::size_t from, std::size_t to, Holds&& holds) {
    for (std::size_t i = from; i < to; ++i)
      if (holds(StateAt(i))) return true;
    return false;
  }
  // Whether no fault is latched from the injection's first tick to `to`.
  [[nodiscard]] bool NoFault(std::size_t to) {
    return std::none_of(records().begin() + static_cast<std::ptrdiff_t>(first_),
                        records().begin() + static_cast<std::ptrdiff_t>(to),
                        [](const TickRecord& r) { return r.faults != 0; });
  }
  // Whether tick i commands the same position of the apex as the tick before.
  [[nodiscard]] bool IsAtRest(std::size_t i) {
    return Vector3(Apex(records()[i]) - Apex(records()[i - 1])).isZero(0.0);
  }

  // Injects the fault for its duration. After kBefore ticks a waiting arm is handed over, and a paused run is
  // resumed.
  void Inject() {
    const bool waits = IsWaiting(state_), pauses = state_ == CellState::kPaused;
    // If the start path is to continue during the injection, the injection lasts until the path has ended.
    const bool to_its_end = verdict_.expected.reaction == Reaction::kAlignsOn;
    const int begins = waits || pauses ? kBefore : 0;
    const int lasts = to_its_end ? 3500 : begins + std::max(fault_.lasts, kSettles);
    for (int since = 0; since < lasts; ++since) {
      if (since == begins && waits) {
        rig_.permitted = true;
        rig_.HandOver();
      }
      if (since == begins && pauses) rig_.loop().RequestResume();
      rig_.Tick(fault_.inject, since);
    }
    begins_ = first_ + static_cast<std::size_t>(begins);
  }

  // Finds the tick in which the fault was detected, and computes the bound of the tool's travel after it.
  void Measure(std::size_t inject_end) {
    const std::uint32_t before = first_ == 0 ? 0 : records()[first_ - 1].faults;
    noticed_ = inject_end;
    for (std::size_t i = first_; i < inject_end && noticed_ == inject_end; ++i)
      if ((records()[i].faults & ~before) != 0) noticed_ = i;
    const std::size_t stop_at = Brakes() ? first_ : noticed_;
    if (noticed_ < inject_end)
      verdict_.ticks = static_cast<int>(noticed_ - (noticed_ < begins_ ? first_ : begins_)) + 1;
    if (stop_at == inject_end || stop_at == 0) return;
    const TickRecord& last = records()[stop_at - 1];
    const double v = Vector3(last.v_WT_cmd_m_per_s).norm(), dt_s = FaultRig::Params(start_path_).period_s;
    const double path_v = stop_at < 2 ? 0.0 : (Apex(last) - Apex(records()[stop_at - 2])).norm() / dt_s;
    const control::ServoParams params = FaultRig::Params(start_path_);
    const bool on_path = state_ == CellState::kAligning;
    verdict_.max_distance_m =
        on_path ? path_v * params.start->path.pause_s + path_v * dt_s
                : v * v / (2.0 * params.stop_deceleration_m_per_s2) + v * dt_s + kDistanceSlack_m;
    stops_ = stop_at;
  }
  [[nodiscard]] bool Brakes() const { return safety::Brakes(state_); }

  // Checks that an expected fault is latched in time, and no other fault.
  void JudgeLatched() {
    const Expected& expected = verdict_.expected;
    verdict_.latched = rig_.loop().faults();
    if (expected.faults.Any()) {
      Need(verdict_.ticks >= 0, "not noticed");
      Need(verdict_.ticks <= expected.ticks, "noticed late");
      Need((verdict_.latched.bits() & expected.faults.bits()) != 0, "another fault");
      Need((verdict_.latched.bits() & ~expected.faults.bits()) == 0, "a fault too many");
    } else {
      Need(!verdict_.latched.Any(), "a fault");
    }
  }

  // Checks the tool's travel while the cell brakes.
  void JudgeDistance() {
    if (stops_ == 0) return;
    // Stop measuring when the cell no longer brakes: then the virtual tool follows the arm and is not
    // commanded.
    double max_m = 0.0;
    for (std::size_t i = stops_; i < records().size() && safety::Brakes(StateAt(i)); ++i)
      max_m = std::max(max_m, (Apex(records()[i]) - Apex(records()[stops_ - 1])).norm());
    verdict_.distance_m = max_m;
    Need(max_m <= verdict_.max_distance_m, "it went too far");
  }

  void JudgeStop(std::size_t inject_end) {
    JudgeLatched();
    const Expected& expected = verdict_.expected;
    const std::size_t at = expected.faults.Any() ? noticed_ : first_;
    if (at < inject_end) {
      const CellState then = StateAt(at);
      const bool hard = expected.stop == safety::StopCategory::kStop0;
      const CellState end = expected.faults.Any() ? CellState::kFault : CellState::kOff;
      Need(then == (hard ? CellState::kStop0 : CellState::kStop1) || then == end, "another stop");
      Need(!Any(at, inject_end, safety::IsMotion), "it moved on");
    }
    JudgeDistance();
    rig_.Run(kSettles);
    JudgeEnd();
  }

  // Checks that the cell is at rest, does not begin by itself, recovers if its faults allow it, and that a
  // new run begins.
  void JudgeEnd() {
    control::ServoLoop& loop = rig_.loop();
    const bool faulty = verdict_.expected.faults.Any();
    Need(loop.state() == (faulty ? CellState::kFault : CellState::kOff), "not at rest");
    Need(rig_.qd().cwiseAbs().maxCoeff() < kStands_rad_per_s, "the arm moves");
    Need(!loop.cell_commands().motion_requested, "it still asks for motion");
    // a cell that was requested to end does not begin again
    const bool recovers = safety::AllowsRecovery(loop.faults()) && state_ != CellState::kStop1;
    Need(loop.CanRecover() == recovers, "recovery");
    rig_.TakeBack();
    rig_.Run(5);
    rig_.HandOver();
    rig_.Run(kRefused);
    Need(!safety::IsMotion(loop.state()), "it went on by itself");
    loop.RequestRecovery();
    rig_.Run(recovers ? kAfter : kRefused);
    Need(safety::IsMotion(loop.state()) == recovers, recovers ? "it did not recover" : "it recovered");
    FaultRig next(start_path_, rig_.q());
    next.Run(5);
    next.HandOver();
    next.Run(kAfter);
    Need(safety::IsMotion(next.loop().state()), "a new run did not begin");
  }

  void JudgeGoesOn(std::size_t inject_end) {
    Need(NoFault(inject_end), "a fault");
    Need(safety::IsMotion(rig_.loop().state()), "it does not go on");
    if (safety::IsMotion(state_)) Need(!Any(first_, inject_end, safety::IsStop), "it stopped");
  }

  void JudgePause(std::size_t inject_end) {
    Need(NoFault(inject_end), "a fault");
    Need(!Any(first_, inject_end, [](CellState s) { return s != CellState::kAligning; }), "it left its way");
    Need(IsAtRest(inject_end - 1), "it did not rest");
    rig_.Run(kAfter);
    Need(rig_.loop().state() == CellState::kAligning && !IsAtRest(records().size() - 1), "it did not go on");
  }

  // Checks every tick: force and joint speeds within limits, commands finite, no gap in the recording.
  void JudgeAll() {
    const auto& limits = ScenarioArm().limits;
    std::uint64_t gaps = 0;
    for (std::size_t i = 0; i < records().size(); ++i) {
      const TickRecord& r = records()[i];
      const double force_N = Vector3(r.F_coupling_T_W.f).norm();
      verdict_.peak_force_N = std::max(verdict_.peak_force_N, force_N);
      Need(force_N <= rig_.loop().max_force_N() * kSlack, "more force than the limit");
      Need(std::all_of(r.q_cmd.begin(), r.q_cmd.end(), [](double q) { return std::isfinite(q); }),
           "a command that is none");
      if (i == 0) {
        gaps = r.tick;
        continue;
      }
      const TickRecord& before = records()[i - 1];
      gaps += r.tick - before.tick - 1;
      const bool commanded = safety::IsMotion(StateOf(r)) || safety::Brakes(StateOf(r));
      const bool was_commanded = safety::IsMotion(StateOf(before)) || safety::Brakes(StateOf(before));
      if (!commanded || !was_commanded || r.tick != before.tick + 1 ||
          r.activation_cmd != before.activation_cmd)
        continue;
      for (std::size_t j = 0; j < limits.size(); ++j)
        Need(std::abs(r.q_cmd[j] - before.q_cmd[j]) <= limits[j].velocity_rad_per_s * 1e-3 * kSlack,
             "a joint faster than its limit");
    }
    Need(rig_.recorder().pushed == rig_.ticks(), "a tick that was not handed to the recorder");
    Need(records().size() + gaps == rig_.ticks(), "a tick that was neither recorded nor refused");
  }

  // Hands the arm over again if the injection made it leave its session.
  void HandOverAgain() {
    if (rig_.last().session_state == static_cast<std::uint8_t>(control::SessionState::kCommandingActive))
      return;
    rig_.TakeBack();
    rig_.Run(5);
    rig_.HandOver();
  }

  const FaultCase& fault_;
  CellState state_;
  FaultRig::StartPath start_path_;
  FaultRig rig_;
  FaultVerdict verdict_;
  // Indices in records(): the injection's first tick, the tick in which a waiting cell may begin, the tick
  // that detected the fault, the first tick of the stop.
  std::size_t first_{0}, begins_{0}, noticed_{0}, stops_{0};
};

}  // namespace

FaultVerdict RunFault(const FaultCase& fault, CellState state) {
  try {
    return Trial(fault, state).Run();
  } catch (const std::logic_error& error) {
    return {.fault = fault.name, .state = state, .expected = fault.ExpectedIn(state), .wrong = error.what()};
  }
}

std::vector<FaultVerdict> RunFaultMatrix(std::span<const FaultCase> faults,
                                         const std::function<bool(double)>& progress) {
  std::vector<FaultVerdict> verdicts;
  for (std::size_t i = 0; i < faults.size(); ++i) {
    if (progress && !progress(static_cast<double>(i) / static_cast<double>(faults.size()))) break;
    for (int s = 0; s < safety::kCellStates; ++s)
      verdicts.push_back(RunFault(faults[i], static_cast<CellState>(s)));
  }
  return verdicts;
}

}  // namespace osteon::studies
