#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "base/marker.h"
#include "control/excitation/excitation_path.h"
#include "control/ports.h"
#include "kinematics/spatial.h"
#include "safety/cell_state.h"

namespace osteon::control {

/// Why an excitation ended before its time.
enum class ExcitationAbort : std::uint8_t {
  kNone,
  kLeftPause,    ///< the loop has left the pause by itself: a fault, a stop, an operator's resume
  kArmLeft,      ///< the arm has left COMMANDING_ACTIVE, or came back in another activation
  kForce,        ///< the force on the sensor has changed by more than max_force_N
  kForceGrows,   ///< the force above 5 Hz has grown for 0.3 s
  kTracking,     ///< the deviation of tool or joint from the command is beyond its bound
  kAnswersLost,  ///< messages and answers lost in 1 s: more than max_lost_share of all
  kSensor,       ///< no usable force reading: invalid, not finite or too old
};
/// Describes an abort for messages, e.g. "the force on the sensor passed its limit"; empty for kNone.
[[nodiscard]] const char* Describe(ExcitationAbort abort);

/// Excitation by a force that is overlaid on the arm's own impedance control, instead of by a commanded
/// motion.
struct OverlayExcitation {
  bool on{false};
  /// Assumed properties of the arm. They determine the force that would move such an arm along the path x:
  ///
  ///     f = mass x'' + damping x' + stiffness x
  ///
  /// Force and motion then both have power on all lines. The arm's real properties are identified from the
  /// response.
  double mass_kg{5.0}, damping_Ns_per_m{140.0}, stiffness_N_per_m{2000.0};
  double max_force_N{50.0};  ///< force and motion are scaled down to keep this; > 0, at most 50
};

struct ExcitedHoldParams {
  ExcitationParams path;
  double period_s{0.001};
  int sequence_step{1};    ///< increase of ArmState::sequence from message to message
  JointArray direction{};  ///< motion of the joints for 1 m along the axis e: pseudo-inverse of the Jacobian
                           ///< × e [rad/m]
  Vector3 axis_W{Vector3::UnitZ()};  ///< e, unit
  Eigen::Matrix<double, 3, kJoints> J_W{
      Eigen::Matrix<double, 3, kJoints>::Zero()};  ///< Jacobian of the apex, at the posture
  /// a larger change of the sensor's force aborts; 30 without a hand at the handle, 60 with one
  double max_force_N{30.0};
  double max_tracking_m{0.01};
  /// -1: the tool is excited, along axis_W. 0 … kJoints - 1: only this joint is excited, and its own encoder
  /// measures the response. The path, x_m and y_m are then angles of this joint [rad], and its entry in
  /// `direction` is 1.
  int joint{-1};
  double max_joint_tracking_rad{0.02};  ///< bound for the excited joint, in addition to the tool's
  double max_lost_share{0.05};
  double max_sensor_age_s{0.1};
  /// the path runs only while the PLC permits motion and the enabling switch is held
  bool has_interlock{false};
  OverlayExcitation overlay{};
  double wait_s{1.0};      ///< rest before the path begins, in which the force's zero is measured; > 0
  bool rests_only{false};  ///< no excitation: the hold is done after wait_s
};

/// The values of a tick that an excited hold needs. In a run they come from the loop and its ports, in a
/// replay from the tick's record.
struct ExcitedTick {
  bool received{false};
  std::uint32_t sequence{0}, activation{0};
  bool active{false};                      ///< COMMANDING_ACTIVE
  std::uint32_t lost{0}, answers_lost{0};  ///< counters of ArmState
  JointArray q_meas{}, q_hold{};           ///< joint positions: measured; commanded by the loop [rad]
  Vector3 force_S_N{Vector3::Zero()};
  double sensor_age_s{0.0};
  bool sensor_trusted{true}, permitted{false};
  safety::CellState state{safety::CellState::kOff};  ///< state of the cell after the tick
};

struct ExcitedHoldStep {
  JointArray offset{};  ///< to be added to the loop's command [rad]
  double x_m{0.0};      ///< offset along the axis; with an overlay, the path from which the force is computed
  /// with an overlay: force along the axis to be sent as FRI's overlay; `offset` is then zero
  double f_N{0.0};
  double y_m{0.0};  ///< measured offset along the axis, or of the joint
  ExcitationStep path{};
  bool excites{false};  ///< the path has begun and is not done
  ExcitationAbort abort{ExcitationAbort::kNone};
};

/// Adds an excitation to an arm that the servo loop holds in a pause:
///
///     ServoLoop (paused) ──q_hold──▶ + direction x(t) ──▶ arm
///
/// The loop's checks of a pause go on: session, tracking, measured speed. This class adds checks of its own.
/// Its results depend only on the ticks, so that the same ticks from a recording give the same offsets, bit
/// for bit. After an abort, the path brakes to rest within pause_s; the offset then stays constant, and an
/// overlaid force ends. If messages are lost, the path advances by the increase of the sequence number. Step
/// does not allocate.
class ExcitedHold {
 public:
  /// @throws std::invalid_argument naming the parameter, the value found and what is accepted.
  explicit ExcitedHold(const ExcitedHoldParams& params);

  [[nodiscard]] ExcitedHoldStep Step(const ExcitedTick& tick) OSTEON_RT;

  /// Whether the path is at its end, or has come to rest after an abort.
  [[nodiscard]] bool done() const OSTEON_RT { return done_; }
  [[nodiscard]] const ExcitationPath& path() const { return path_; }
  [[nodiscard]] const ExcitedHoldParams& params() const { return params_; }

 private:
  void BeginExcitation(const ExcitedTick& tick) OSTEON_RT;
  [[nodiscard]] ExcitationAbort Check(const ExcitedTick& tick, double x_before_m) OSTEON_RT;
  [[nodiscard]] bool Tracks(const ExcitedTick& tick, double x_before_m) const OSTEON_RT;
  [[nodiscard]] bool LosesAnswers(const ExcitedTick& tick, int messages) OSTEON_RT;
  [[nodiscard]] bool ForceGrows(const Vector3& force_S_N) OSTEON_RT;
  void StepPath(bool permitted, int messages) OSTEON_RT;
  [[nodiscard]] double OverlayForce(double x_m) OSTEON_RT;

  ExcitedHoldParams params_;
  ExcitationPath path_;
  bool has_begun_{false}, done_{false};
  ExcitationAbort abort_{ExcitationAbort::kNone};
  int waited_{0};  // number of messages in the rest before the excitation
  std::uint32_t sequence_{0}, activation_{0};
  JointArray q_hold_{};
  Vector3 force_zero_S_N_{Vector3::Zero()};
  ExcitedHoldStep step_;
  double overlay_scale_{1.0};                    // factor that keeps the force within its bound
  double x_last_m_{0.0}, x_before_last_m_{0.0};  // the path's x in the last two periods
  // counts of the present second (LosesAnswers)
  int second_messages_{0};
  std::uint32_t second_lost_{0};
  // force above 5 Hz, in windows of 0.1 s (ForceGrows)
  Vector3 slow_S_N_{Vector3::Zero()};
  double squares_{0.0}, window_N_{0.0};
  int window_ticks_{0}, growing_{0};
};

}  // namespace osteon::control
