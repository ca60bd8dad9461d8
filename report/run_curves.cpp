#include "report/run_curves.h"

#include <limits>

#include "control/loop/tick_state.h"

namespace osteon::report {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();  // leaves a gap in a curve

}  // namespace

void RunCurves::Add(const control::TickRecord& tick) {
  if (!first_tick) first_tick = tick.stamp;
  last_tick = tick.stamp;
  if (!phases.empty()) phases.back().end = tick.stamp;
  const bool paused = control::IsPaused(tick);
  if (phases.empty() || phases.back().phase != tick.phase || phases.back().paused != paused)
    phases.push_back({.phase = tick.phase, .paused = paused, .begin = tick.stamp, .end = tick.stamp});

  // in a tick without a message of the arm nothing is computed or sent, so the zeros in the record are not
  // forces
  const bool computed = tick.phase == control::Phase::kWaiting || control::HasMessage(tick);
  const Wrench F_T_W = tick.F_coupling_T_W;
  const Vector3 feed_W = Pose(tick.X_WT_cmd).linear().col(2);
  coupling_N.Add(tick.stamp, computed ? F_T_W.f.norm() : kMissing);
  axial_N.Add(tick.stamp, computed ? -F_T_W.f.dot(feed_W) : kMissing);
  hand_N.Add(tick.stamp, computed ? Wrench(tick.F_operator_T_W).f.norm() : kMissing);
  rendered_percent.Add(tick.stamp, 100.0 * tick.wrench_scale);
  arm_percent.Add(tick.stamp, 100.0 * tick.arm_share);
  wrench_cut |= tick.wrench_scale < 1.0;
  speed_mm_per_s.Add(tick.stamp, 1e3 * Vector3(tick.v_WT_cmd_m_per_s).norm());
  in_bone_mm.Add(tick.stamp, control::HasMessage(tick) ? 1e3 * tick.tool_in_bone_m : kMissing);
  // before the first frame there is no model, and therefore no age
  model_age_ms.Add(tick.stamp, tick.model_frame == 0 ? kMissing : 1e3 * tick.model_age_s);
  if (depth_of) {
    const bool in_bone = control::HasMessage(tick) && tick.tool_in_bone_m > 0.0;
    commanded_depth_mm.Add(tick.stamp, in_bone ? 1e3 * depth_of(tick.X_WT_cmd) : kMissing);
  }
  AddCompliance(tick);
  wakeup.Add(tick.wakeup_ns);
  compute.Add(tick.compute_ns);
}

void RunCurves::AddCompliance(const control::TickRecord& tick) {
  const control::ComplianceRecord& record = tick.compliance;
  if (!record.present) return;
  const auto add = [&](ThinCurve& curve, bool& acts, const PlainVector3& displacement_m) {
    const double size_mm = 1e3 * Vector3(displacement_m).norm();
    curve.Add(tick.stamp, size_mm);
    acts |= size_mm > 0.0;
  };
  add(bend_mm, bends, record.bend_m);
  add(layer_mm, has_layer, record.layer_m);
  add(mount_mm, mount_moves, record.mount_m);
}

void RunCurves::Add(const simulation::FrameRecord& record) {
  if (!first_frame) first_frame = record.stamp;
  // the approach is not part of the cut: draw the depth from the first touch on
  touched = touched || Wrench(record.model.F_T_W).f.norm() > 0.0 || record.model.removed_volume_m3 > 0.0;
  depth_mm.Add(record.stamp, touched ? 1e3 * record.cup_depth_m : kMissing);
  volume_mm3.Add(record.stamp, 1e9 * record.model.removed_volume_m3);
  frame.Add(record.duration_ns);
}

rt::Nanoseconds RunCurves::Start() const { return first_tick ? *first_tick : first_frame.value_or(0); }

}  // namespace osteon::report
