#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

struct mg_connection;
struct mg_context;

namespace osteon::console {

/// The text, or an empty text for the null pointer that civetweb returns for an absent text.
[[nodiscard]] inline std::string_view OrEmpty(const char* text) { return text == nullptr ? "" : text; }

/// The files and handlers that a web server serves, and its address.
struct WebServerParams {
  std::string name;               ///< in errors: "console"
  std::string option;             ///< in errors, the option that sets another address: "--console"
  std::string address;            ///< address to listen on
  int port{0};                    ///< 0: any free one
  int ports_tried{1};             ///< number of ports that are tried, from `port` on
  int threads{8};                 ///< number of threads, each for one open connection
  std::filesystem::path files{};  ///< folder that is served; empty: none
  std::string headers{};          ///< sent with every file
  /// Called before a file is served; null: not called. @returns 0 to serve the file, else the HTTP status
  /// that the function has sent
  int (*on_request)(mg_connection*){nullptr};
  void* user{nullptr};  ///< becomes mg_request_info::user_data
};

/// A civetweb server whose destructor ends it without delay. Its threads have the lowest normal priority.
class WebServer {
 public:
  /// @returns the running server, or an error that names address and port, and what to do
  [[nodiscard]] static tl::expected<std::unique_ptr<WebServer>, std::string> Start(
      const WebServerParams& params);
  /// Closes every connection (their close handlers are called) and ends all threads.
  virtual ~WebServer() = default;
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  [[nodiscard]] virtual mg_context* context() const = 0;
  [[nodiscard]] virtual int port() const = 0;
  /// Address and port: "127.0.0.1:8470", "[::1]:8470".
  [[nodiscard]] virtual std::string place() const = 0;

 protected:
  WebServer() = default;
};

}  // namespace osteon::console
