#include "io/modbus/register_map.h"

namespace osteon::io {

std::optional<PlcBadRegister> DecodePlc(std::span<const std::uint16_t, kPlcReadCount> block,
                                        PlcInputs& inputs) OSTEON_RT {
  struct Range {
    int address;
    std::uint16_t max;
  };
  constexpr std::array<Range, 8> kRanges{
      {{970, 3}, {973, 1}, {974, 1}, {978, 1}, {979, 2}, {980, 1}, {981, 1}, {982, 1}}};
  const auto at = [&](int address) { return block[static_cast<std::size_t>(address - kPlcFirstRead)]; };

  // check the version first, because in another version the registers may have other meanings
  PlcInputs read;
  read.version = at(977);
  if (read.version != kPlcVersion) {
    inputs = read;
    return {};
  }
  for (const Range& range : kRanges)
    if (at(range.address) > range.max)
      return PlcBadRegister{.address = range.address, .found = at(range.address), .accepted_most = range.max};
  read.mode = static_cast<PlcMode>(at(970));
  read.brake_test_requested = at(973) == 1;
  read.run_permitted = at(974) == 1;
  read.emergency_stop = at(978) == 1;
  read.enabling = static_cast<PlcEnabling>(at(979));
  read.foot_pedal = at(980) == 1;
  read.spindle_permitted = at(981) == 1;
  read.power_on = at(982) == 1;
  read.heartbeat = at(983);
  inputs = read;
  return {};
}

}  // namespace osteon::io
