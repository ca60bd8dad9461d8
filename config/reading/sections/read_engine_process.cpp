#include "config/reading/sections/read_engine_process.h"

#include <arpa/inet.h>

#include <charconv>
#include <utility>

#include <fmt/format.h>

namespace osteon::config {
namespace {

constexpr int kMinPort = 1024, kMaxPort = 65535;

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
  in_addr address{};
  int port = 0;
  const char* end = process.data() + process.size();
  if (colon != std::string::npos) {
    const auto [rest, error] = std::from_chars(process.data() + colon + 1, end, port);
    if (rest != end || error != std::errc{}) port = 0;
  }
  if (inet_pton(AF_INET, config.host.c_str(), &address) != 1 || port < kMinPort || port > kMaxPort)
    read.section.Refuse(
        "process", fmt::format("found {}, accepted inside, local, or IPv4:PORT such as 127.0.0.1:30300 with "
                               "a port {} … {}",
                               process, kMinPort, kMaxPort));
  config.port = static_cast<std::uint16_t>(port);
  const bool loopback = (ntohl(address.s_addr) >> 24) == 127;
  if (!loopback && !has_token)
    read.section.Refuse(
        "process", fmt::format("found {} without token_file, accepted with the file that `osteon simulate` "
                               "on that host was given: beyond the loopback it asks for a token",
                               process));
  return config;
}

}  // namespace osteon::config
