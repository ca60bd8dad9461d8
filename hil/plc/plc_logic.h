#pragma once

#include <cstdint>
#include <string>

#include "control/rt/clock.h"

namespace osteon::hil {

enum class ModeSelector : std::uint8_t { kNone = 0, kT1 = 1, kT2 = 2, kAutomatic = 3 };
/// A three-position device.
enum class EnablingSwitch : std::uint8_t { kReleased = 0, kMiddle = 1, kSqueezed = 2 };

struct PlcLogicParams {
  rt::Nanoseconds heartbeat_timeout{250 * rt::kMillisecond};  ///< since a heartbeat last changed; > 0
  rt::Nanoseconds power_cut_delay{500 * rt::kMillisecond};    ///< from the loss of RUN_PERMITTED; > 0
  bool guard{true};  ///< a guard is part of the cell: its heartbeat is watched
  std::uint16_t version{3};
};

/// What the buttons and the wire say.
struct PlcLogicInputs {
  bool emergency_stop{false};  ///< pressed
  EnablingSwitch enabling{EnablingSwitch::kReleased};
  bool foot_pedal{false};
  ModeSelector mode{ModeSelector::kNone};
  bool reset{false};  ///< button; acts when it is pressed, not while it is held
  bool brake_test_due{false};
  std::uint16_t controller_heartbeat{0}, guard_heartbeat{0};  ///< as written last
  bool motion_request{false};
  bool guard_permits{true};  ///< the guard lets the request stand; counts while its heartbeat lives
};

/// Why motion is not permitted: bits.
enum class PlcBlock : std::uint16_t {
  kNone = 0,
  kEmergencyStop = 1u << 0,   ///< latched: pressed, or not reset since
  kControllerLost = 1u << 1,  ///< latched: its heartbeat stood still
  kGuardLost = 1u << 2,       ///< latched: the same of the guard
  kNoController = 1u << 3,    ///< no heartbeat yet
  kNoGuard = 1u << 4,
  kNoMode = 1u << 5,         ///< the selector is at none
  kNotEnabled = 1u << 6,     ///< the enabling switch is not in the middle, or came there from squeezed
  kNotRequested = 1u << 7,   ///< the controller has not asked (anew) for motion
  kNotReset = 1u << 8,       ///< since the PLC started
  kGuardWithdrew = 1u << 9,  ///< latched: the guard took the request back
};

/// What the PLC decides.
struct PlcLogicOutputs {
  bool run_permitted{false};
  bool spindle_permitted{false};
  bool power_on{false};
  bool emergency_stop{true};  ///< as the register says: pressed, or not reset since
  std::uint16_t blocks{0};    ///< PlcBlock bits
  std::uint16_t heartbeat{0};
};

/// The blocks in words, e.g. "emergency stop, not requested"; "none".
[[nodiscard]] std::string DescribeBlocks(std::uint16_t blocks);

/// The simulated cell's PLC program, in virtual time. The PLC is the authority:
///
///     RUN_PERMITTED  = no block                              drops in the step in which a block comes up
///     POWER_ON       = RUN_PERMITTED, and power_cut_delay on after it is lost, whatever anybody does
///     SPINDLE        = RUN_PERMITTED and foot pedal
///
/// - An emergency stop, a lost heartbeat and a request that the guard took back latch until the reset button
/// is pressed with the cause gone. So does the
///   start.
/// - A latched stop and a turn of the mode selector also take the request back: motion begins again only
/// where the
///   controller withdraws its request and makes it anew. The enabling switch does not: let go and taken
///   again, motion goes on.
/// - The enabling switch, squeezed through, has to be let go before its middle counts again (IEC
/// 60204-1, 10.9).
/// - A heartbeat lives once it has changed while we watch, and for heartbeat_timeout after each change.
///
/// A model of such a program for tests of ours. It is no safety function, and no real cell may run on it.
class PlcLogic {
 public:
  /// @throws std::invalid_argument where a time is not positive.
  explicit PlcLogic(const PlcLogicParams& params);

  /// One cycle of the program. @param now never less than before; less counts as no time
  const PlcLogicOutputs& Step(rt::Nanoseconds now, const PlcLogicInputs& inputs);

  [[nodiscard]] const PlcLogicOutputs& outputs() const { return outputs_; }
  [[nodiscard]] const PlcLogicParams& params() const { return params_; }

 private:
  struct Heartbeat {
    bool seen{false}, lives{false};
    std::uint16_t value{0};
    rt::Nanoseconds changed{0};
    // True where it was alive and is not any more.
    bool Watch(rt::Nanoseconds now, std::uint16_t heartbeat, rt::Nanoseconds timeout);
  };

  PlcLogicParams params_;
  PlcLogicOutputs outputs_;
  Heartbeat controller_, guard_;
  std::uint16_t latched_;
  bool reset_before_{false}, request_before_{false}, requested_{false};
  bool must_release_{false};  // the enabling switch was squeezed through
  ModeSelector mode_before_{ModeSelector::kNone};
  rt::Nanoseconds now_{0}, permitted_at_{0};
  bool powered_{false};
};

}  // namespace osteon::hil
