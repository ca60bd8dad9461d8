#include "console/server/web_server.h"

#include <civetweb.h>

#include <array>
#include <atomic>
#include <chrono>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/realtime_thread.h"

namespace osteon::console {
namespace {

constexpr std::chrono::milliseconds kKnock{20};  // time between the connections of KnockUntilStopped

// Address and port as in a URL, with brackets around an IPv6 address.
std::string Place(const std::string& address, int port) {
  return fmt::format("{}:{}", address.find(':') == std::string::npos ? address : "[" + address + "]", port);
}

class ListeningServer final : public WebServer {
 public:
  explicit ListeningServer(WebServerParams params) : params_(std::move(params)) {}

  ~ListeningServer() override {
    if (context_ == nullptr) return;
    std::thread knocking([this] { KnockUntilStopped(); });
    mg_stop(context_);
    stopped_.store(true);
    knocking.join();
  }

  // Tries the ports one after the other. @returns an error; empty if the server listens
  std::string Listen() {
    mg_init_library(0);
    const int tries = params_.port == 0 ? 1 : params_.ports_tried;
    for (int i = 0; i < tries && context_ == nullptr; ++i) StartOn(params_.port + i);
    if (context_ == nullptr)
      return fmt::format("{}: cannot listen on {}:{}{}: is another program there? {} PORT names another one",
                         params_.name, params_.address, params_.port,
                         tries > 1 ? fmt::format(" … {}", params_.port + tries - 1) : "", params_.option);
    std::array<mg_server_port, 2> ports{};
    if (mg_get_server_ports(context_, static_cast<int>(ports.size()), ports.data()) > 0)
      port_ = ports[0].port;
    return "";
  }

  [[nodiscard]] mg_context* context() const override { return context_; }
  [[nodiscard]] int port() const override { return port_; }
  [[nodiscard]] std::string place() const override { return Place(params_.address, port_); }

 private:
  // Connects to the server again and again until the server has ended. civetweb notices a request to end only
  // at the next connection, or after two seconds.
  void KnockUntilStopped() const {
    const std::string host =
        params_.address == "0.0.0.0" || params_.address == "::" ? "127.0.0.1" : params_.address;
    while (!stopped_.load()) {
      std::array<char, 128> error{};
      if (mg_connection* knock = mg_connect_client(host.c_str(), port_, 0, error.data(), error.size()))
        mg_close_connection(knock);
      std::this_thread::sleep_for(kKnock);
    }
  }

  // Starts civetweb on a port; context_ stays null if that fails.
  void StartOn(int port) {
    const std::string listen = Place(params_.address, port), threads = std::to_string(params_.threads),
                      files = params_.files.string();
    std::vector<const char*> options{"listening_ports",
                                     listen.c_str(),
                                     "num_threads",
                                     threads.c_str(),
                                     "request_timeout_ms",
                                     "3000",
                                     "websocket_timeout_ms",
                                     "1000",
                                     "enable_websocket_ping_pong",
                                     "yes",
                                     "enable_directory_listing",
                                     "no",
                                     "max_request_size",
                                     "8192",
                                     "tcp_nodelay",
                                     "1"};
    if (!params_.headers.empty())
      options.insert(options.end(), {"additional_header", params_.headers.c_str()});
    if (!files.empty()) options.insert(options.end(), {"document_root", files.c_str()});
    options.push_back(nullptr);
    mg_callbacks callbacks{};
    callbacks.begin_request = params_.on_request;
    callbacks.log_message = [](const mg_connection*, const char*) {
      return 1;
    };  // civetweb prints nothing: the terminal is for our own lines
    callbacks.init_thread = [](const mg_context*, int) -> void* {
      rt::NameThread("console");
      rt::LowerPriority();
      return nullptr;
    };
    context_ = mg_start(&callbacks, params_.user, options.data());
  }

  WebServerParams params_;
  int port_{0};
  std::atomic<bool> stopped_{false};
  mg_context* context_{nullptr};
};

}  // namespace

tl::expected<std::unique_ptr<WebServer>, std::string> WebServer::Start(const WebServerParams& params) {
  auto server = std::make_unique<ListeningServer>(params);
  if (const std::string wrong = server->Listen(); !wrong.empty()) return tl::unexpected(wrong);
  return server;
}

}  // namespace osteon::console
