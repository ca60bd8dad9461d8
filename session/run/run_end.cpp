#include "session/run/run_end.h"

#include <fmt/format.h>

#include "base/interrupt.h"
#include "session/procedure/procedure_session.h"
#include "session/stops/stop_records.h"

namespace osteon::session {
namespace {

// Names the motion permits that were missing in the loop's last tick, for a run that never moved.
std::string MissingPermits(safety::MotionPermits permits) {
  if (!permits.Has(safety::MotionPermit::kArmFresh)) return "";  // the arm's diagnosis says why
  std::string missing;
  for (int bit = 0; bit < safety::kMotionPermits; ++bit) {
    const auto permit = static_cast<safety::MotionPermit>(1u << bit);
    if (!permits.Has(permit))
      missing += std::string(missing.empty() ? "" : ", ") + safety::DescribeMissing(permit);
  }
  return missing.empty() ? "" : "motion lacked " + missing;
}

// Says why a run without a fault ended: its duration, a signal, or its operator.
std::string DescribeEnd(const CellRunResult& result, double seconds) {
  if (result.end == control::RunEnd::kSeconds) return fmt::format("{:g} s of rendering were over", seconds);
  const std::string signal = base::InterruptName();
  if (signal == "SIGINT") return "Ctrl-C (SIGINT)";
  if (signal == "SIGHUP") return "the terminal was closed (SIGHUP)";
  if (signal == "operator") return "the operator's stop";
  return signal.empty() ? "a stop was asked for" : "a signal of another program (" + signal + ")";
}

}  // namespace

bool PollStop(const CellRunParams& params) {
  const bool finished = params.procedure && params.procedure->finished();
  if (finished) base::RequestInterrupt(base::kOperatorsStop);
  return finished || (params.stop && params.stop->load());
}

void RecordEnd(io::Recorder& recorder, rt::Nanoseconds stamp, const CellRunResult& result, double seconds) {
  if (result.faults.Any()) return;
  if (result.end == control::RunEnd::kSeconds || result.end == control::RunEnd::kStopFlag)
    recorder.PushEvent(stamp, kEndEvent + DescribeEnd(result, seconds));
}

std::string DescribeMissingArm(const std::string& arm, const std::optional<config::GuardConfig>& guard,
                               safety::MotionPermits permits) {
  if (!guard || permits.Has(safety::MotionPermit::kArmFresh)) return arm;
  return fmt::format("{} The arm is reached through the guard on {}:{}: does `osteon guard` run?", arm,
                     guard->host, guard->port);
}

void AddDiagnosis(CellRunResult& result, const std::string& arm, const std::string& devices,
                  safety::MotionPermits permits) {
  if (result.end != control::RunEnd::kNeverActive) return;
  // the devices' reasons come first, because a PLC that gives no permission causes the arm's safety stop
  for (const std::string& why : {devices, arm, MissingPermits(permits)})
    if (!why.empty()) result.diagnosis += (result.diagnosis.empty() ? "" : "; ") + why;
}

}  // namespace osteon::session
