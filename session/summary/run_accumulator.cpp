#include "session/summary/run_accumulator.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "control/ports.h"
#include "io/recording/recording_reader.h"
#include "session/procedure/procedure_session.h"
#include "session/procedure/tool_depths.h"
#include "session/summary/each_fault.h"

namespace osteon::session {

void ActiveTicks::Add(const control::TickRecord& tick) {
  if (tick.session_state != static_cast<std::uint8_t>(control::SessionState::kCommandingActive)) return;
  if (tick.wrench_scale < 1.0) ++cut;
  if (tick.arm_share < 1.0) ++arm_cut;
  if (tick.age_damping_factor > 1.0 || tick.age_wrench_share < 1.0) ++age_governor;
  if (tick.passivity_damping_Ns_per_m > 0.0) ++passivity;
  if (tick.tank_share < 1.0) ++tank;
  if (tick.phase == control::Phase::kHaptic) {
    ++rendering;
    if (tick.model_age_s > fresh_s) ++stale;
    if (tick.sensor_age_s > sensor_full_s) ++sensor_late;
  }
  max_age_damping = std::max(max_age_damping, tick.age_damping_factor);
  min_age_share = std::min(min_age_share, tick.age_wrench_share);
  min_wrench_share = std::min(min_wrench_share, tick.wrench_scale);
  min_arm_share = std::min(min_arm_share, tick.arm_share);
  if (last) step.Add(tick.stamp - *last);
  if (!first) first = stopped_at = tick.stamp;
  last = tick.stamp;
  if (tick.phase != control::Phase::kStopped) stopped_at = tick.stamp;
  wakeup.Add(tick.wakeup_ns);
  compute.Add(tick.compute_ns);
}

RunAccumulator::RunAccumulator(const CellSetup& setup)
    : path(setup.config.tool.tool, setup.X_WG), reamed(setup.bone, setup.config.tool.tool, setup.X_WG) {
  active.fresh_s = setup.config.servo.coupling.fresh_s;
  if (!setup.bone.balls.empty())
    curves.depth_of = [depth = simulation::ApexDepth(setup.bone, setup.config.tool.tool),
                       X_GW = Pose(setup.X_WG.inverse())](const Pose& X_WT) {
      return depth.DepthAt(X_GW * X_WT);
    };
  active.sensor_full_s = setup.config.servo.watchdog.sensor_full_s;
}

void RunAccumulator::UseTools(const CellSetup& setup, std::span<const ProcedureTool> tools, int first) {
  if (setup.bone.balls.empty() || tools.empty()) return;
  tool_in_use_ = std::make_shared<int>(first);
  curves.depth_of = [depths = ToolDepths(setup.bone, tools, setup.X_WG),
                     tool = tool_in_use_](const Pose& X_WT) { return depths.At(*tool, X_WT); };
}

void RunAccumulator::Add(const control::TickRecord& tick) {
  if (tool_in_use_) *tool_in_use_ = tick.input.tool_index;
  ++ticks;
  curves.Add(tick);
  active.Add(tick);
  limits.Add(tick);
  drive_faults.Add(tick);
  latency.Add(tick);
  pauses.Add(tick);
  deflections.Add(tick);
  deflected.Add(tick.compliance);
  last_input = tick.input;
  if ((tick.faults & ~seen_faults) == 0) return;
  seen_faults |= tick.faults;
  ForEachFault([&](safety::Fault fault, const safety::FaultText&) {
    if ((tick.faults & static_cast<std::uint32_t>(fault)) != 0) first_with.try_emplace(fault, tick);
  });
}

void RunAccumulator::Add(const simulation::FrameRecord& frame) {
  ++frames;
  curves.Add(frame);
  path.Add(frame);
  if (last_frame) frame_step.Add(frame.stamp - *last_frame);
  last_frame = frame.stamp;
  reamed.Add(frame);
  cup_depth_m = frame.cup_depth_m;
}

tl::expected<RunAccumulator, std::string> ReadRun(const std::filesystem::path& recording,
                                                  const CellSetup& setup, StopPages& stops,
                                                  const ProcedureSession* procedure) {
  auto stream = io::RecordingStream::Open(recording);
  if (!stream) return tl::unexpected(stream.error());
  RunAccumulator run(setup);
  if (procedure) {
    run.UseTools(setup, procedure->tools(), procedure->first_tool());
    auto cut =
        ReadSessionCut(procedure->folder(), procedure->File(), ToolsOf(procedure->tools()), setup.X_WG);
    if (!cut) return tl::unexpected(cut.error());
    cut->planned = procedure->plan().cavity();
    run.session_cut = std::make_shared<const SessionCut>(std::move(*cut));
  }
  for (;;) {
    const auto topic = stream->Next();
    if (!topic) return tl::unexpected(topic.error());
    if (*topic == io::RecordedTopic::kOther) return run;
    if (*topic == io::RecordedTopic::kFrame) run.Add(stream->frame);
    if (*topic == io::RecordedTopic::kEvent) stops.Add(stream->event);
    if (*topic != io::RecordedTopic::kTick) continue;
    run.Add(stream->tick);
    stops.Add(stream->session, stream->tick);
  }
}

}  // namespace osteon::session
