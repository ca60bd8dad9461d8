#include "app/build_name.h"

#include <sys/utsname.h>
#include <unistd.h>

#include <array>
#include <fstream>

#include <fmt/format.h>

#include "app/commit.h"

namespace osteon::app {

std::string BuildName() {
  std::array<char, 64> library{};
  confstr(_CS_GNU_LIBC_VERSION, library.data(), library.size());
  return fmt::format("commit {}, gcc {}, {}", kCommit, __VERSION__, library.data());
}

std::string MachineName() {
  std::string processor = "unknown processor", line;
  std::ifstream cpuinfo("/proc/cpuinfo");
  while (std::getline(cpuinfo, line))
    if (line.starts_with("model name") && line.find(": ") != std::string::npos) {
      processor = line.substr(line.find(": ") + 2);
      break;
    }
  utsname system{};
  uname(&system);
  return fmt::format("{}, {} {} {}", processor, system.sysname, system.release, system.machine);
}

}  // namespace osteon::app
