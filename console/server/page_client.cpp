#include "console/server/page_client.h"

#include <civetweb.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <string_view>
#include <thread>

#include "base/clock.h"

namespace osteon::console {
namespace {

// Time after which a client that does not read checks again whether it must end.
constexpr std::chrono::milliseconds kPollInterval{20};
constexpr std::size_t kStampLength = 24;  // maximum number of characters of a stamp

// A client that uses civetweb. civetweb's thread calls OnData for each message.
class Client final : public PageClient {
 public:
  explicit Client(bool reads) : reads_(reads) {}
  ~Client() override {
    ending_.store(true);
    if (connection_ != nullptr) mg_close_connection(connection_);
  }

  // @returns an error; empty: connected
  std::string Connect(const std::string& host, int port) {
    std::array<char, 256> error{};
    connection_ = mg_connect_websocket_client(host.c_str(), port, 0, error.data(), error.size(), "/live",
                                              ("http://" + host).c_str(), OnData, nullptr, this);
    return connection_ != nullptr ? "" : std::string(error.data());
  }

  [[nodiscard]] std::uint64_t messages() const override { return messages_.load(); }
  [[nodiscard]] std::uint64_t bytes() const override { return bytes_.load(); }
  [[nodiscard]] std::vector<double> received_ms() const override {
    const std::lock_guard lock(mutex_);
    return received_ms_;
  }
  [[nodiscard]] Bone bone() const override {
    const std::lock_guard lock(mutex_);
    return bone_;
  }

 private:
  // Counts a message. If the client shall not read, blocks until the client ends.
  static int OnData(mg_connection*, int bits, char* data, std::size_t size, void* user) {
    auto& client = *static_cast<Client*>(user);
    while (!client.reads_ && !client.ending_.load()) std::this_thread::sleep_for(kPollInterval);
    ++client.messages_;
    client.bytes_ += size;
    client.OnLiveMessage(std::string_view(data, size));
    client.OnBoneMessage((bits & 0x0F) == MG_WEBSOCKET_OPCODE_BINARY, std::string_view(data, size));
    return 1;
  }

  // Reads the stamp of the newest tick, which is the first number of the last window, from
  // {"type":"live","windows":[[stamp, …], …, [stamp, …]],"status": …
  void OnLiveMessage(std::string_view message) {
    constexpr std::string_view kLive = R"({"type":"live")", kEnd = R"(]],"status")";
    if (!message.starts_with(kLive)) return;
    const std::size_t end = message.find(kEnd);
    const std::size_t row = end == std::string_view::npos ? end : message.rfind('[', end);
    if (row == std::string_view::npos) return;
    const double stamp_s = std::strtod(std::string(message.substr(row + 1, kStampLength)).c_str(), nullptr);
    const std::lock_guard lock(mutex_);
    received_ms_.push_back(1e3 * (rt::ToSeconds(rt::MonotonicNow()) - stamp_s));
  }

  // Counts a message of the bone's mesh, or notes that a change of the bone is complete.
  void OnBoneMessage(bool is_mesh, std::string_view message) {
    constexpr std::string_view kWhole = R"({"type":"surface_whole")", kAge = R"("age_ms":)";
    const bool is_whole = !is_mesh && message.starts_with(kWhole);
    if (!is_mesh && !is_whole) return;
    const auto now = std::chrono::steady_clock::now();
    const std::lock_guard lock(mutex_);
    if (is_mesh && first_whole_) {
      ++bone_.messages;
      bone_.bytes += message.size();
    }
    if (!is_whole) return;
    if (!first_whole_) first_whole_ = now;
    bone_.whole_s.push_back(std::chrono::duration<double>(now - *first_whole_).count());
    const std::size_t age = message.find(kAge);
    bone_.age_ms.push_back(
        age == std::string_view::npos
            ? 0.0
            : std::strtod(std::string(message.substr(age + kAge.size())).c_str(), nullptr));
  }

  const bool reads_;
  std::atomic<bool> ending_{false};
  std::atomic<std::uint64_t> messages_{0}, bytes_{0};
  mutable std::mutex mutex_;  // guards bone_, received_ms_ and first_whole_
  Bone bone_;
  std::vector<double> received_ms_;
  std::optional<std::chrono::steady_clock::time_point> first_whole_;  // when the first change was complete
  mg_connection* connection_{nullptr};
};

}  // namespace

tl::expected<std::unique_ptr<PageClient>, std::string> PageClient::Open(const std::string& host, int port,
                                                                        bool reads) {
  auto client = std::make_unique<Client>(reads);
  if (const std::string wrong = client->Connect(host, port); !wrong.empty())
    return tl::unexpected(host + ":" + std::to_string(port) + ": " + wrong);
  return client;
}

}  // namespace osteon::console
