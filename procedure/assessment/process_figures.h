#pragma once

#include <optional>
#include <vector>

#include "kinematics/spatial.h"
#include "procedure/assessment/tremor.h"
#include "procedure/plan/surgical_plan.h"

// Figures of the operator's work in a session, computed from its ticks: time, path, force, tilt, tremor.

namespace osteon::procedure {

/// The data of one tick that the figures need. Poses and forces in the bone's frame G.
struct ProcessSample {
  double t_s{0.0};
  Vector3 head_m{Vector3::Zero()};  ///< centre H of the measured tool's head, which the hand holds
  /// Centre of the head and +z of the simulated tool, which cuts. If the hand presses, the measured tool is
  /// deeper in the bone than the simulated one by the deflection of the coupling's spring: 1.5 mm at 30 N.
  Vector3 cut_head_m{Vector3::Zero()}, cut_feed{Vector3::Zero()};
  Vector3 F_hand_N{Vector3::Zero()};
  bool cutting{false};  ///< bone was removed in this tick
  double spindle_rad_per_s{0.0};
  /// Energy E of the guidance (control::GuidanceRecord); nothing if the guidance is not rendered.
  std::optional<double> guidance_E_J{};
};

/// How far a pose is beyond the free corridor of the plan; negative inside. The guidance uses the same
/// quantities; they are defined whether the guidance is on or off:
///
///     tilt = angle(feed, -a) - free     lateral = (rho - rho_free - h tan psi) cos psi      depth = soft - h
///
/// with a the planned axis, H the head's centre, C the planned centre of the tool's head, h = a·(H - C), rho
/// = |H - C - h a|. free, psi (widening) and soft come from GuidanceGains; rho_free is lateral.free_m plus
/// the tool's around_m.
struct CorridorExcess {
  double tilt_rad{0.0}, lateral_m{0.0}, depth_m{0.0};
  [[nodiscard]] bool outside() const { return tilt_rad > 0.0 || lateral_m > 0.0 || depth_m > 0.0; }
};
/// @param head_m  centre of the tool's head, in G  @param feed  the tool's +z, in G
[[nodiscard]] CorridorExcess ExcessOf(const SurgicalPlan& plan, const PlannedTool& tool,
                                      const Vector3& head_m, const Vector3& feed);

/// Radii of the corridor about the planned axis at the height of the head's centre [m]. If the head's centre
/// is farther from the axis than free_m, CorridorExcess::lateral_m is positive; beyond stop_m the corridor
/// stops the spindle. 0 at heights at which the funnel is closed.
struct CorridorWidth {
  double free_m{0.0}, stop_m{0.0};
};
[[nodiscard]] CorridorWidth WidthAt(const SurgicalPlan& plan, const PlannedTool& tool, const Vector3& head_m);

/// Figures of a session, of one tool, or of one pass.
struct ProcessFigures {
  double time_s{0.0};     ///< time from the first tick to the last
  double cutting_s{0.0};  ///< time in which bone was removed
  double path_m{0.0};     ///< path of the head's centre within kNearCup_m of the planned centre
  double force_mean_N{0.0}, force_peak_N{0.0};  ///< force of the hand while cutting
  double wrong_way{0.0};  ///< share of the hand's impulse across the axis, while cutting; 0 … 1
  /// Time in which the simulated tool was outside the corridor while cutting, whether guidance was on or off;
  /// 0 if the plan has no corridor.
  double outside_s{0.0};
  double tremor_N{0.0};  ///< RMS hand force between 6 and 14 Hz, without the spindle's harmonics
  /// Energy that the guidance has taken from the hand; 0: the guidance was off, or never acted.
  double guidance_J{0.0};
};

/// Distance from the planned centre within which ProcessFigures::path_m is measured.
inline constexpr double kNearCup_m = 30e-3;

/// Computes the figures from samples, which must be added in the order of their times.
class ProcessSums {
 public:
  ProcessSums(const SurgicalPlan& plan, double period_s)
      : plan_(&plan), tremor_(period_s), period_s_(period_s) {}

  void Add(const ProcessSample& sample, const PlannedTool& tool);
  [[nodiscard]] ProcessFigures Figures() const;

 private:
  const SurgicalPlan* plan_;
  TremorMeter tremor_;
  double period_s_;
  bool begun_{false};
  double first_s_{0.0}, last_s_{0.0};
  Vector3 head_m_{Vector3::Zero()};  // ProcessSample::head_m of the previous sample
  bool was_near_{false};             // the previous sample's head was within kNearCup_m
  double path_m_{0.0}, cutting_s_{0.0}, outside_s_{0.0};
  // total impulse, impulse across the axis, and peak force of the hand while cutting
  double impulse_Ns_{0.0}, across_Ns_{0.0}, peak_N_{0.0};
  std::optional<double> guidance_E_J_{};  // the guidance's energy E in the previous sample
  double guidance_J_{0.0};
};

}  // namespace osteon::procedure
