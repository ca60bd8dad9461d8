#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "base/marker.h"

// The holding registers that the controller, the guard and the cell's PLC exchange. This is their only
// definition. Addresses are those in a Modbus frame, counted from 0. 970, 973, 974 and 977 are those of
// Pilz's published map for the PSS4000; this project defines the others.
//
//     970 OPERATION_MODE      0 none, 1 T1, 2 T2, 3 AUTO
//     973 BRAKETEST_REQUEST   1 a brake test is due
//     974 RUN_PERMITTED       1 motion is allowed; 0: ramp down now, power is cut after the PLC's delay
//     977 VERSION             version of this map, 3; checked before anything is written
//     978 EMERGENCY_STOP      1 pressed, or not reset since
//     979 ENABLING_SWITCH     0 released, 1 middle: enabled, 2 squeezed through
//     980 FOOT_PEDAL          1 pressed
//     981 SPINDLE_PERMITTED   1 the reamer may turn
//     982 POWER_ON            1 the arm's drives have power
//     983 PLC_HEARTBEAT       changes with each cycle of the PLC's program
//     990 CONTROLLER_HEARTBEAT  written by the controller, another number at least every 100 ms
//     991 MOTION_REQUEST        written by the controller: 1 wants to move
//     992 GUARD_HEARTBEAT       written by the guard, another number at least every 100 ms
//     993 GUARD_PERMITS         written by the guard: 1 the motion request stays, 0 it is withdrawn
//
// 970 … 983 are read as one block; 971, 972, 975 and 976 are unused. Controller and guard write only 990 …
// 993.

namespace osteon::io {

inline constexpr int kPlcFirstRead = 970;  ///< address of the block's first register
inline constexpr int kPlcReadCount = 14;   ///< number of registers of the block
inline constexpr int kPlcControllerHeartbeat = 990;
inline constexpr int kPlcMotionRequest = 991;
inline constexpr int kPlcGuardHeartbeat = 992;
inline constexpr int kPlcGuardPermits = 993;
inline constexpr std::uint16_t kPlcVersion = 3;
/// Port of the simulated cell's PLC; a real PLC listens on 502.
inline constexpr std::uint16_t kPlcDefaultPort = 1502;

enum class PlcMode : std::uint8_t { kNone = 0, kT1 = 1, kT2 = 2, kAutomatic = 3 };
enum class PlcEnabling : std::uint8_t { kReleased = 0, kEnabled = 1, kSqueezed = 2 };

/// The values that the controller reads from the PLC, checked. Plain data.
struct PlcInputs {
  PlcMode mode{PlcMode::kNone};
  bool brake_test_requested{false};
  bool run_permitted{false};
  std::uint16_t version{0};
  bool emergency_stop{true};
  PlcEnabling enabling{PlcEnabling::kReleased};
  bool foot_pedal{false};
  bool spindle_permitted{false};
  bool power_on{false};
  std::uint16_t heartbeat{0};
};

/// A register with an invalid value.
struct PlcBadRegister {
  int address{0};
  std::uint16_t found{0};
  std::uint16_t accepted_most{0};  ///< largest accepted value; the smallest is 0
};

/// Checks and decodes one block. @returns the first register with a value out of range. If there is none,
/// `inputs` is set; if VERSION is another one, only inputs.version is set.
[[nodiscard]] std::optional<PlcBadRegister> DecodePlc(std::span<const std::uint16_t, kPlcReadCount> block,
                                                      PlcInputs& inputs) OSTEON_RT;

}  // namespace osteon::io
