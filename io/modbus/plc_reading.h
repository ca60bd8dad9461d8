#pragma once

#include <cstdint>

#include "base/clock.h"
#include "base/marker.h"
#include "io/modbus/register_map.h"

namespace osteon::io {

enum class PlcLink : std::uint8_t {
  kConnecting,    ///< no connection yet, or lost: trying again with growing pauses
  kConnected,     ///< the last read was answered
  kWrongVersion,  ///< VERSION is not kPlcVersion: nothing is written to this PLC
};

/// Counts since the client began.
struct PlcCounters {
  std::uint32_t reads{0}, writes{0};  ///< answered
  std::uint32_t timeouts{0};          ///< no answer within the response timeout
  std::uint32_t lost{0};              ///< connections that ended, for any reason
  std::uint32_t refused{0};           ///< attempts to connect that failed
  std::uint32_t rejected{0};  ///< answers with an exception, out of protocol, or a value that does not exist
};

/// The tick's view of the PLC. Plain data.
struct PlcReading {
  rt::Nanoseconds stamp{0};  ///< time at which the block was requested; 0: none yet
  PlcLink link{PlcLink::kConnecting};
  PlcInputs inputs{};
  rt::Nanoseconds heartbeat_changed{0};  ///< stamp of the block in which PLC_HEARTBEAT last changed
  PlcBadRegister bad{};                  ///< the last register that was out of range; address 0: none
  int last_error{0};                     ///< errno (libmodbus' included) of the last failure; 0: none
  PlcCounters counters{};
};

/// Why motion is not permitted; the first reason that applies.
enum class PlcVerdict : std::uint8_t {
  kRun = 0,
  kNoConnection,   ///< Stop 1
  kWrongVersion,   ///< no start
  kStale,          ///< the block is older than max_age: Stop 1
  kPlcStopped,     ///< the PLC answers, but its program does not run: Stop 1
  kEmergencyStop,  ///< Stop 1
  kNotPermitted,   ///< RUN_PERMITTED is 0: Stop 1
};

/// Whether the arm may move. @param max_age of the block [ns]; twice that for the PLC's heartbeat
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
