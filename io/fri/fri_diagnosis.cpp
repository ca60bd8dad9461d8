#include <algorithm>
#include <string>

#include "io/fri/fri_session.h"
#include "io/fri/session_name.h"

// Text of FriSession::Diagnosis. Not for use in the tick, because it allocates.

namespace osteon::io {
namespace {

using control::CommandMode;
using control::ControlMode;
using control::SessionState;

// A control mode's name for use in a sentence.
const char* Name(ControlMode mode) {
  switch (mode) {
    case ControlMode::kPosition:
      return "position control";
    case ControlMode::kCartesianImpedance:
      return "Cartesian impedance control";
    case ControlMode::kJointImpedance:
      return "joint impedance control";
    case ControlMode::kNone:
      break;
  }
  return "no control";
}

}  // namespace

std::string FriSession::Diagnosis() const {
  std::string text;
  const auto append_sentence = [&text](const std::string& sentence) {
    text += (text.empty() ? "" : " ") + sentence;
  };
  const auto count = [](std::uint32_t n) { return std::to_string(n); };

  // messages that cannot be read
  if (other_family_ && !has_last_)
    append_sentence("The arm speaks " + std::string(Describe(*other_family_)) + ", configured is " +
                    Name(params_.version) + " (" + count(counters_.other_version) +
                    " messages refused): set the version to the arm's.");
  else if (!has_last_ && counters_.rejected > 0)
    append_sentence("Of " + count(counters_.rejected) + " datagrams none was a message of FRI " +
                    Name(params_.version) + "; the last: " + Describe(last_error_) + ".");
  else if (!has_last_)
    append_sentence(
        "No message of the arm has arrived: is its program running, and does it name this machine's address "
        "and port?");
  if (!has_last_) return text;

  // the arm's own state
  if (last_.safety != FriSafetyState::kNormal)
    append_sentence("The arm is in a safety stop (level " +
                    count(static_cast<std::uint32_t>(last_.safety) - 1) +
                    ") and ignores commands until that is acknowledged.");
  if (!std::all_of(last_.drives.begin(), last_.drives.end(),
                   [](FriDriveState drive) { return drive == FriDriveState::kActive; }))
    append_sentence("Not all drives are active: the arm does not move.");
  if (last_.session == SessionState::kIdle) {
    append_sentence("The arm's session is IDLE" +
                    (session_before_ == SessionState::kIdle
                         ? std::string()
                         : std::string(", it was ") + SessionName(session_before_)) +
                    ": its program has ended it, or was cancelled; start the program again.");
    return text;
  }
  if (session_before_ >= SessionState::kCommandingWait && last_.session < SessionState::kCommandingWait)
    append_sentence(std::string("The arm has left ") + SessionName(session_before_) + " for " +
                    SessionName(last_.session) + ".");
  if (last_.session < SessionState::kCommandingWait && last_.quality < FriQuality::kGood)
    append_sentence("The connection is " + std::string(last_.quality == FriQuality::kPoor ? "POOR" : "FAIR") +
                    ", commanding needs GOOD: answers are missing or late.");
  if (last_.session == SessionState::kMonitoringReady && last_.quality >= FriQuality::kGood)
    append_sentence("The robot program has not asked for commanding.");

  // the robot program's requests
  if (last_.command_mode == CommandMode::kWrench && last_.control != ControlMode::kCartesianImpedance)
    append_sentence(
        "The robot program asks for WRENCH, which needs Cartesian impedance control; the arm is in " +
        std::string(Name(last_.control)) + ".");
  if (last_.command_mode == CommandMode::kTorque && last_.control != ControlMode::kJointImpedance)
    append_sentence("The robot program asks for TORQUE, which needs joint impedance control; the arm is in " +
                    std::string(Name(last_.control)) + ".");
  if (last_.command_mode == CommandMode::kCartesianPose)
    append_sentence(
        "The robot program asks for CARTESIAN_POSE, which is mirrored, not commanded: choose POSITION, "
        "WRENCH or TORQUE there.");
  if (holding_)
    append_sentence("The arm is handed over (activation " + count(activation_) +
                    ") and held: no command for it, starting at the interpolator's position, has come.");
  if (counters_.answers_foreign > 0)
    append_sentence("The arm has reflected " + count(counters_.answers_foreign) +
                    " answers that were not ours: does another client answer it?");
  return text;
}

}  // namespace osteon::io
