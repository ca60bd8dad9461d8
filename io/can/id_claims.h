#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/can/ati_sensor.h"
#include "io/can/reamer_drive.h"
#include "io/can/robotous_sensor.h"

namespace osteon::io {

/// Identifiers that a device uses on its bus, in either direction.
struct IdClaim {
  std::string device;   ///< as errors name it, e.g. "reamer drive (node 5)"
  std::string purpose;  ///< e.g. "RPDO1"
  std::uint16_t first{0}, last{0};
  std::string advice{};  ///< what to do where it is in somebody's way
};

[[nodiscard]] std::vector<IdClaim> Claims(const RobotousParams& params);
[[nodiscard]] std::vector<IdClaim> Claims(const AtiParams& params);
[[nodiscard]] std::vector<IdClaim> Claims(const ReamerDriveParams& params);

/// Two devices of one bus that use the same identifier: text that names both, the identifiers and what to do.
/// Empty where there are none. A device's own claims may meet.
[[nodiscard]] std::optional<std::string> FindOverlap(std::span<const IdClaim> claims);

}  // namespace osteon::io
