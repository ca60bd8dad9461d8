#include "io/can/frame.h"

#include <fmt/format.h>

#include <algorithm>

namespace osteon::io {

std::string ToText(const CanFrame& frame) {
  std::string text = fmt::format("{:03X}#", frame.id);
  for (std::size_t i = 0; i < std::min<std::size_t>(frame.size, frame.data.size()); ++i)
    text += fmt::format("{:02X}", frame.data[i]);
  return text;
}

std::string IdText(std::uint16_t id) { return fmt::format("0x{:03X}", id); }

}  // namespace osteon::io
