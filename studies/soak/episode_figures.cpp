#include "studies/soak/episode_figures.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/recording/recording_reader.h"

namespace osteon::studies {
namespace {

// Sums and maxima over a recording's ticks, and the balance of the virtual tool's momentum.
class TickTotals {
 public:
  TickTotals(const control::AdmittanceParams& law, double period_s) : law_(&law), period_s_(period_s) {}

  void Add(const control::TickRecord& tick, EpisodeFigures& figures) {
    ++figures.ticks;
    if (has_last_ && tick.tick > last_.tick + 1) figures.missing_ticks += tick.tick - last_.tick - 1;
    const Pose X_cmd(tick.X_WT_cmd), X_meas(tick.X_WT_meas);
    figures.rest_error_m = (X_cmd.translation() - X_meas.translation()).norm();
    if (tick.phase == control::Phase::kHaptic) {
      figures.rendered_s += period_s_;
      figures.max_model_age_s = std::max(figures.max_model_age_s, tick.model_age_s);
      figures.max_sensor_age_s = std::max(figures.max_sensor_age_s, tick.sensor_age_s);
      figures.max_tracking_m = std::max(figures.max_tracking_m, figures.rest_error_m);
      figures.min_tank_J = std::min(figures.min_tank_J, tick.tank_J);
    }
    figures.peak_rendered_N = std::max(figures.peak_rendered_N, Wrench(tick.F_coupling_T_W).f.norm());
    AddMomentum(tick);
    last_ = tick;
    has_last_ = true;
  }

  [[nodiscard]] double momentum_residual() const {
    return hand_Ns_ > 0.0 ? residual_Ns_.norm() / hand_Ns_ : 0.0;
  }

 private:
  // Adds the residual of M (v - v_before) = (F_hand + F_rendered - D v) dt, along W's axes, with the law's
  // mass M and damping D, the tool's velocity v and the period dt. A tick is skipped if the tick before is
  // missing, or if in one of the two the loop does not render or a limit acts: other influences than the law
  // then change the motion.
  void AddMomentum(const control::TickRecord& tick) {
    if (!has_last_ || tick.phase != control::Phase::kHaptic || last_.phase != control::Phase::kHaptic ||
        tick.tick != last_.tick + 1 || tick.limits != 0 || last_.limits != 0)
      return;
    const Vector3 v = tick.v_WT_cmd_m_per_s, v_before = last_.v_WT_cmd_m_per_s;
    const Vector3 hand_N = Wrench(tick.F_operator_T_W).f, rendered_N = Wrench(tick.F_coupling_T_W).f;
    const Eigen::Matrix3d R = Pose(tick.X_WT_cmd).linear();
    const Vector3 drag = tick.damping_factor * tick.age_damping_factor * law_->damping_Ns_per_m;
    const Vector3 mass = tick.mass_factor * law_->mass_kg;
    const Vector3 drag_N = R * drag.asDiagonal() * R.transpose() * v;
    const Vector3 gained_Ns = R * mass.asDiagonal() * R.transpose() * (v - v_before);
    residual_Ns_ += gained_Ns - (hand_N + rendered_N - drag_N) * period_s_;
    hand_Ns_ += hand_N.norm() * period_s_;
  }

  const control::AdmittanceParams* law_;
  double period_s_;
  control::TickRecord last_{};
  bool has_last_{false};
  Vector3 residual_Ns_{Vector3::Zero()};  // sum of the momentum residuals
  double hand_Ns_{0.0};                   // sum of |F_hand| dt, the hand's impulse
};

}  // namespace

tl::expected<EpisodeFigures, std::string> ReadEpisodeFigures(const std::filesystem::path& recording,
                                                             const control::AdmittanceParams& law,
                                                             double period_s) {
  auto stream = io::RecordingStream::Open(recording);
  if (!stream) return tl::make_unexpected(stream.error());
  EpisodeFigures figures{.min_tank_J = std::numeric_limits<double>::infinity()};
  TickTotals ticks(law, period_s);
  double spindle_rad_per_s = 0.0;
  rt::Nanoseconds frame_stamp = 0;
  for (;;) {
    const auto topic = stream->Next();
    if (!topic) return tl::make_unexpected(topic.error());
    if (*topic == io::RecordedTopic::kOther) break;
    if (*topic == io::RecordedTopic::kTick) {
      ticks.Add(stream->tick, figures);
      spindle_rad_per_s = std::abs(stream->tick.input.spindle_meas_rad_per_s);
    }
    if (*topic != io::RecordedTopic::kFrame) continue;
    const simulation::ContactModel& model = stream->frame.model;
    ++figures.frames;
    // Work of the edge since the previous frame: torque × speed in the latest tick × time.
    if (frame_stamp > 0)
      figures.edge_work_J +=
          model.spindle_torque_Nm * spindle_rad_per_s * rt::ToSeconds(model.pose_stamp - frame_stamp);
    frame_stamp = model.pose_stamp;
    figures.removed_falls |= model.removed_volume_m3 < figures.removed_m3;
    figures.removed_m3 = model.removed_volume_m3;
    figures.cutting_work_J = model.cutting_work_J;
  }
  figures.complete = stream->complete();
  figures.momentum_residual = ticks.momentum_residual();
  return figures;
}

}  // namespace osteon::studies
