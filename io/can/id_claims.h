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

/// A range of identifiers that a device uses on its bus, for sending or receiving.
struct IdClaim {
  std::string device;   ///< name in errors, e.g. "reamer drive (node 5)"
  std::string purpose;  ///< e.g. "RPDO1"
  std::uint16_t first{0}, last{0};
  std::string advice{};  ///< instruction for the user in case of a conflict
};

/// All identifiers that a device with these parameters uses.
[[nodiscard]] std::vector<IdClaim> Claims(const RobotousParams& params);
[[nodiscard]] std::vector<IdClaim> Claims(const AtiParams& params);
[[nodiscard]] std::vector<IdClaim> Claims(const ReamerDriveParams& params);

/// Finds two devices of one bus that use the same identifier. Returns a text that names both devices, the
/// identifiers and what to do; empty if there are no such devices. Claims of one device may overlap.
[[nodiscard]] std::optional<std::string> FindOverlap(std::span<const IdClaim> claims);

}  // namespace osteon::io
