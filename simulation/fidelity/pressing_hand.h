#pragma once

#include "simulation/engine/cutting_engine.h"

namespace osteon::simulation {

/// A hand that presses a spinning tool along its feed with the force F. As in an admittance law, the tool
/// moves with mass M and drag D, but only along the line of the feed: v is its speed, a its acceleration, and
/// f the coupling's force on the tool.
///
///     M a = F(t) - D v - f·(-feed)      F rises at ramp_N_per_s up to force_N
///
/// Semi-implicit Euler steps: the velocity is updated before the position, and the drag acts on the velocity
/// at the step's end. They are stable for any drag.
struct PressingHandParams {
  Pose X_WT{Pose::Identity()};  ///< start pose; the feed is T's +z
  double force_N{100.0};
  double ramp_N_per_s{400.0};
  double spindle_rad_per_s{26.179938779914945};  ///< 250 rpm
  double mass_kg{3.0};
  double drag_Ns_per_m{300.0};
  double dt_s{1e-3};
};

/// Computes the motion of the hand that PressingHandParams describes, frame by frame.
class PressingHand {
 public:
  /// @throws std::invalid_argument if mass or time step is not positive, or force, ramp or drag is negative.
  explicit PressingHand(const PressingHandParams& params);

  /// Computes the next frame's input from the last frame's force.
  /// @param F_T_W  the coupling's force of the last frame, on T, in W
  [[nodiscard]] FrameInput Next(const Vector3& F_T_W);

  /// Distance travelled along the feed since the start.
  [[nodiscard]] double feed_m() const { return feed_m_; }
  [[nodiscard]] double speed_m_per_s() const { return speed_m_per_s_; }

 private:
  PressingHandParams params_;
  Vector3 feed_W_;
  double feed_m_{0.0}, speed_m_per_s_{0.0};
  std::int64_t frame_{0};
};

}  // namespace osteon::simulation
