#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "config/reading/cell_config.h"
#include "control/excitation/excited_hold.h"
#include "studies/identify/measured_response.h"

namespace osteon::studies {

/// The excitation of one recording. The recording keeps it as an event, so that the excitation can be
/// computed again.
struct ExcitationRequest {
  char axis{'z'};  ///< x, y or z of the tool's frame at the cell's start
  double peak_speed_m_per_s{0.05};
  std::uint64_t seed{1};
  int draws{4}, periods{3};  ///< random draws of the phases; counted periods of each
  bool held{false};          ///< a hand holds the handle
  bool overlay{false};       ///< a force over the arm's impedance instead of a motion of its command
  double rest_s{0.0};        ///< above 0: the arm rests for this time, and nothing is excited
  /// 1 … 7: this joint is moved instead of an axis, and peak_speed_m_per_s is the joint's speed [rad/s].
  int joint{0};
};

/// Converts a request to the text of its event, "excitation: {…}", and back. ParseEvent returns nothing for
/// the text of another event.
[[nodiscard]] std::string EventText(const ExcitationRequest& request);
[[nodiscard]] std::optional<ExcitationRequest> ParseEvent(const std::string& text);

/// Largest travel of an excited joint to either side; the joint moves less if its speed limit requires it.
inline constexpr double kMaxJointTravel_rad = 0.0174532925199433;  // 1 deg

/// Number of joints of a cell's arm: 7 of an LBR, otherwise 6.
[[nodiscard]] int JointCount(const config::CellConfig& cell);

/// The excited axis of a cell at the cell's start, or the excited joint.
struct ExcitedAxis {
  control::ExcitedHoldParams hold;
  Vector3 axis_S{Vector3::UnitZ()};  ///< the same axis in the force sensor's frame
  Vector3 axis_T{Vector3::UnitZ()};  ///< the same axis in the tool's frame
  control::JointArray q_start{};
};

/// Computes how a cell's joints move along an axis at the cell's start, with speed and acceleration within
/// the arm's bounds: 20 % of the joints' speed, twice their published acceleration. A joint moves alone, by
/// up to kMaxJointTravel_rad, and moves the tool at no more than 100 mm/s and 8 m/s^2.
/// @returns an error if the posture is singular along the axis, or the arm has no such joint
[[nodiscard]] tl::expected<ExcitedAxis, std::string> ExcitedAxisOf(const config::CellConfig& cell,
                                                                   const ExcitationRequest& request);

/// Adds a step of an excited hold to the loop's command: an offset of the joints, or a force at the tool's
/// apex as the arm's program takes it, a wrench or joint torques. Does not allocate.
void AddExcitation(const ExcitedAxis& axis, const control::ExcitedHoldStep& step,
                   control::CommandMode command_mode, control::ArmCommand& command) OSTEON_RT;

/// Selects the data of a recorded tick that an excited hold needs.
[[nodiscard]] control::ExcitedTick ExcitedTickOf(const control::TickRecord& record);

/// Samples of a recorded run, and how it went.
struct ExcitedSamples {
  ExcitedRun run;
  control::ExcitationAbort abort{control::ExcitationAbort::kNone};
  std::uint32_t messages{0}, lost_messages{0}, lost_answers{0};  ///< while the path ran
  double start_error_rad{0.0};  ///< largest difference of the held joints from the cell's start
  double jitter_mean_s{0.0}, jitter_p99_s{0.0};  ///< lateness of the messages: mean, 99th percentile
  kinematics::JointVectorN<7> joint_rms_rad_per_s{kinematics::JointVectorN<7>::Zero()};  ///< while counted
};

/// Computes the excitation of recorded ticks again, and pairs each command that arrived with the measurement:
/// by the arm's sequence numbers, never by the time of arrival. A command counts from the message that it
/// answers; if the arm reports a lost answer, or a message did not come, the command before is held.
/// @returns an error if the sequence jumps back or ticks are missing in the recording
[[nodiscard]] tl::expected<ExcitedSamples, std::string> SamplesOf(
    const std::vector<control::TickRecord>& ticks, const ExcitedAxis& axis);

}  // namespace osteon::studies
