#pragma once

#include <cstdint>
#include <string>

// What a drive's faults are called: by the latch that saw them, and by the drive's own numbers.

namespace osteon::io {

/// Numbers of a drive's faults, as status and recording have them. Plain data.
struct DriveFaultReport {
  std::uint32_t faults{0};          ///< DriveFault bits
  std::uint8_t nmt_state{0};        ///< of its last heartbeat
  std::uint16_t emergency_code{0};  ///< of its last EMCY; 0: none
  std::uint16_t error_code{0};      ///< object 603F; 0: none
};

/// What an error code means, of an EMCY or of object 603F: of CiA 402's list where it is there, by its class
/// of CiA 301 otherwise, e.g. "under-voltage of the DC link". Not for the tick.
[[nodiscard]] const char* DescribeErrorCode(std::uint16_t code);

/// Each latched fault by its name and number, then the codes that are there, e.g. "EMCY 0x4310 (excess
/// temperature of the drive) (bit 2); in fault by its statusword (bit 3); 603F 0x4310 (…)". Empty where
/// nothing is latched and no code is there. Not for the tick.
[[nodiscard]] std::string DescribeDriveFaults(const DriveFaultReport& report);

}  // namespace osteon::io
