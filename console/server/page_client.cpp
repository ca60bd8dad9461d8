#include "console/server/page_client.h"

#include <civetweb.h>

#include <array>
#include <chrono>
#include <thread>

namespace osteon::console {
namespace {

constexpr std::chrono::milliseconds kHangs{20};

class Client final : public PageClient {
 public:
  explicit Client(bool reads) : reads_(reads) {}
  ~Client() override {
    ending_.store(true);
    if (connection_ != nullptr) mg_close_connection(connection_);
  }

  std::string Connect(const std::string& host, int port) {
    std::array<char, 256> error{};
    connection_ = mg_connect_websocket_client(host.c_str(), port, 0, error.data(), error.size(), "/live",
                                              ("http://" + host).c_str(), OnData, nullptr, this);
    return connection_ != nullptr ? "" : std::string(error.data());
  }

  [[nodiscard]] std::uint64_t messages() const override { return messages_.load(); }
  [[nodiscard]] std::uint64_t bytes() const override { return bytes_.load(); }

 private:
  static int OnData(mg_connection*, int, char*, std::size_t size, void* user) {
    auto& client = *static_cast<Client*>(user);
    while (!client.reads_ && !client.ending_.load()) std::this_thread::sleep_for(kHangs);
    ++client.messages_;
    client.bytes_ += size;
    return 1;
  }

  const bool reads_;
  std::atomic<bool> ending_{false};
  std::atomic<std::uint64_t> messages_{0}, bytes_{0};
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
