#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

struct mg_connection;
struct mg_context;

namespace osteon::console {

/// civetweb's texts, which are null where there is none.
[[nodiscard]] inline std::string_view OrEmpty(const char* text) { return text == nullptr ? "" : text; }

struct WebServerParams {
  std::string name;               ///< in errors: "console"
  std::string option;             ///< that names another address: "--console"
  std::string address;            ///< to listen on
  int port{0};                    ///< 0: any free one
  int ports_tried{1};             ///< from `port` on
  int threads{8};                 ///< of connections that are open at a time
  std::filesystem::path files{};  ///< folder that is served; empty: none
  std::string headers{};          ///< sent with every file
  /// Before any file is served. @returns 0: goes on, else the status that was sent
  int (*on_request)(mg_connection*){nullptr};
  void* user{nullptr};  ///< mg_request_info::user_data
};

/// A civetweb server that ends at once when it is destroyed. Its threads have the lowest normal priority.
class WebServer {
 public:
  /// @returns the error names address and port, and what to do.
  [[nodiscard]] static tl::expected<std::unique_ptr<WebServer>, std::string> Start(
      const WebServerParams& params);
  /// Closes every connection (their close handlers are called) and ends all threads.
  virtual ~WebServer() = default;
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  [[nodiscard]] virtual mg_context* context() const = 0;
  [[nodiscard]] virtual int port() const = 0;
  /// "127.0.0.1:8470", "[::1]:8470".
  [[nodiscard]] virtual std::string place() const = 0;

 protected:
  WebServer() = default;
};

}  // namespace osteon::console
