#pragma once

#include <cstdint>

#include "base/clock.h"
#include "base/marker.h"
#include "io/modbus/register_map.h"

namespace osteon::io {

enum class PlcLink : std::uint8_t {
  kConnecting,    ///< there is no connection yet, or it was lost; attempts follow with growing pauses
  kConnected,     ///< the last read was answered
  kWrongVersion,  ///< VERSION is not kPlcVersion: nothing is written to the PLC
};

/// Counters since the client's start.
struct PlcCounters {
  std::uint32_t reads{0}, writes{0};  ///< requests that were answered
  std::uint32_t timeouts{0};          ///< requests without an answer within the response timeout
  std::uint32_t lost{0};              ///< connections that ended, for any reason
  std::uint32_t refused{0};           ///< attempts to connect that failed
  /// Answers that are an exception, violate the protocol, or contain an invalid value.
  std::uint32_t rejected{0};
};

/// The state of the PLC as the tick gets it. Plain data.
struct PlcReading {
  rt::Nanoseconds stamp{0};  ///< time at which the block was requested; 0: no block yet
  PlcLink link{PlcLink::kConnecting};
  PlcInputs inputs{};
  rt::Nanoseconds heartbeat_changed{0};  ///< stamp of the block in which PLC_HEARTBEAT last changed
  PlcBadRegister bad{};                  ///< the last register with a value out of range; address 0: none
  int last_error{0};                     ///< errno (libmodbus' included) of the last failure; 0: none
  PlcCounters counters{};
};

/// Reason why motion is not permitted. The first reason that applies is used.
enum class PlcVerdict : std::uint8_t {
  kRun = 0,
  kNoConnection,   ///< no connection to the PLC: Stop 1
  kWrongVersion,   ///< another version of the register map: no motion starts
  kStale,          ///< the block is older than max_age: Stop 1
  kPlcStopped,     ///< the PLC answers, but its program does not run: Stop 1
  kEmergencyStop,  ///< the PLC reports an emergency stop: Stop 1
  kNotPermitted,   ///< RUN_PERMITTED is 0: Stop 1
};

/// Returns whether the arm may move. @param max_age largest age of the block [ns]; twice that for the last
/// change of the PLC's heartbeat
[[nodiscard]] inline PlcVerdict Judge(const PlcReading& reading, rt::Nanoseconds now,
                                      rt::Nanoseconds max_age) OSTEON_RT {
  if (reading.link == PlcLink::kWrongVersion) return PlcVerdict::kWrongVersion;
  if (reading.link != PlcLink::kConnected || reading.stamp == 0) return PlcVerdict::kNoConnection;
  if (now - reading.stamp > max_age) return PlcVerdict::kStale;
  if (now - reading.heartbeat_changed > 2 * max_age) return PlcVerdict::kPlcStopped;
  if (reading.inputs.emergency_stop) return PlcVerdict::kEmergencyStop;
  return reading.inputs.run_permitted ? PlcVerdict::kRun : PlcVerdict::kNotPermitted;
}

}  // namespace osteon::io
