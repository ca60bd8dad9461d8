#include "console/server/console_server.h"

#include <civetweb.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/clock.h"
#include "base/percentile.h"
#include "console/server/access.h"
#include "console/server/operator_role.h"
#include "console/server/page_sender.h"
#include "console/server/web_server.h"

namespace osteon::console {
namespace {

// Answer to a request of a page without the operator's role.
constexpr const char* kWatches = "this page watches: take the operator's role first";

// The server closes a page that does not read. It cannot send the reason then, because the page may have
// received only half of the last message. It sends the reason when the page opens again with its old key.
// a failed write that took longer failed because the page did not read
constexpr std::chrono::milliseconds kSlow{2000};
constexpr std::size_t kRememberedPages = 64;  // number of keys of pages that were closed as slow
constexpr std::size_t kDrawnReports = 512;    // number of newest reports whose median drawn_ms() returns
constexpr int kClosedSlow = 1008;             // close code of RFC 6455: policy violation
constexpr const char* kSlowReason =
    "the page took nothing for three seconds and was closed; it is connected again";

// Each open page occupies one of the server's threads. The other threads serve files.
constexpr int kThreads = static_cast<int>(kMaxPages) + 8;

// Headers of every file. They forbid the page to load from, or send to, another machine, and forbid pages of
// another origin to embed this page.
constexpr const char* kHeaders =
    "Content-Security-Policy: default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: "
    "blob:; connect-src 'self'; frame-ancestors 'self'\r\n"
    "X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\nCache-Control: no-cache";

constexpr const char* kNoPage =
    "<!doctype html><meta charset=utf-8><title>Osteon</title><p>The console's page is not built on this "
    "machine. <code>./osteon demo</code> says why. The cell runs all the same: <code>osteon status</code>, "
    "<code>pause</code>, <code>resume</code>, <code>stop</code>.";

// One connected page.
class Page final : public PageWriter {
 public:
  Page(std::uint64_t number, mg_connection* connection, const PageSources& sources)
      : number_(number), connection_(connection), sender_(number, sources, *this) {}

  bool WriteText(const std::string& text) override { return Write(MG_WEBSOCKET_OPCODE_TEXT, text); }
  bool WriteBinary(const std::string& bytes) override { return Write(MG_WEBSOCKET_OPCODE_BINARY, bytes); }
  // Only marks the page as closed, because a page that does not read would not receive a close frame. The
  // server's thread ends the connection once the page answers no pings or has disconnected.
  void Close() override { closed_.store(true); }

  /// The key by which the page is recognised when it opens again.
  [[nodiscard]] const std::string& key() const { return key_; }
  /// Whether the last write timed out because the page did not read.
  [[nodiscard]] bool slow() const { return slow_.load(); }
  [[nodiscard]] std::uint64_t number() const { return number_; }
  [[nodiscard]] bool closed() const { return closed_.load(); }
  [[nodiscard]] PageSender& sender() { return sender_; }

 private:
  // Waits at most the server's request_timeout_ms for a page that does not read.
  bool Write(int opcode, const std::string& bytes) {
    if (closed_.load()) return false;
    const auto began = std::chrono::steady_clock::now();
    if (mg_websocket_write(connection_, opcode, bytes.data(), bytes.size()) == static_cast<int>(bytes.size()))
      return true;
    slow_.store(std::chrono::steady_clock::now() - began > kSlow);
    return false;
  }

  const std::uint64_t number_;
  mg_connection* const connection_;
  const std::string key_{NewToken()};
  std::atomic<bool> closed_{false}, slow_{false};
  PageSender sender_;  // last member, because its thread uses the other members
};

// The server with its pages. Threads of civetweb call the static handlers.
class Server final : public ConsoleServer {
 public:
  Server(ConsoleParams params, const LiveFeed& feed, const SurfaceStore& surface)
      : params_(std::move(params)),
        token_(IsLoopback(params_.address) ? "" : NewToken()),
        sources_{feed, surface, role_, params_.hello, params_.context, pages_open_, params_.notes, live_} {
    if (params_.second)
      second_.emplace(PageSources{params_.second->feed, params_.second->surface, role_, params_.second->hello,
                                  params_.second->context, pages_open_, params_.notes, second_live_});
  }

  ~Server() override {
    ending_.store(true);
    web_.reset();  // calls OnClosed for every page
  }

  // @returns an error; empty: it listens
  std::string Listen() {
    WebServerParams web{.name = "console",
                        .option = "--console",
                        .address = params_.address,
                        .port = params_.port,
                        .ports_tried = params_.only_this_port ? 1 : kPortsTried,
                        .threads = kThreads,
                        .headers = kHeaders,
                        .on_request = OnRequest,
                        .user = this};
    std::error_code error;
    if (std::filesystem::exists(params_.page / "index.html", error)) web.files = params_.page;
    auto started = WebServer::Start(web);
    if (!started) return started.error();
    web_ = std::move(*started);
    mg_set_websocket_handler(web_->context(), "/live", OnOpen, OnReady, OnMessage, OnClosed, this);
    return "";
  }

  [[nodiscard]] std::string url() const override {
    return fmt::format("http://{}/{}", web_->place(), token_.empty() ? "" : "?token=" + token_);
  }
  [[nodiscard]] int port() const override { return web_->port(); }
  [[nodiscard]] std::size_t pages() const override { return pages_open_.load(); }
  [[nodiscard]] std::optional<double> drawn_ms() const override {
    const std::lock_guard lock(mutex_);
    if (drawn_ms_.empty()) return std::nullopt;
    std::vector<double> ages(drawn_ms_.begin(), drawn_ms_.end());
    return base::Median(ages);
  }
  [[nodiscard]] ConsoleCounts counts() const override {
    return {.opened = opened_.load(),
            .refused = refused_.load(),
            .bad_messages = bad_messages_.load(),
            .slow = slow_.load()};
  }

 private:
  // civetweb passes the server to the handlers below as `user`.
  static Server& Of(void* user) { return *static_cast<Server*>(user); }

  // Checks each request before a file is served: only GET, and only for a Host that may have access.
  static int OnRequest(mg_connection* connection) {
    const mg_request_info* info = mg_get_request_info(connection);
    Server& server = Of(info->user_data);
    const std::string_view method = OrEmpty(info->request_method), path = OrEmpty(info->local_uri);
    if (method != "GET" && method != "HEAD")
      return Refuse(connection, 405, "found another method, accepted GET");
    if (path == "/live") return 0;  // OnOpen checks
    // The files are not secret, but a request with a foreign name in Host is refused nevertheless.
    const std::string_view host = OrEmpty(mg_get_header(connection, "Host"));
    if (const std::string wrong =
            CheckAccess({.host = host, .origin = {}, .token = {}}, server.params_.address, "");
        !wrong.empty())
      return Refuse(connection, 403, wrong);
    std::error_code error;
    if (std::filesystem::exists(server.params_.page / "index.html", error)) return 0;
    mg_printf(connection,
              "HTTP/1.1 200 OK\r\nContent-Type: text/html\r\n%s\r\nContent-Length: %zu\r\nConnection: "
              "close\r\n\r\n%s",
              kHeaders, std::string_view(kNoPage).size(), kNoPage);
    return 200;
  }

  // Sends an HTTP error. @returns its code, as OnRequest must
  static int Refuse(mg_connection* connection, int code, const std::string& why) {
    mg_send_http_error(connection, code, "%s", why.c_str());
    return code;
  }

  // Decides whether a page's WebSocket may open. @returns 0 if so
  static int OnOpen(const mg_connection* connection, void* user) {
    Server& server = Of(user);
    const mg_request_info* info = mg_get_request_info(connection);
    const std::string wrong = CheckAccess({.host = OrEmpty(mg_get_header(connection, "Host")),
                                           .origin = OrEmpty(mg_get_header(connection, "Origin")),
                                           .token = QueryValue(OrEmpty(info->query_string), "token=")},
                                          server.params_.address, server.token_);
    if (wrong.empty() && !server.ending_.load() && server.Reserve()) return 0;
    ++server.refused_;
    return 1;
  }

  // Counts one more page as open, until it is closed. @returns false if kMaxPages are open
  bool Reserve() {
    std::size_t open = pages_open_.load();
    while (open < kMaxPages)
      if (pages_open_.compare_exchange_weak(open, open + 1)) return true;
    return false;
  }

  // Adds a page that has opened, and sends it its key. If the page was closed as slow before, also sends it
  // the reason.
  static void OnReady(mg_connection* connection, void* user) {
    Server& server = Of(user);
    const std::uint64_t number = ++server.opened_;
    const std::string_view query = OrEmpty(mg_get_request_info(connection)->query_string);
    const bool second = server.second_ && QueryValue(query, "stream=") == "2";
    auto page = std::make_shared<Page>(number, connection, second ? *server.second_ : server.sources_);
    page->sender().Answer(nlohmann::json{{"type", "key"}, {"key", page->key()}}.dump());
    const std::lock_guard lock(server.mutex_);
    if (std::erase(server.slow_keys_, QueryValue(query, "was=")) > 0)
      page->sender().Answer(
          nlohmann::json{{"type", "closed"}, {"code", kClosedSlow}, {"reason", kSlowReason}}.dump());
    server.pages_.emplace(connection, std::move(page));
  }

  // @returns 0 to close the connection
  static int OnMessage(mg_connection* connection, int bits, char* data, std::size_t size, void* user) {
    Server& server = Of(user);
    const auto page = server.Find(connection);
    if (!page || page->closed()) return 0;
    switch (bits & 0x0F) {
      case MG_WEBSOCKET_OPCODE_CONNECTION_CLOSE:
        return 0;
      case MG_WEBSOCKET_OPCODE_PING:
      case MG_WEBSOCKET_OPCODE_PONG:
        return 1;
      case MG_WEBSOCKET_OPCODE_TEXT:
        server.HandleMessage(*page, std::string_view(data, size));
        return 1;
      default:  // a page may send only text, each message in one frame
        ++server.bad_messages_;
        return 0;
    }
  }

  // Stores the time from a tick until a page has drawn its figures. Ignores a stamp outside the last minute:
  // it is from another clock, or forged.
  void AddDrawnReport(const DrawnReport& report) {
    constexpr double kMaxAge_ms = 60e3;
    const double age_ms = 1e3 * (rt::ToSeconds(rt::MonotonicNow()) - report.stamp_s);
    if (!(age_ms >= 0.0 && age_ms <= kMaxAge_ms)) return;
    const std::lock_guard lock(mutex_);
    if (drawn_ms_.size() == kDrawnReports) drawn_ms_.pop_front();
    drawn_ms_.push_back(age_ms);
  }

  // Acts on a page's message, and answers it.
  void HandleMessage(Page& page, std::string_view bytes) {
    const auto message = ParseClientMessage(bytes);
    if (!message) {
      ++bad_messages_;
      page.sender().Answer(AnswerJson("", {.done = false, .reason = message.error()}));
      return;
    }
    if (std::holds_alternative<ResendRequest>(*message)) return page.sender().Resend();
    if (const auto* drawn = std::get_if<DrawnReport>(&*message)) return AddDrawnReport(*drawn);
    if (const auto* role = std::get_if<RoleRequest>(&*message)) {
      if (*role == RoleRequest::kGiveBack) {
        role_.GiveBack(page.number());
        return;
      }
      const bool mine = role_.Take(page.number());
      return page.sender().Answer(
          AnswerJson("role", {.done = mine, .reason = mine ? "" : "another page has the role"}));
    }
    if (const auto* view = std::get_if<ViewRequest>(&*message)) {
      if (params_.view) return params_.view(*view);
      return page.sender().Answer(
          AnswerJson("view", {.done = false, .reason = "a running cell has no time line"}));
    }
    if (const auto* gains = std::get_if<GainsRequest>(&*message)) {
      RequestAnswer answer{.done = false, .reason = kWatches};
      if (!params_.gains)
        answer.reason = "gains: nothing runs whose gains could be changed";
      else if (role_.holder() == page.number())
        answer = params_.gains(*gains);
      return page.sender().Answer(AnswerJson("gains", answer));
    }
    if (const auto* procedure = std::get_if<ProcedureRequest>(&*message)) {
      RequestAnswer answer{.done = false, .reason = kWatches};
      if (!params_.procedure)
        answer.reason = "procedure: this run has no plan";
      else if (role_.holder() == page.number())
        answer = params_.procedure(*procedure);
      return page.sender().Answer(AnswerJson("procedure", answer));
    }
    const auto request = std::get<OperatorRequest>(*message);
    constexpr std::array<const char*, 4> kNames{"pause", "resume", "stop", "recover"};
    RequestAnswer answer{.done = false, .reason = kWatches};
    if (!params_.request)
      answer.reason = "a recording takes no requests";
    else if (role_.holder() == page.number())
      answer = params_.request(request);
    page.sender().Answer(AnswerJson(kNames[static_cast<std::size_t>(request)], answer));
  }

  // The answer to a page's request, as a message. @param ask  the kind of request
  static std::string AnswerJson(const char* ask, const RequestAnswer& answer) {
    const nlohmann::json json{
        {"type", "answer"}, {"ask", ask}, {"done", answer.done}, {"reason", answer.reason}};
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }

  // Removes a page that has disconnected. If it had the operator's role, the role becomes free.
  static void OnClosed(const mg_connection* connection, void* user) {
    Server& server = Of(user);
    std::shared_ptr<Page> page;
    {
      const std::lock_guard lock(server.mutex_);
      const auto found = server.pages_.find(connection);
      if (found == server.pages_.end()) return;
      page = std::move(found->second);
      server.pages_.erase(found);
      if (page->slow()) server.slow_keys_.push_back(page->key());
      if (server.slow_keys_.size() > kRememberedPages) server.slow_keys_.pop_front();
    }
    if (page->closed()) ++server.slow_;
    const bool operated = server.role_.GiveBack(page->number());
    if (operated && !server.ending_.load() && server.params_.operator_left) server.params_.operator_left();
    page.reset();  // ends the page's thread while the connection still exists
    --server.pages_open_;
  }

  // The page of a connection; null if the page has disconnected.
  std::shared_ptr<Page> Find(const mg_connection* connection) {
    const std::lock_guard lock(mutex_);
    const auto found = pages_.find(connection);
    return found == pages_.end() ? nullptr : found->second;
  }

  ConsoleParams params_;
  std::string token_;
  OperatorRole role_;
  std::atomic<std::size_t> pages_open_{0};
  SharedLive live_, second_live_;
  PageSources sources_;
  std::optional<PageSources> second_;  // data for pages that request stream=2; empty: there is one stream
  std::atomic<bool> ending_{false};
  std::atomic<std::uint64_t> opened_{0}, refused_{0}, bad_messages_{0}, slow_{0};

  mutable std::mutex mutex_;
  std::map<const mg_connection*, std::shared_ptr<Page>> pages_;  // guarded by mutex_
  std::deque<std::string> slow_keys_;  // keys of pages that were closed as slow; guarded by mutex_
  std::deque<double> drawn_ms_;        // guarded by mutex_; newest last

  std::unique_ptr<WebServer> web_;
};

}  // namespace

tl::expected<std::unique_ptr<ConsoleServer>, std::string> ConsoleServer::Start(const ConsoleParams& params,
                                                                               const LiveFeed& feed,
                                                                               const SurfaceStore& surface) {
  auto server = std::make_unique<Server>(params, feed, surface);
  if (const std::string wrong = server->Listen(); !wrong.empty()) return tl::unexpected(wrong);
  return server;
}

}  // namespace osteon::console
