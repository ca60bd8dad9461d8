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

/// Port of the first console on a machine; the next ones take the following.
inline constexpr int kDefaultPort = 8470;
inline constexpr int kPortsTried = 20;        ///< number of ports
inline constexpr std::size_t kMaxPages = 16;  ///< number of pages that are served at the same time

/// The answer to an operator's request.
struct RequestAnswer {
  bool done{false};
  std::string reason;  ///< why not
};

/// The source of what pages of one address show: a cell, or a recording.
struct ConsoleStream {
  std::string hello;  ///< a JSON object, the first message to every page: all that does not change in a run
  LiveContext context;
  const LiveFeed& feed;  ///< this and `surface` outlive the server
  const SurfaceStore& surface;
};

/// What a console shows, and the functions by which it acts on the cell.
struct ConsoleParams {
  /// The address to listen on. Any but the loopback's needs a token, which the server makes.
  std::string address{"127.0.0.1"};
  int port{kDefaultPort};      ///< 0: any free one
  bool only_this_port{false};  ///< false: the first free one of kPortsTried ports from `port` on
  std::filesystem::path page;  ///< folder of the built page; absent: a page says that it is not built
  std::string hello;  ///< a JSON object, the first message to every page: all that does not change in a run
  LiveContext context;
  /// Passes an operator's request on, as `osteon pause` and its like do. Called by a page's thread.
  std::function<RequestAnswer(OperatorRequest)> request;
  /// Changes the cell's gains; empty: none can be changed. Called by a page's thread.
  std::function<RequestAnswer(const GainsRequest&)> gains{};
  /// Passes a request on to a procedure's session; empty: there is none. Called by a page's thread.
  std::function<RequestAnswer(const ProcedureRequest&)> procedure{};
  /// Moves a playback; empty: the pages show a running cell. Called by a page's thread.
  std::function<void(const ViewRequest&)> view{};
  /// Called when the page that holds the operator's role is closed, killed or out of reach; not when a page
  /// gives the role back. Empty: nothing is done then. Called by a thread of the server.
  std::function<void()> operator_left{};
  std::vector<std::function<std::string()>> notes{};  ///< PageSources::notes
  /// Shown to pages that ask for /live?stream=2: the other one of two recordings.
  std::optional<ConsoleStream> second{};
};

/// Counts since the server's start.
struct ConsoleCounts {
  std::uint64_t opened{0}, refused{0};  ///< pages that were accepted, and that were refused
  std::uint64_t bad_messages{0};        ///< messages of pages that the server refused
  std::uint64_t slow{0};                ///< pages that were closed because they did not read
};

/// Serves the console's page and its live messages.
///
///     browser ──GET──▶ files of `page`
///     browser ◀─WebSocket /live─▶ a thread for each page: pulls what is new from LiveFeed and SurfaceStore, and sends
///
/// A page that reads slowly gets fewer messages, since its thread asks for new data only after the last
/// message has been sent. A page that reads nothing for some seconds is closed. It is told why when it
/// connects again, because its socket may hold half a message, after which no close frame is understood: each
/// page gets {"type": "key", "key"} at first, connects to /live?was=KEY the next time, and gets
/// {"type": "closed", "code", "reason"}. No page can make the feed, the recorder or the tick wait. All
/// threads run at the lowest normal priority.
class ConsoleServer {
 public:
  /// @param feed, surface  outlive the server
  /// @returns the error names address and port, and what to do.
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
  /// reports. It contains collecting the window, sending, drawing, and the report's way back. Nothing: there
  /// is no report yet.
  [[nodiscard]] virtual std::optional<double> drawn_ms() const = 0;

 protected:
  ConsoleServer() = default;
};

}  // namespace osteon::console
