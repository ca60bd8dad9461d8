#include "session/run/live_views.h"

#include <unistd.h>

#include <charconv>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/clock.h"
#include "base/text.h"
#include "session/procedure/procedure_session.h"
#include "session/procedure/tool_depths.h"
#include "session/run/console_scene.h"
#include "session/run/live_surface.h"

namespace osteon::session {
namespace {

constexpr int kMaxPort = 65535;
constexpr std::size_t kShownRequest = 60;  // number of characters of an unknown request in its answer

// Parses a port number, 0 … kMaxPort; none if the text is anything else.
std::optional<int> PortOf(std::string_view text) {
  int port = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole && port >= 0 && port <= kMaxPort ? std::optional(port) : std::nullopt;
}

// Says why a recovery is refused. Names the first fault that can only be cleared by a new run, and what to
// do; without such a fault, names the cell's state.
std::string WhyNoRecovery(const console::LiveStatus& status, const std::string& state) {
  for (const console::FaultStatus& fault : status.faults)
    if (!fault.allows_recovery)
      return fmt::format("found the fault {}, which no recovery clears: {}", fault.name, fault.clearing);
  if (status.faults.empty()) return fmt::format("the cell is {}: there is no fault to recover from", state);
  return fmt::format("the cell is {}: a recovery is accepted at rest, before a stop is asked for", state);
}

// Free bytes on the folder's disk; nothing if the system does not report them.
std::optional<std::uintmax_t> SpaceLeft(const std::filesystem::path& folder) {
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(folder, error);
  return error ? std::nullopt : std::optional(space.available);
}

// Makes the part of an answer about a procedure: the panel's figures, the score, and the tool's number and
// diameter, so that the reader of the answer does not need the plan.
nlohmann::json ProcedureStatus(ProcedureSession& session) {
  const SessionFile file = session.File();
  const int tool = file.segments.empty() ? session.first_tool() : file.segments.back().tool_index;
  nlohmann::json json = nlohmann::json::parse(session.PanelJson());
  json["score"] = nlohmann::json::parse(session.ScoreJson());
  json["score"].erase("type");
  json.erase("type");
  json["tool"] = {{"number", tool + 1},
                  {"of", file.diameters_mm.size()},
                  {"diameter_mm", file.diameters_mm[static_cast<std::size_t>(tool)]}};
  return json;
}

}  // namespace

tl::expected<ConsoleChoice, std::string> ConsoleChoice::Parse(const std::string& text) {
  ConsoleChoice choice{.only_this_port = true};
  if (text == "off") {
    choice.on = false;
    return choice;
  }
  const std::size_t colon = text.rfind(':');
  std::string address = colon == std::string::npos ? choice.address : text.substr(0, colon);
  if (address.starts_with('[') && address.ends_with(']')) address = address.substr(1, address.size() - 2);
  const auto port = PortOf(std::string_view(text).substr(colon == std::string::npos ? 0 : colon + 1));
  if (!port || address.empty())
    return tl::unexpected(fmt::format(
        "found {}, accepted off, PORT or ADDRESS:PORT with a port of 0 (any free one) … {}", text, kMaxPort));
  choice.address = std::move(address);
  choice.port = *port;
  return choice;
}

tl::expected<SessionRequest, std::string> SessionRequestOf(const console::ProcedureRequest& request) {
  using Kind = console::ProcedureRequest::Kind;
  SessionRequest asked{.confirmed = request.confirmed};
  switch (request.kind) {
    case Kind::kNext:
      asked.kind = SessionRequest::Kind::kNext;
      break;
    case Kind::kTool:
      asked.kind = SessionRequest::Kind::kTool;
      asked.diameter_mm = request.value;
      break;
    case Kind::kUndo:
      asked.kind = SessionRequest::Kind::kUndo;
      break;
    case Kind::kSave:
      asked.kind = SessionRequest::Kind::kSave;
      break;
    case Kind::kCup:
      asked.kind = SessionRequest::Kind::kCup;
      break;
    case Kind::kFinish:
      asked.kind = SessionRequest::Kind::kFinish;
      break;
    case Kind::kGuidance:
      if (!(request.value >= 0.0 && request.value <= 1.0))
        return tl::make_unexpected(fmt::format("guidance: found {:g}, accepted 0 … 1", request.value));
      asked.kind = SessionRequest::Kind::kGuidance;
      asked.gain = request.value;
      break;
  }
  return asked;
}

LiveViews::LiveViews(const CellSetup& setup, const LiveRun& run, base::OperatorRequests& requests)
    : setup_(setup),
      run_(run),
      requests_(requests),
      gains_(setup.config),
      cell_(setup.cell_name),
      latency_(setup.config, feed_),
      faults_(setup.config,
              run.pages.empty() ? std::filesystem::path(run.recording)
                                : run.pages / std::filesystem::path(run.recording).filename(),
              latency_) {
  scene_ = ConsoleScene(setup, run.command, run.seconds, run.recording);
  gains_.SetTune(ReadTuneAdvice(run.tune.empty() ? std::filesystem::path(kTuneFile) : run.tune, setup.config,
                                setup.cell_name));
  context_ = LiveContextOf(setup);
  context_.latency = [this] { return latency_.Status(); };
  context_.fault = [this](std::uint32_t fault) { return faults_.Of(static_cast<safety::Fault>(fault)); };
  if (!run.recording.empty())
    context_.disk_left_B = [folder = std::filesystem::absolute(run.recording).parent_path()] {
      return SpaceLeft(folder);
    };
  context_.bone_age_s = [this]() -> std::optional<double> {
    const surface::SurfaceThread* followed = followed_.load();
    if (followed == nullptr || !IsWatched()) return std::nullopt;
    return rt::ToSeconds(followed->age().count());
  };
}

// Ends the threads in this order, because the threads of each member use the members that are ended after it.
LiveViews::~LiveViews() {
  if (surface_thread_) surface_thread_->Stop();
  server_.reset();
  console_.reset();
}

bool LiveViews::IsWatched() const {
  const console::ConsoleServer* console = pages_.load();
  const console::FoxgloveServer* foxglove = viewers_.load();
  return (console && console->pages() > 0) || (foxglove && foxglove->viewers() > 0);
}

void LiveViews::SetSession(ProcedureSession* session) {
  session_ = session;
  if (!session) return;
  scene_ = ConsoleScene(setup_, run_.command, run_.seconds, run_.recording, ToolsOf(session->tools()));
  if (setup_.bone.balls.empty()) return;
  context_.depth_m = [session, depths = ToolDepths(setup_.bone, session->tools(), setup_.X_WG)](
                         const Pose& X_WP) { return depths.At(session->tool_in_use(), X_WP); };
}

void LiveViews::Open(const ConsoleChoice& choice, const ConsoleChoice& foxglove) {
  if (choice.on) OpenConsole(choice);
  if (foxglove.on) OpenFoxglove(foxglove);
  pages_.store(console_.get());
  viewers_.store(foxglove_.get());
  if (console_ || foxglove_)
    surface_thread_ = StartSurface(
        setup_, session_, [this] { return IsWatched(); }, surface_feed_);
  followed_.store(surface_thread_.get());
  auto server = io::LocalServer::Start(fmt::format("run-{}", ::getpid()),
                                       [this](const std::string& request) { return Answer(request); });
  if (server)
    server_ = std::move(*server);
  else
    not_opened_.push_back("osteon pause, resume, recover, stop and status do not reach this run: " +
                          server.error());
}

void LiveViews::OpenFoxglove(const ConsoleChoice& choice) {
  topics_ = std::make_unique<LiveTopics>(
      setup_, feed_, surface_, session_ ? std::span(session_->tools()) : std::span<const ProcedureTool>());
  auto server = console::FoxgloveServer::Start(
      {.name = "osteon " + run_.command + ": " + cell_, .address = choice.address, .port = choice.port},
      *topics_);
  if (server)
    foxglove_ = std::move(*server);
  else
    not_opened_.push_back(server.error());
}

void LiveViews::OpenConsole(const ConsoleChoice& choice) {
  console::ConsoleParams params{.address = choice.address,
                                .port = choice.port,
                                .only_this_port = choice.only_this_port,
                                .page = ConsolePageFolder(),
                                .hello = scene_,
                                .context = context_,
                                .request = [this](auto request) { return Ask(request); },
                                .gains = [this](const auto& request) { return gains_.Request(request); },
                                .operator_left = [this] { OnOperatorLeft(); },
                                .notes = {[this] { return gains_.Json(); }}};
  if (session_) {
    params.procedure = [this](const auto& request) { return AskSession(request); };
    params.notes.emplace_back([this] { return session_->PlanJson(); });
    params.notes.emplace_back([this] { return session_->PanelJson(); });
    params.notes.emplace_back([this] { return session_->ScoreJson(); });
  }
  auto console = console::ConsoleServer::Start(params, feed_, surface_);
  if (!console) {
    not_opened_.push_back(console.error());
    return;
  }
  console_ = std::move(*console);
}

void LiveViews::Announce() const {
  for (const std::string& what : not_opened_)
    fmt::print(stderr, "osteon {}: warning: {}\n", run_.command, what);
  if (console_) fmt::print(stderr, "osteon {}: console: {}\n", run_.command, console_->url());
  if (foxglove_) fmt::print(stderr, "osteon {}: foxglove: {}\n", run_.command, foxglove_->url());
}

console::LiveStatus LiveViews::Status() const { return console::StatusOf(feed_.Newest(), context_); }

std::string LiveViews::Line() const {
  const console::LiveStatus status = Status();
  return status.known ? console::StatusLine(status, run_.seconds, base::RunProgress::StatusColumns()) : "";
}

console::RequestAnswer LiveViews::Ask(console::OperatorRequest request) {
  const console::LiveStatus status = Status();
  const std::string state = status.known ? status.state : "not yet seen";
  switch (request) {
    case console::OperatorRequest::kPause:
      if (!status.can_pause)
        return {.done = false,
                .reason = fmt::format("the cell is {}: nothing moves that could be paused", state)};
      requests_.pause.store(true);
      break;
    case console::OperatorRequest::kResume:
      if (!status.can_resume)
        return {.done = false, .reason = fmt::format("the cell is {}, not paused", state)};
      if (session_) {  // the session refuses if a changed tool is not clear of bone
        const SessionAnswer asked = session_->Ask({.kind = SessionRequest::Kind::kResume});
        return {.done = asked.done, .reason = asked.reason};
      }
      requests_.resume.store(true);
      break;
    case console::OperatorRequest::kRecover:
      if (!status.can_recover) return {.done = false, .reason = WhyNoRecovery(status, state)};
      requests_.recover.store(true);
      break;
    case console::OperatorRequest::kStop:
      base::RequestInterrupt(base::kOperatorsStop);
      break;
  }
  return {.done = true, .reason = ""};
}

void LiveViews::OnOperatorLeft() {
  if (!setup_.config.pause_when_operator_leaves) return;
  const console::RequestAnswer answer = Ask(console::OperatorRequest::kPause);
  fmt::print(stderr, "\nosteon {}: the operator's page has gone: {}\n", run_.command,
             answer.done ? "the cell pauses (console: pause_when_operator_leaves)" : answer.reason);
}

console::RequestAnswer LiveViews::AskSession(const console::ProcedureRequest& request) {
  const auto asked = SessionRequestOf(request);
  if (!asked) return {.done = false, .reason = asked.error()};
  const SessionAnswer answer = session_->Ask(*asked);
  return {.done = answer.done, .reason = answer.reason};
}

std::string LiveViews::Answer(const std::string& request) {
  using console::OperatorRequest;
  console::RequestAnswer answer{.done = true, .reason = ""};
  nlohmann::json json;
  if (request == "pause") {
    answer = Ask(OperatorRequest::kPause);
  } else if (request == "resume" && !session_) {
    answer = Ask(OperatorRequest::kResume);
  } else if (request == "recover") {
    answer = Ask(OperatorRequest::kRecover);
  } else if (request == "stop") {
    answer = Ask(OperatorRequest::kStop);
  } else if (request == "status") {
    json["status"] = nlohmann::json::parse(console::StatusJson(Status()));
  } else if (session_) {
    if (const auto asked = ParseSessionRequest(request)) {
      const SessionAnswer done = session_->Ask(*asked);
      answer = {.done = done.done, .reason = done.reason};
    } else {
      answer = {.done = false, .reason = asked.error()};
    }
  } else {
    answer = {.done = false,
              .reason = fmt::format("found {}, accepted pause, resume, recover, stop, status",
                                    base::Printable(request.substr(0, kShownRequest)))};
  }
  json["procedure"] = session_ ? ProcedureStatus(*session_) : nlohmann::json(nullptr);
  json["done"] = answer.done;
  json["reason"] = answer.reason;
  json["run"] = {{"pid", ::getpid()},
                 {"command", run_.command},
                 {"cell", cell_},
                 {"seconds", run_.seconds},
                 {"recording", run_.recording},
                 {"session", session_ ? nlohmann::json(std::filesystem::absolute(session_->folder()).string())
                                      : nlohmann::json(nullptr)},
                 {"console", console_ ? nlohmann::json(console_->url()) : nlohmann::json(nullptr)},
                 {"drawn_ms", nullptr}};
  if (console_)
    if (const auto drawn_ms = console_->drawn_ms()) json["run"]["drawn_ms"] = *drawn_ms;
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace osteon::session
