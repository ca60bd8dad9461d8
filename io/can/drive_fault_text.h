#pragma once

#include <cstdint>
#include <string>

// Text for a drive's faults: the latched bits and the error codes that the drive reports.

namespace osteon::io {

/// Numbers of a drive's faults, for status and recording. Plain data.
struct DriveFaultReport {
  std::uint32_t faults{0};          ///< DriveFault bits
  std::uint8_t nmt_state{0};        ///< NMT state in its last heartbeat
  std::uint16_t emergency_code{0};  ///< error code in its last EMCY; 0: none
  std::uint16_t error_code{0};      ///< object 603F; 0: none
};

/// Meaning of an error code of an EMCY or of object 603F, e.g. "under-voltage of the DC link": from the list
/// of CiA 402 if that contains the code, otherwise the text of its class in CiA 301. Not for use in the tick.
[[nodiscard]] const char* DescribeErrorCode(std::uint16_t code);

/// Returns the name and number of each latched fault, then the error codes, e.g. "EMCY 0x4310 (excess
/// temperature of the drive) (bit 2); in fault by its statusword (bit 3); 603F 0x4310 (…)". Empty if nothing
/// is latched and there is no code. Not for the tick.
[[nodiscard]] std::string DescribeDriveFaults(const DriveFaultReport& report);

}  // namespace osteon::io
