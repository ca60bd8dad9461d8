#include "console/server/foxglove_server.h"

#include <civetweb.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <string_view>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "base/realtime_thread.h"
#include "console/server/access.h"
#include "console/server/web_server.h"

namespace osteon::console {
namespace {

constexpr std::chrono::milliseconds kTopicPeriod{33};  // time between messages of a topic
constexpr std::size_t kMaxWarnings = 16;               // number of warnings that wait for a viewer

// One connected viewer: a thread of its own sends the new messages of its subscriptions.
class Viewer {
 public:
  Viewer(mg_connection* connection, const FoxgloveSource& source, std::string greeting)
      : connection_(connection),
        source_(source),
        greeting_(std::move(greeting)),
        thread_([this] { Run(); }) {}

  ~Viewer() {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  // Acts on a viewer's text message: a subscription, or the end of one.
  void HandleMessage(std::string_view bytes) {
    const auto request = ParseFoxgloveRequest(bytes, source_.channels().size());
    const std::lock_guard lock(mutex_);
    if (!request) {
      Warn(request.error());
    } else if (const auto* unsubscribe = std::get_if<FoxgloveUnsubscribe>(&*request)) {
      for (const std::uint32_t id : unsubscribe->ids) subscriptions_.erase(id);
    } else {
      for (const auto& [id, channel] : std::get<FoxgloveSubscribe>(*request).subscriptions)
        if (subscriptions_.size() >= kMaxSubscriptions)
          Warn(fmt::format("found a subscription more than the {} that are accepted", kMaxSubscriptions));
        else if (!subscriptions_
                      .try_emplace(id, Subscription{.channel = channel, .number = ++made_, .cursor = {}})
                      .second)
          Warn(fmt::format("found the subscription {} a second time", id));
    }
    changed_.notify_all();
  }

  // Sends the viewer a warning about its message.
  void Warned(const std::string& text) {
    const std::lock_guard lock(mutex_);
    Warn(text);
  }

  [[nodiscard]] bool closed() const { return closed_.load(); }

 private:
  struct Subscription {
    std::size_t channel{0};
    std::uint64_t number{0};  // differs for each subscription, also if an id is used again
    FoxgloveCursor cursor;
  };

  // Adds a warning to those that wait for the viewer; drops it if kMaxWarnings wait. @pre mutex_ is held
  void Warn(const std::string& text) {
    if (warnings_.size() < kMaxWarnings) warnings_.push_back(FoxgloveWarning(text));
  }

  // The thread: greets the viewer, then sends warnings and new messages until the viewer does not read.
  void Run() {
    rt::NameThread("foxglove");
    rt::LowerPriority();
    bool open = Write(MG_WEBSOCKET_OPCODE_TEXT, FoxgloveServerInfo(greeting_, NewToken())) &&
                Write(MG_WEBSOCKET_OPCODE_TEXT, FoxgloveAdvertise(source_.channels()));
    while (open) {
      std::deque<std::string> warnings;
      std::map<std::uint32_t, Subscription> subscriptions;
      {
        std::unique_lock lock(mutex_);
        changed_.wait_for(lock, kTopicPeriod, [this] { return stop_; });
        if (stop_) return;
        warnings.swap(warnings_);
        subscriptions = subscriptions_;
      }
      for (const std::string& warning : warnings) open = open && Write(MG_WEBSOCKET_OPCODE_TEXT, warning);
      for (auto& [id, subscription] : subscriptions) open = open && SendNew(id, subscription);
      KeepCursors(subscriptions);
    }
    closed_.store(true);
  }

  // Sends the messages since the subscription's cursor. @returns false if the viewer does not read
  bool SendNew(std::uint32_t id, Subscription& subscription) {
    std::vector<FoxgloveMessage> messages;
    source_.New(subscription.channel, subscription.cursor, messages);
    for (const FoxgloveMessage& message : messages) {
      FoxgloveMessageData(id, message.stamp, message.bytes, bytes_);
      if (!Write(MG_WEBSOCKET_OPCODE_BINARY, bytes_)) return false;
    }
    return true;
  }

  // Stores the cursors that SendNew has moved. Skips a subscription that has ended, or was replaced by a new
  // one with the same id, while its messages were sent.
  void KeepCursors(const std::map<std::uint32_t, Subscription>& moved) {
    const std::lock_guard lock(mutex_);
    for (const auto& [id, subscription] : moved)
      if (const auto found = subscriptions_.find(id);
          found != subscriptions_.end() && found->second.number == subscription.number)
        found->second.cursor = subscription.cursor;
  }

  // Waits at most the server's request_timeout_ms for a viewer that does not read.
  bool Write(int opcode, const std::string& bytes) {
    return mg_websocket_write(connection_, opcode, bytes.data(), bytes.size()) ==
           static_cast<int>(bytes.size());
  }

  mg_connection* const connection_;
  const FoxgloveSource& source_;
  const std::string greeting_;  // the cell's name
  std::string bytes_;           // buffer for one message; used by the thread only
  std::atomic<bool> closed_{false};

  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::uint32_t, Subscription> subscriptions_;  // guarded by mutex_, as are the members below
  std::uint64_t made_{0};                                // number of subscriptions made so far
  std::deque<std::string> warnings_;
  bool stop_{false};
  std::thread thread_;  // last member, because it uses the other members
};

// The server with its viewers. Threads of civetweb call the static handlers.
class ViewersServer final : public FoxgloveServer {
 public:
  ViewersServer(FoxgloveParams params, const FoxgloveSource& source)
      : params_(std::move(params)), token_(IsLoopback(params_.address) ? "" : NewToken()), source_(source) {}

  ~ViewersServer() override {
    ending_.store(true);
    web_.reset();  // calls OnClosed for every viewer
  }

  // @returns an error; empty: it listens
  std::string Listen() {
    auto started = WebServer::Start({.name = "foxglove",
                                     .option = "--foxglove",
                                     .address = params_.address,
                                     .port = params_.port,
                                     .threads = static_cast<int>(kMaxFoxgloveViewers) + 4,
                                     .on_request = OnRequest,
                                     .user = this});
    if (!started) return started.error();
    web_ = std::move(*started);
    // static, because civetweb keeps the pointer
    static mg_websocket_subprotocols names{
        .nb_subprotocols = static_cast<int>(std::size(kFoxgloveSubprotocols)),
        .subprotocols = const_cast<const char**>(kFoxgloveSubprotocols)};
    mg_set_websocket_handler_with_subprotocols(web_->context(), "/", &names, OnOpen, OnReady, OnMessage,
                                               OnClosed, this);
    return "";
  }

  [[nodiscard]] std::string url() const override {
    return fmt::format("ws://{}/{}", web_->place(), token_.empty() ? "" : "?token=" + token_);
  }
  [[nodiscard]] int port() const override { return web_->port(); }
  [[nodiscard]] std::size_t viewers() const override { return open_.load(); }

 private:
  // civetweb passes the server to the handlers below as `user`.
  static ViewersServer& Of(void* user) { return *static_cast<ViewersServer*>(user); }

  // Answers every request that is not a viewer's WebSocket with an error.
  static int OnRequest(mg_connection* connection) {
    if (mg_get_header(connection, "Upgrade") != nullptr) return 0;  // OnOpen checks
    mg_send_http_error(connection, 404, "%s",
                       "this address is for Foxglove or Lichtblick: Open connection, Foxglove WebSocket");
    return 404;
  }

  // Decides whether a viewer's WebSocket may open. @returns 0 if so
  static int OnOpen(const mg_connection* connection, void* user) {
    ViewersServer& server = Of(user);
    const mg_request_info* info = mg_get_request_info(connection);
    if (OrEmpty(info->acceptedWebSocketSubprotocol).empty()) return 1;
    const std::string wrong = CheckViewerAccess({.host = OrEmpty(mg_get_header(connection, "Host")),
                                                 .origin = OrEmpty(mg_get_header(connection, "Origin")),
                                                 .token = QueryValue(OrEmpty(info->query_string), "token=")},
                                                server.params_.address, server.token_);
    return wrong.empty() && !server.ending_.load() && server.Reserve() ? 0 : 1;
  }

  // Counts one more viewer as open. @returns false if kMaxFoxgloveViewers are open
  bool Reserve() {
    std::size_t open = open_.load();
    while (open < kMaxFoxgloveViewers)
      if (open_.compare_exchange_weak(open, open + 1)) return true;
    return false;
  }

  // Begins to send to a viewer that has opened.
  static void OnReady(mg_connection* connection, void* user) {
    ViewersServer& server = Of(user);
    auto viewer = std::make_shared<Viewer>(connection, server.source_, server.params_.name);
    const std::lock_guard lock(server.mutex_);
    server.viewers_.emplace(connection, std::move(viewer));
  }

  // @returns 0 to close the connection
  static int OnMessage(mg_connection* connection, int bits, char* data, std::size_t size, void* user) {
    ViewersServer& server = Of(user);
    std::shared_ptr<Viewer> viewer;
    {
      const std::lock_guard lock(server.mutex_);
      const auto found = server.viewers_.find(connection);
      if (found != server.viewers_.end()) viewer = found->second;
    }
    if (!viewer || viewer->closed()) return 0;
    switch (bits & 0x0F) {
      case MG_WEBSOCKET_OPCODE_CONNECTION_CLOSE:
        return 0;
      case MG_WEBSOCKET_OPCODE_PING:
      case MG_WEBSOCKET_OPCODE_PONG:
        return 1;
      case MG_WEBSOCKET_OPCODE_TEXT:
        viewer->HandleMessage(std::string_view(data, size));
        return 1;
      case MG_WEBSOCKET_OPCODE_BINARY:
        viewer->Warned("found a binary message, which this server has no use for");
        return 1;
      default:
        return 0;
    }
  }

  // Removes a viewer that has disconnected.
  static void OnClosed(const mg_connection* connection, void* user) {
    ViewersServer& server = Of(user);
    std::shared_ptr<Viewer> viewer;
    {
      const std::lock_guard lock(server.mutex_);
      const auto found = server.viewers_.find(connection);
      if (found == server.viewers_.end()) return;
      viewer = std::move(found->second);
      server.viewers_.erase(found);
    }
    viewer.reset();  // ends the viewer's thread while the connection still exists
    --server.open_;
  }

  const FoxgloveParams params_;
  const std::string token_;
  const FoxgloveSource& source_;
  std::atomic<bool> ending_{false};
  std::atomic<std::size_t> open_{0};

  std::mutex mutex_;
  std::map<const mg_connection*, std::shared_ptr<Viewer>> viewers_;  // guarded by mutex_

  std::unique_ptr<WebServer> web_;
};

}  // namespace

tl::expected<std::unique_ptr<FoxgloveServer>, std::string> FoxgloveServer::Start(
    const FoxgloveParams& params, const FoxgloveSource& source) {
  auto server = std::make_unique<ViewersServer>(params, source);
  if (const std::string wrong = server->Listen(); !wrong.empty()) return tl::unexpected(wrong);
  return server;
}

}  // namespace osteon::console
