#pragma once

#include <array>
#include <cstdint>

#include "base/clock.h"
#include "control/laws/gains.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Phase of a run, a summary of safety::CellState.
enum class Phase : std::uint8_t {
  kWaiting,   ///< the arm is not yet handed over, or the cell is paused
  kHaptic,    ///< rendering
  kStopping,  ///< ordered stop under way
  kStopped,   ///< at rest, holding its position
  kAligning,  ///< moving to the start of the run, while the enabling switch is held
};

/// Inputs of a tick, except those that are fields of TickRecord (q_meas, session_state, model_frame). With
/// all inputs and the frames of the simulation, `osteon replay` computes the tick again, bit for bit. Plain
/// data.
struct TickInput {
  rt::Nanoseconds now{0};        ///< time given to the tick; 0: the recording predates this field
  rt::Nanoseconds arm_stamp{0};  ///< ArmState::stamp
  // copied from ArmState
  std::uint32_t sequence{0}, activation{0};
  std::uint32_t lost{0}, duplicate{0}, late{0}, reordered{0}, rejected{0}, other_version{0};
  std::uint32_t answers_lost{0}, answers_foreign{0};
  std::uint8_t quality{0}, safety_state{0}, operation_mode{0}, control_mode{0}, command_mode{0};
  bool drives_active{false}, holding{false}, has_ipo{false};
  std::uint8_t received{0};          ///< ReceiveResult
  bool stop{false};                  ///< an orderly stop was requested
  bool recover{false};               ///< a recovery was requested since the previous tick
  bool pause{false}, resume{false};  ///< a pause, or its end, was requested since the previous tick
  bool repeat_differed{false};    ///< repeating the computation of the previous tick gave a different result
  bool recorder_stalled{false};   ///< the recorder stalled, or did not accept the previous tick
  std::uint8_t model_status{0};   ///< simulation::EngineStatus
  double period_s{0.0};           ///< ArmState::period_s
  std::array<double, 7> q_ipo{};  ///< [rad]
  std::array<double, 7> tau_ext{};  ///< [N·m]
  rt::Nanoseconds sensor_stamp{0};  ///< ForceReading::stamp
  PlainWrench F_sensor_S;           ///< the raw reading; F_operator_T_W is computed from it
  bool sensor_trusted{true};
  // copied from SpindleReading and InterlockReading
  rt::Nanoseconds spindle_stamp{0};
  double spindle_meas_rad_per_s{0.0}, spindle_torque_Nm{0.0};
  bool spindle_ready{false}, spindle_fault{false};
  std::uint8_t drive_faults{0}, drive_nmt_state{0};
  std::uint16_t drive_emergency_code{0}, drive_error_code{0};
  rt::Nanoseconds interlock_stamp{0};
  bool permitted{false}, enabled{false}, spindle_permitted{false};
  std::uint8_t interlock_reason{0};
  rt::Nanoseconds model_pose_stamp{0};
  std::uint8_t tool_index{0};     ///< entry of the loop's table of tools that is in force from this tick on
  bool has_guidance_gain{false};  ///< `guidance_gain` was requested since the previous tick
  double guidance_gain{0.0};      ///< 0 … 1
  bool has_gains{false};          ///< `gains` were requested since the previous tick, and accepted
  Gains gains{};
};

/// Result of a tick's guidance along a surgical plan (control/guidance). Plain data.
struct GuidanceRecord {
  bool present{false};  ///< the cell has guidance and rendered in this tick; otherwise all fields are zero
  PlainWrench F_T_W;    ///< rendered wrench of the guidance, on T at To, in W; part of F_coupling_T_W
  double share{0.0};    ///< sigma: the share of the guidance that was rendered, 0 … 1
  /// U: potential energy of the unscaled guidance at this pose; 0 inside the corridor.
  double potential_J{0.0};
  double energy_J{0.0};  ///< E: energy that the guidance has given to the tool; negative: taken from the tool
  double cone_rad{0.0}, lateral_m{0.0},
      depth_m{0.0};  ///< distance beyond each bound of the corridor (cone, lateral, depth); <= 0: inside
  bool stops_spindle{false};  ///< the guidance requires the spindle to stop
};

/// Deflections of the compliant parts in a tick (control/compliance). Plain data; zero if the cell is rigid.
struct ComplianceRecord {
  bool present{false};
  PlainPose X_ME;  ///< pose of the bent tool's head E in M, the frame in which the bone rests, after this
                   ///< tick; input of the cutting engine
  PlainPose X_WM;  ///< pose of M in the world
  PlainVector3 bend_m, bend_rad;                ///< deflection of the tool: E in T
  PlainVector3 layer_m;                         ///< deflection of the surface layer, in M
  PlainVector3 mount_m, mount_rad;              ///< deflection of the bone's mount at Mo, pads included, in W
  PlainVector3 mount_m_per_s, mount_rad_per_s;  ///< velocity of the mount's mass, in W
};

/// Value of TickRecord::cell_state in recordings that predate this field.
inline constexpr std::uint8_t kNoCellState = 255;

/// One tick of the servo loop as it is recorded. Plain data.
struct TickRecord {
  std::uint64_t tick{0};
  /// Time of the arm message that this tick answers; without a message, the time of the tick.
  rt::Nanoseconds stamp{0};
  Phase phase{Phase::kWaiting};
  std::uint8_t session_state{0};   ///< FRI session state, 0 … 4
  std::uint32_t faults{0};         ///< safety::FaultSet bits
  std::array<double, 7> q_meas{};  ///< [rad]
  std::array<double, 7> q_cmd{};   ///< [rad]
  PlainPose X_WT_cmd, X_WT_meas;   ///< tool in world, commanded and measured
  PlainVector3 v_WT_cmd_m_per_s;   ///< velocity of the tool's apex
  /// Measured speed of the apex since the previous message, while the loop commands the arm; else 0.
  double tool_speed_meas_m_per_s{0.0};
  PlainWrench F_operator_T_W;  ///< the hand's wrench on T at To, in W, from the sensor
  /// The rendered coupling wrench, after all limits. In the tick of a fault: the limited wrench that would
  /// have been rendered.
  PlainWrench F_coupling_T_W;
  /// Growth or change of direction of the coupling's force in this tick (safety::WrenchRateTrip).
  double wrench_step_N{0.0};
  double wrench_step_limit_N{0.0};  ///< limit of wrench_step_N
  double wrench_scale{1.0};         ///< share of the coupling wrench that the limits passed, 0 … 1
  double arm_share{1.0};  ///< share of the coupling wrench that the arm can hold in this posture, 0 … 1
  double tool_in_bone_m{0.0};   ///< distance of the tool from its collision-free pose, while rendering
  double vibration_index{0.0};  ///< 0 … 1
  /// RMS force up to which vibration counts as the hand's own.
  double vibration_reference_N{0.0};
  double mass_factor{1.0};         ///< factor of the vibration index on the virtual tool's mass and inertia
  double damping_factor{1.0};      ///< factor of the vibration index on the virtual tool's drag
  double age_damping_factor{1.0};  ///< factor of the age governor on the law's damping
  double age_wrench_share{1.0};    ///< factor of the age governor on the coupling
  /// E: net energy that the planes have given to the tool; > 0: the planes have generated energy.
  double passivity_energy_J{0.0};
  double passivity_damping_Ns_per_m{0.0};  ///< damping that dissipates E; 0: inactive
  double tank_J{0.0};                      ///< energy in the tank, while rendering
  double tank_share{1.0};                  ///< share of the coupling that the tank could pay for
  GuidanceRecord guidance;
  ComplianceRecord compliance;
  std::uint32_t limits{0};                ///< safety::LimitSet: the limits that acted in this tick
  std::uint8_t cell_state{kNoCellState};  ///< safety::CellState
  std::uint32_t permits{0};               ///< safety::MotionPermits, as last evaluated
  PlainWrench F_bias_S;                   ///< bias subtracted from the sensor's readings, in S
  double model_age_s{0.0};                ///< age of the pose that the contact model was computed for
  double sensor_age_s{0.0};
  std::uint64_t model_frame{0};
  double spindle_rad_per_s{0.0};
  std::uint32_t activation_cmd{0};  ///< activation of the arm that the command is for
  PlainWrench F_cmd_T;              ///< wrench overlay, on T at To, in T; zero in position mode
  std::array<double, 7> tau_cmd{};  ///< torque overlay [N·m]
  rt::Nanoseconds wakeup_ns{0};     ///< time from the arm's message to the loop's wake-up; 0 in virtual time
  rt::Nanoseconds compute_ns{0};    ///< time from wake-up to answer; 0 in virtual time
  TickInput input;
};

}  // namespace osteon::control
