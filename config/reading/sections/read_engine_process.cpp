#include "config/reading/sections/read_engine_process.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include <fmt/format.h>

namespace osteon::config {
namespace {

constexpr int kMinPort = 1024, kMaxPort = 65535;  // accepted ports of an engine

// Parses [begin, end) as a whole number 0 … max. @returns -1 if it is none
int WholeNumber(const char* begin, const char* end, int max) {
  int value = -1;
  const auto [rest, error] = std::from_chars(begin, end, value);
  return rest == end && error == std::errc{} && *begin != '-' && value <= max ? value : -1;
}

// Whether a text is four numbers 0 … 255 with points between them.
bool IsIpv4(const std::string& address) {
  int numbers = 0;
  for (std::size_t begin = 0; begin <= address.size(); ++numbers) {
    const std::size_t end = std::min(address.find('.', begin), address.size());
    if (end == begin || WholeNumber(address.data() + begin, address.data() + end, 255) < 0) return false;
    begin = end + 1;
  }
  return numbers == 4;
}

}  // namespace

EngineProcessSection ReadEngineProcess(Reader section) {
  std::string process = section.Text("process");
  std::optional<std::string> token_file;
  if (section.Has("token_file")) token_file = section.Text("token_file");
  return {.section = std::move(section), .process = std::move(process), .token_file = std::move(token_file)};
}

std::optional<EngineProcessConfig> CheckEngineProcess(const EngineProcessSection& read) {
  const std::string& process = read.process;
  const bool has_token = read.token_file.has_value();
  const std::size_t colon = process.find(':');
  if (process == "inside" || process == "local") {
    if (has_token)
      read.section.Refuse("token_file",
                          fmt::format("found with process: {}, accepted with HOST:PORT", process));
    if (process == "inside") return std::nullopt;
    return EngineProcessConfig{};
  }
  EngineProcessConfig config{.host = process.substr(0, colon), .token_file = read.token_file.value_or("")};
  const int port = colon == std::string::npos || colon + 1 == process.size()
                       ? -1
                       : WholeNumber(process.data() + colon + 1, process.data() + process.size(), kMaxPort);
  if (!IsIpv4(config.host) || port < kMinPort)
    read.section.Refuse(
        "process", fmt::format("found {}, accepted inside, local, or IPv4:PORT such as 127.0.0.1:30300 with "
                               "a port {} … {}",
                               process, kMinPort, kMaxPort));
  config.port = static_cast<std::uint16_t>(port);
  if (!config.host.starts_with("127.") && !has_token)
    read.section.Refuse(
        "process", fmt::format("found {} without token_file, accepted with the file that `osteon simulate` "
                               "on that host was given: beyond the loopback it asks for a token",
                               process));
  return config;
}

}  // namespace osteon::config
