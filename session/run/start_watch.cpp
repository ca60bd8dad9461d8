#include "session/run/start_watch.h"

#include "session/run/start_path.h"

namespace osteon::session {
namespace {

constexpr double kMoved_rad = 0.02;  // after a joint has moved this far, the path is checked again

}  // namespace

StartWatch::StartWatch(const CellSetup& setup, control::ServoLoop& loop) : setup_(setup), loop_(loop) {
  loop_.AllowStart(false);
}

void StartWatch::Poll() {
  const control::StandingArm& arm = standing_.Load();
  if (!arm.known) return;
  const kinematics::JointVector q = Eigen::Map<const kinematics::JointVector>(arm.q.data());
  if (checked_ && (q - checked_q_).cwiseAbs().maxCoeff() < kMoved_rad) return;
  checked_q_ = q;
  loop_.AllowStart(false);
  why_not_ = ValidateStartPath(setup_, q);
  checked_ = true;
  loop_.AllowStart(why_not_.empty());
}

}  // namespace osteon::session
