#pragma once

#include <cstdint>
#include <string>

#include "base/clock.h"

namespace osteon::hil {

enum class ModeSelector : std::uint8_t { kNone = 0, kT1 = 1, kT2 = 2, kAutomatic = 3 };
/// A three-position device.
enum class EnablingSwitch : std::uint8_t { kReleased = 0, kMiddle = 1, kSqueezed = 2 };

struct PlcLogicParams {
  rt::Nanoseconds heartbeat_timeout{250 * rt::kMillisecond};  ///< since the last change of a heartbeat; > 0
  rt::Nanoseconds power_cut_delay{500 * rt::kMillisecond};    ///< from the loss of RUN_PERMITTED; > 0
  bool guard{true};  ///< the cell has a guard, whose heartbeat is watched
  std::uint16_t version{3};
};

/// Inputs from the buttons and the wire.
struct PlcLogicInputs {
  bool emergency_stop{false};  ///< pressed
  EnablingSwitch enabling{EnablingSwitch::kReleased};
  bool foot_pedal{false};
  ModeSelector mode{ModeSelector::kNone};
  bool reset{false};  ///< button; acts on the press, not while held
  bool brake_test_due{false};
  std::uint16_t controller_heartbeat{0}, guard_heartbeat{0};  ///< as written last
  bool motion_request{false};
  bool guard_permits{true};  ///< the guard does not withdraw the request; valid while its heartbeat lives
};

/// Reasons why motion is not permitted: bits.
enum class PlcBlock : std::uint16_t {
  kNone = 0,
  kEmergencyStop = 1u << 0,   ///< latched: pressed, or not reset since
  kControllerLost = 1u << 1,  ///< latched: its heartbeat stopped
  kGuardLost = 1u << 2,       ///< latched: its heartbeat stopped
  kNoController = 1u << 3,    ///< no heartbeat yet
  kNoGuard = 1u << 4,
  kNoMode = 1u << 5,         ///< the selector is at none
  kNotEnabled = 1u << 6,     ///< the enabling switch is not in the middle, or came there from squeezed
  kNotRequested = 1u << 7,   ///< the controller has not requested motion (again)
  kNotReset = 1u << 8,       ///< latched: the reset button was not pressed since the PLC started
  kGuardWithdrew = 1u << 9,  ///< latched: the guard withdrew the request
};

/// The PLC's decisions.
struct PlcLogicOutputs {
  bool run_permitted{false};
  bool spindle_permitted{false};
  bool power_on{false};
  bool emergency_stop{true};  ///< as in the register: pressed, or not reset since
  std::uint16_t blocks{0};    ///< PlcBlock bits
  std::uint16_t heartbeat{0};
};

/// Text of the blocks, e.g. "emergency stop, not requested"; "none".
[[nodiscard]] std::string DescribeBlocks(std::uint16_t blocks);

/// The simulated cell's PLC program, in virtual time. The PLC is the authority:
///
///     RUN_PERMITTED  = no block                              drops in the step in which a block comes up
///     POWER_ON       = RUN_PERMITTED, and power_cut_delay on after it is lost, whatever anybody does
///     SPINDLE        = RUN_PERMITTED and foot pedal
///
/// - An emergency stop, a lost heartbeat and a request that the guard withdrew latch until the reset button
///   is pressed after the cause has gone. The start latches as well.
/// - A latched stop and a turn of the mode selector also drop the request: motion begins again only after the
///   controller withdraws its request and makes a new one. The enabling switch does not: after release and a
///   new press, motion goes on.
/// - After being squeezed through, the enabling switch must be released before its middle position counts
///   again (IEC 60204-1, 10.9).
/// - A heartbeat lives once it has changed while watched, and for heartbeat_timeout after each change.
///
/// A model of such a program, for our tests. It is no safety function, and no real cell may run on it.
class PlcLogic {
 public:
  /// @throws std::invalid_argument if a time is not positive.
  explicit PlcLogic(const PlcLogicParams& params);

  /// Runs one cycle of the program. @param now must not decrease; an earlier time counts as no time passed
  const PlcLogicOutputs& Step(rt::Nanoseconds now, const PlcLogicInputs& inputs);

  [[nodiscard]] const PlcLogicOutputs& outputs() const { return outputs_; }
  [[nodiscard]] const PlcLogicParams& params() const { return params_; }

 private:
  struct Heartbeat {
    bool seen{false}, lives{false};
    std::uint16_t value{0};
    rt::Nanoseconds changed{0};
    // Takes the heartbeat's present value. @returns true if the heartbeat has just stopped
    bool UpdateHeartbeat(rt::Nanoseconds now, std::uint16_t heartbeat, rt::Nanoseconds timeout);
  };

  PlcLogicParams params_;
  PlcLogicOutputs outputs_;
  Heartbeat controller_, guard_;
  std::uint16_t latched_;
  bool reset_before_{false}, request_before_{false};  // inputs of the step before
  bool requested_{false};                             // a valid request for motion lasts
  bool must_release_{false};                          // the enabling switch was squeezed through
  ModeSelector mode_before_{ModeSelector::kNone};
  rt::Nanoseconds now_{0}, permitted_at_{0};
  bool powered_{false};
};

}  // namespace osteon::hil
