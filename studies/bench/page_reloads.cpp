#include "studies/bench/page_reloads.h"

#include <chrono>
#include <regex>
#include <sstream>
#include <string_view>
#include <thread>

#include <fmt/format.h>

#include "base/interrupt.h"
#include "base/read_text.h"
#include "io/net/tcp_stream.h"

namespace osteon::studies {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kEveryKilled = 3;  // every third page is killed
constexpr std::chrono::seconds kSettles{
    4};  // longest wait until the last pages' threads and sockets are gone
constexpr std::chrono::milliseconds kSettleLooks{50};  // time between two measurements of the resources
constexpr double kPatience_s = 60.0;         // for a page: the bone's thread gives way to all others
constexpr std::size_t kMaxRead = 64u << 20;  // number of bytes after which AwaitText gives up

// Reads into `got` until it contains a text. @returns false if the text did not arrive in time, or if the
// server closed the connection before
bool AwaitText(io::TcpStream& stream, std::string& got, std::string_view text, double patience_s) {
  const auto end =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(patience_s));
  std::size_t looked = 0;
  while (got.find(text, looked) == std::string::npos) {
    looked = got.size() < text.size() ? 0 : got.size() - text.size();
    if (Clock::now() > end || got.size() > kMaxRead || stream.closed()) return false;
    got += stream.Receive(std::chrono::milliseconds(100));
  }
  return true;
}

// Loads one file of the page by HTTP, and waits for its end.
tl::expected<void, std::string> LoadFile(const std::string& address, std::uint16_t port,
                                         const std::string& file, double patience_s) {
  auto stream = io::TcpStream::Connect(address, port);
  if (!stream) return tl::make_unexpected(stream.error());
  std::string got;
  if (!stream->Send(
          fmt::format("GET /{} HTTP/1.1\r\nHost: {}:{}\r\nConnection: close\r\n\r\n", file, address, port)) ||
      !AwaitText(*stream, got, "\r\n\r\n", patience_s) || !got.starts_with("HTTP/1.1 200"))
    return tl::make_unexpected(fmt::format("/{}: found \"{}\"", file, got.substr(0, got.find('\r'))));
  while (!stream->Receive(std::chrono::milliseconds(200)).empty()) continue;
  return {};
}

constexpr std::chrono::seconds kPortComes{60};       // longest wait for the port's message
constexpr std::chrono::milliseconds kPortLooks{50};  // time between two polls for the message

// The number behind a name in a text; 0 if the name is not found.
double NumberAfter(const std::string& text, const std::string& name) {
  const std::size_t at = text.find(name);
  if (at == std::string::npos) return 0.0;
  std::istringstream rest(text.substr(at + name.size()));
  double value = 0.0;
  rest >> value;
  return value;
}

}  // namespace

int AwaitConsolePort(base::ChildProcess& demo, const std::filesystem::path& err) {
  static const std::regex kAddress("console: http://127\\.0\\.0\\.1:([0-9]+)/");
  for (const auto end = Clock::now() + kPortComes; Clock::now() < end;) {
    std::smatch found;
    const std::string text = base::ReadText(err);
    if (std::regex_search(text, found, kAddress)) return std::stoi(found[1]);
    if (demo.Ended() || base::Interrupted().load()) return 0;
    std::this_thread::sleep_for(kPortLooks);
  }
  return 0;
}

tl::expected<void, std::string> LoadPageAndLeave(const std::string& address, std::uint16_t port, PageEnd end,
                                                 PageStay stay, double patience_s) {
  for (const char* file : {"", "main.js", "main.css"})
    if (auto loaded = LoadFile(address, port, file, patience_s); !loaded) return loaded;
  auto stream = io::TcpStream::Connect(address, port);
  if (!stream) return tl::make_unexpected(stream.error());
  std::string got;
  if (!stream->Send(fmt::format("GET /live HTTP/1.1\r\nHost: {0}:{1}\r\nOrigin: http://{0}:{1}\r\n"
                                "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
                                "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n",
                                address, port)) ||
      !AwaitText(*stream, got, "\r\n\r\n", patience_s) || !got.starts_with("HTTP/1.1 101"))
    return tl::make_unexpected(fmt::format("/live: found \"{}\"", got.substr(0, got.find('\r'))));
  const auto missing = [&](const char* what) {
    return tl::make_unexpected(
        fmt::format("/live: {}{}", what, stream->closed() ? ": the server closed the connection" : ""));
  };
  if (!AwaitText(*stream, got, R"({"type":"live")", patience_s)) return missing("no live message came");
  if (stay == PageStay::kMotion && !AwaitText(*stream, got, R"("moves":true)", patience_s))
    return missing("the arm did not move");
  if (stay == PageStay::kWholeBone && !AwaitText(*stream, got, R"({"type":"surface_whole")", patience_s))
    return missing("the bone did not come whole");
  if (end == PageEnd::kKilled) {
    stream->Kill();
    return {};
  }
  constexpr std::string_view kClose{"\x88\x82\x00\x00\x00\x00\x03\xe9",
                                    8};  // close code 1001 (going away), masked with zeros
  if (!stream->Send(kClose)) return tl::make_unexpected(std::string("/live: gone before it was closed"));
  while (!stream->Receive(std::chrono::milliseconds(500)).empty()) continue;
  return {};
}

ProcessHolds HoldsOf(pid_t process) {
  const std::string folder = fmt::format("/proc/{}", process);
  ProcessHolds holds;
  const std::string status = base::ReadText(folder + "/status");
  holds.resident_MB = NumberAfter(status, "VmRSS:") / 1024.0;
  holds.threads = static_cast<int>(NumberAfter(status, "Threads:"));
  std::error_code error;
  for (std::filesystem::directory_iterator at(folder + "/fd", error), end; !error && at != end;
       at.increment(error))
    ++holds.descriptors;
  return holds;
}

namespace {

/// Waits until a process holds no more resources than before, at most kSettles.
/// @returns the resources that it holds then
ProcessHolds SettledHolds(pid_t process, const ProcessHolds& before) {
  const auto until = Clock::now() + kSettles;
  ProcessHolds holds = HoldsOf(process);
  while ((holds.descriptors > before.descriptors || holds.threads > before.threads) && Clock::now() < until) {
    std::this_thread::sleep_for(kSettleLooks);
    holds = HoldsOf(process);
  }
  return holds;
}

}  // namespace

ReloadFigures ReloadPages(const std::string& address, std::uint16_t port, pid_t process, int reloads,
                          const std::function<bool(int done)>& goes_on) {
  ReloadFigures figures;
  figures.before = HoldsOf(process);
  const auto began = Clock::now();
  for (int i = 0; i < reloads && goes_on(i); ++i) {
    const PageEnd end = i % kEveryKilled == kEveryKilled - 1 ? PageEnd::kKilled : PageEnd::kCloses;
    const bool warms = i + 1 == (reloads + 9) / 10;
    const PageStay stay = warms ? PageStay::kWholeBone : PageStay::kLiveMessage;
    if (const auto loaded = LoadPageAndLeave(address, port, end, stay, kPatience_s)) {
      ++figures.loaded;
      if (end == PageEnd::kKilled) ++figures.killed;
    } else {
      figures.failed.push_back(fmt::format("page {}: {}", i + 1, loaded.error()));
    }
    if (warms) figures.warm = SettledHolds(process, figures.before);
  }
  figures.after = SettledHolds(process, figures.warm);
  figures.seconds = std::chrono::duration<double>(Clock::now() - began).count();
  return figures;
}

bool LeftNothing(const ReloadFigures& figures) {
  return figures.after.descriptors > 0 && figures.after.descriptors <= figures.warm.descriptors &&
         figures.after.threads <= figures.warm.threads &&
         figures.after.resident_MB - figures.warm.resident_MB <= kFlat_MB;
}

}  // namespace osteon::studies
