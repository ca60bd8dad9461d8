#include "config/reading/sections/read_guard.h"

#include <fmt/format.h>

namespace osteon::config {

GuardConfig ReadGuard(Reader& cell_section, const ArmLinkConfig& link) {
  if (!link.fri())
    cell_section.Refuse("guard", "found beside rsi, accepted with fri: the guard reads FRI's messages alone");
  Reader section = cell_section.Section("guard");
  GuardConfig guard{.host = "127.0.0.1"};
  if (section.Has("host")) guard.host = section.Text("host");
  guard.port = static_cast<std::uint16_t>(section.WholeNumber("port", 1024, 65535));
  if (section.Has("margin_ratio")) guard.margin = section.Number("margin_ratio", 0, 1);
  if (section.Has("silence_ms")) guard.silence_s = section.Number("silence_ms", 5, 1000);
  if (guard.port == link.port)
    section.Refuse(
        "port",
        fmt::format("found {}, accepted another one than fri's: the controller listens there", guard.port));
  return guard;
}

}  // namespace osteon::config
