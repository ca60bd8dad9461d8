#include "io/can/frame.h"

#include <fmt/format.h>

namespace osteon::io {

std::string IdText(std::uint16_t id) { return fmt::format("0x{:03X}", id); }

}  // namespace osteon::io
