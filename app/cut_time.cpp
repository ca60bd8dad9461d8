#include "app/cut_time.h"

namespace osteon::app {

void CutTime::Add(const simulation::FrameRecord& frame, bool spindle_turns) {
  const simulation::ContactModel& model = frame.model;
  const double dt_s = last_pose_ ? rt::ToSeconds(model.pose_stamp - *last_pose_) : 0.0;
  last_pose_ = model.pose_stamp;
  if (model.status != simulation::EngineStatus::kOk || !spindle_turns || !(dt_s > 0.0)) return;
  if (!(Vector3(model.F_T_W.f).norm() > kPressed_N) || !(model.engaged_area_m2 > 0.0)) return;
  pressed_s += dt_s;
  if (model.advance_m_per_s == 0.0 && model.spindle_torque_Nm == 0.0) idle_s += dt_s;
}

}  // namespace osteon::app
