#pragma once

#include <cstdint>
#include <string>

#include "base/clock.h"

namespace osteon::hil {

enum class ModeSelector : std::uint8_t { kNone = 0, kT1 = 1, kT2 = 2, kAutomatic = 3 };
/// Position of the three-position enabling switch.
enum class EnablingSwitch : std::uint8_t { kReleased = 0, kMiddle = 1, kSqueezed = 2 };

struct PlcLogicParams {
  /// Time after the last change of a heartbeat at which it counts as lost; > 0.
  rt::Nanoseconds heartbeat_timeout{250 * rt::kMillisecond};
  /// Time from the loss of RUN_PERMITTED to the cut of the power; > 0.
  rt::Nanoseconds power_cut_delay{500 * rt::kMillisecond};
  bool guard{true};  ///< the cell has a guard, whose heartbeat is watched
  std::uint16_t version{3};
};

/// Inputs from the buttons and the wire.
struct PlcLogicInputs {
  bool emergency_stop{false};  ///< pressed
  EnablingSwitch enabling{EnablingSwitch::kReleased};
  bool foot_pedal{false};
  ModeSelector mode{ModeSelector::kNone};
  bool reset{false};  ///< reset button; takes effect when it is pressed, not while it is held
  bool brake_test_due{false};
  /// Values that were last written to the registers.
  std::uint16_t controller_heartbeat{0}, guard_heartbeat{0};
  bool motion_request{false};
  bool guard_permits{true};  ///< the guard does not withdraw the request for motion; used only while the
                             ///< guard's heartbeat is alive
};

/// Reasons why motion is not permitted, as bits.
enum class PlcBlock : std::uint16_t {
  kNone = 0,
  kEmergencyStop = 1u << 0,   ///< latched: the emergency stop is pressed, or was pressed and not reset since
  kControllerLost = 1u << 1,  ///< latched: the controller's heartbeat stopped
  kGuardLost = 1u << 2,       ///< latched: the guard's heartbeat stopped
  kNoController = 1u << 3,    ///< the controller's heartbeat has not been alive yet
  kNoGuard = 1u << 4,
  kNoMode = 1u << 5,  ///< no mode is selected
  /// The enabling switch is not in its middle position, or was squeezed and not released since.
  kNotEnabled = 1u << 6,
  kNotRequested = 1u << 7,   ///< there is no valid request for motion from the controller
  kNotReset = 1u << 8,       ///< latched: the reset button was not pressed since the PLC started
  kGuardWithdrew = 1u << 9,  ///< latched: the guard withdrew the request
};

/// Outputs of the PLC's program.
struct PlcLogicOutputs {
  bool run_permitted{false};
  bool spindle_permitted{false};
  bool power_on{false};
  bool emergency_stop{true};  ///< value of the register: pressed, or not reset since
  std::uint16_t blocks{0};    ///< PlcBlock bits
  std::uint16_t heartbeat{0};
};

/// Returns the text of the blocks, e.g. "emergency stop, not requested"; "none" if there is no block.
[[nodiscard]] std::string DescribeBlocks(std::uint16_t blocks);

/// The PLC program of the simulated cell, with time as an argument. The PLC decides on motion and power:
///
///     RUN_PERMITTED  = no block                              false in the same step in which a block occurs
///     POWER_ON       = RUN_PERMITTED, and for power_cut_delay after its loss
///     SPINDLE        = RUN_PERMITTED and foot pedal
///
/// - An emergency stop, a lost heartbeat and a withdrawal by the guard latch until the reset button is
/// pressed after the cause is gone. After its start, the PLC also requires a reset.
/// - A latched stop and a change of the mode selector also cancel the request: motion begins again only after
/// the controller withdraws its request and makes a new one. The enabling switch does not cancel the request:
/// after it is released and pressed again, motion continues.
/// - After the enabling switch was squeezed through, it must be released before its middle position enables
/// motion again (IEC 60204-1, 10.9).
/// - A heartbeat is alive for heartbeat_timeout after each change of its value.
///
/// This is only a model of a PLC program, for tests. It is no safety function; a real cell must not use it.
class PlcLogic {
 public:
  /// @throws std::invalid_argument if a time is not positive.
  explicit PlcLogic(const PlcLogicParams& params);

  /// Runs one cycle of the program. @param now must not decrease; for an earlier time, no time passes
  const PlcLogicOutputs& Step(rt::Nanoseconds now, const PlcLogicInputs& inputs);

  [[nodiscard]] const PlcLogicOutputs& outputs() const { return outputs_; }
  [[nodiscard]] const PlcLogicParams& params() const { return params_; }

 private:
  struct Heartbeat {
    bool seen{false}, lives{false};
    std::uint16_t value{0};
    rt::Nanoseconds changed{0};
    // Updates the state from the heartbeat's present value. @returns true if the heartbeat has just stopped
    bool UpdateHeartbeat(rt::Nanoseconds now, std::uint16_t heartbeat, rt::Nanoseconds timeout);
  };

  PlcLogicParams params_;
  PlcLogicOutputs outputs_;
  Heartbeat controller_, guard_;
  std::uint16_t latched_;
  bool reset_before_{false}, request_before_{false};  // inputs of the previous step
  bool requested_{false};                             // there is a valid request for motion
  bool must_release_{false};                          // the enabling switch was squeezed through
  ModeSelector mode_before_{ModeSelector::kNone};
  rt::Nanoseconds now_{0}, permitted_at_{0};
  bool powered_{false};
};

}  // namespace osteon::hil
