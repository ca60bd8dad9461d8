#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "console/server/client_message.h"
#include "console/server/surface_store.h"
#include "console/stream/live_feed.h"
#include "console/stream/live_status.h"

namespace osteon::console {

/// Port of the first console on a machine. Further consoles use the next free ports.
inline constexpr int kDefaultPort = 8470;
inline constexpr int kPortsTried = 20;        ///< number of ports that are tried, from the first on
inline constexpr std::size_t kMaxPages = 16;  ///< number of pages that are served at the same time

/// The answer to an operator's request.
struct RequestAnswer {
  bool done{false};
  std::string reason;  ///< reason if the request was not carried out
};

/// The source of the data that pages show: a cell, or a recording.
struct ConsoleStream {
  std::string hello;  ///< a JSON object, the first message to every page: all that does not change in a run
  LiveContext context;
  const LiveFeed& feed;  ///< this and `surface` outlive the server
  const SurfaceStore& surface;
};

/// The contents that a console shows, and the functions by which it acts on the cell.
struct ConsoleParams {
  /// The address to listen on. For any address but the loopback's, a page needs a token, which the server
  /// makes.
  std::string address{"127.0.0.1"};
  int port{kDefaultPort};      ///< 0: any free one
  bool only_this_port{false};  ///< false: the first free one of kPortsTried ports from `port` on
  /// folder of the built page; if it does not exist, a page that says so is served
  std::filesystem::path page;
  std::string hello;  ///< a JSON object, the first message to every page: all that does not change in a run
  LiveContext context;
  /// Passes an operator's request on to the cell, as `osteon pause`, `resume`, `stop` and `recover` do.
  /// Called by a page's thread.
  std::function<RequestAnswer(OperatorRequest)> request;
  /// Changes the cell's gains; empty: the gains cannot be changed. Called by a page's thread.
  std::function<RequestAnswer(const GainsRequest&)> gains{};
  /// Passes a request on to a procedure's session; empty: there is no session. Called by a page's thread.
  std::function<RequestAnswer(const ProcedureRequest&)> procedure{};
  /// Controls a playback; empty: the pages show a running cell. Called by a page's thread.
  std::function<void(const ViewRequest&)> view{};
  /// Called when the page with the operator's role is closed, is killed or loses its connection, but not when
  /// it gives the role back. May be empty. Called by a thread of the server.
  std::function<void()> operator_left{};
  std::vector<std::function<std::string()>> notes{};  ///< PageSources::notes
  /// The second of two recordings, for pages that open /live?stream=2.
  std::optional<ConsoleStream> second{};
};

/// Counts since the server's start.
struct ConsoleCounts {
  /// number of pages that were accepted, and of pages that were refused
  std::uint64_t opened{0}, refused{0};
  std::uint64_t bad_messages{0};  ///< messages of pages that the server refused
  std::uint64_t slow{0};          ///< pages that were closed because they did not read
};

/// Serves the console's page and its live messages.
///
///     browser ──GET──▶ files of `page`
///     browser ◀─WebSocket /live─▶ a thread for each page: pulls what is new from LiveFeed and SurfaceStore, and sends
///
/// A page that reads slowly gets fewer messages, since its thread asks for new data only after the last
/// message has been sent. No page can make the feed, the recorder or the tick wait.
///
/// A page that reads nothing for some seconds is closed. Its socket may then hold half a message, so that it
/// would not understand a close frame. It gets the reason when it connects again: at first each page receives
/// {"type": "key", "key"}; the next time it connects to /live?was=KEY, and the server sends {"type":
/// "closed", "code", "reason"}.
/// All threads run at the lowest normal priority.
class ConsoleServer {
 public:
  /// @param feed, surface  outlive the server
  /// @returns the running server, or an error that names address and port, and what to do
  [[nodiscard]] static tl::expected<std::unique_ptr<ConsoleServer>, std::string> Start(
      const ConsoleParams& params, const LiveFeed& feed, const SurfaceStore& surface);
  /// Closes every page and ends all threads.
  virtual ~ConsoleServer() = default;
  ConsoleServer(const ConsoleServer&) = delete;
  ConsoleServer& operator=(const ConsoleServer&) = delete;

  /// The address for a person's browser: "http://127.0.0.1:8470/", with the token if one is needed.
  [[nodiscard]] virtual std::string url() const = 0;
  [[nodiscard]] virtual int port() const = 0;
  [[nodiscard]] virtual ConsoleCounts counts() const = 0;
  [[nodiscard]] virtual std::size_t pages() const = 0;  ///< number of pages that are open
  /// Median time from a tick until a page has reported that the tick's figures are drawn [ms], of the newest
  /// reports. It includes collecting the window, sending and drawing it, and sending the report back. Empty:
  /// there is no report yet.
  [[nodiscard]] virtual std::optional<double> drawn_ms() const = 0;

 protected:
  ConsoleServer() = default;
};

}  // namespace osteon::console
