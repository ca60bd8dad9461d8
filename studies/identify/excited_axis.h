#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "config/reading/cell_config.h"
#include "control/excitation/excited_hold.h"
#include "studies/identify/measured_response.h"

namespace osteon::studies {

/// The excitation of one recording. The recording stores it as an event, so that the excitation can be
/// computed again from the recording.
struct ExcitationRequest {
  char axis{'z'};  ///< x, y or z of the tool's frame at the cell's start
  double peak_speed_m_per_s{0.05};
  std::uint64_t seed{1};
  int draws{4}, periods{3};  ///< number of random draws of the phases; number of counted periods of each draw
  bool held{false};          ///< a hand holds the handle
  /// True: a force acts on the arm's own impedance (FRI overlay); false: the commanded position moves.
  bool overlay{false};
  double rest_s{0.0};  ///< above 0: the arm rests for this time, and nothing is excited
  /// 1 … 7: this joint is moved instead of an axis, and peak_speed_m_per_s is the joint's speed [rad/s].
  int joint{0};
};

/// Converts a request to the text of its event, "excitation: {…}", and back. ParseEvent returns nothing for
/// any other event's text.
[[nodiscard]] std::string EventText(const ExcitationRequest& request);
[[nodiscard]] std::optional<ExcitationRequest> ParseEvent(const std::string& text);

/// Largest travel of an excited joint to either side. If the joint's speed limit requires it, the travel is
/// smaller.
inline constexpr double kMaxJointTravel_rad = 0.0174532925199433;  // 1 deg

/// Number of joints of a cell's arm: 7 of an LBR, otherwise 6.
[[nodiscard]] int JointCount(const config::CellConfig& cell);

/// The excited axis of a cell at the cell's start, or the excited joint, with the motion of the joints.
struct ExcitedAxis {
  control::ExcitedHoldParams hold;
  Vector3 axis_S{Vector3::UnitZ()};  ///< direction of the axis in the force sensor's frame
  Vector3 axis_T{Vector3::UnitZ()};  ///< direction of the axis in the tool's frame
  control::JointArray q_start{};
};

/// Computes the motion of a cell's joints that excites an axis at the cell's start. Speed and acceleration
/// keep the arm's bounds: 20 % of the joints' speed limits, twice their published accelerations. If the
/// request names a joint, this joint moves alone, by up to kMaxJointTravel_rad, and moves the tool at no more
/// than 100 mm/s and 8 m/s^2.
/// @returns an error if the posture is singular along the axis, or the arm has no such joint
[[nodiscard]] tl::expected<ExcitedAxis, std::string> ExcitedAxisOf(const config::CellConfig& cell,
                                                                   const ExcitationRequest& request);

/// Adds a step of the excitation to the loop's command: an offset of the joints, or a force at the tool's
/// apex, in the form in which the arm's program takes it (a wrench or joint torques). Does not allocate.
void AddExcitation(const ExcitedAxis& axis, const control::ExcitedHoldStep& step,
                   control::CommandMode command_mode, control::ArmCommand& command) OSTEON_RT;

/// Selects the data of a recorded tick that an excited hold needs.
[[nodiscard]] control::ExcitedTick ExcitedTickOf(const control::TickRecord& record);

/// Samples of a recorded run, and the run's statistics.
struct ExcitedSamples {
  ExcitedRun run;
  control::ExcitationAbort abort{control::ExcitationAbort::kNone};
  std::uint32_t messages{0}, lost_messages{0}, lost_answers{0};  ///< counted while the excitation ran
  double start_error_rad{0.0};  ///< largest difference of a joint's held position from the cell's start
  double jitter_mean_s{0.0}, jitter_p99_s{0.0};  ///< lateness of the messages: mean, 99th percentile
  /// RMS speeds of the joints in the counted periods.
  kinematics::JointVectorN<7> joint_rms_rad_per_s{kinematics::JointVectorN<7>::Zero()};
};

/// Computes the excitation of recorded ticks again, and pairs each command with the measurement at which the
/// arm had it. The pairs follow from the arm's sequence numbers, not from arrival times. A command counts
/// from the message that it answers. If the arm reports a lost answer, or a message did not come, the
/// previous command is repeated.
/// @returns an error if the sequence jumps back or ticks are missing in the recording
[[nodiscard]] tl::expected<ExcitedSamples, std::string> SamplesOf(
    const std::vector<control::TickRecord>& ticks, const ExcitedAxis& axis);

}  // namespace osteon::studies
