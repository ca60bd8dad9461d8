#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "base/interrupt.h"
#include "base/run_progress.h"
#include "console/server/console_server.h"
#include "console/server/foxglove_server.h"
#include "console/server/surface_feed.h"
#include "console/stream/live_feed.h"
#include "console/stream/live_status.h"
#include "io/local/local_server.h"
#include "session/foxglove/live_topics.h"
#include "session/gains/gains_panel.h"
#include "session/procedure/session_request.h"
#include "session/run/live_faults.h"
#include "session/run/live_latency.h"
#include "session/setup/cell_setup.h"
#include "simulation/surface/surface_thread.h"

namespace osteon::session {

class ProcedureSession;

/// Address and port of the console or of the server for Foxglove.
struct ConsoleChoice {
  bool on{true};
  std::string address{"127.0.0.1"};  ///< if it is no loopback address, pages need a token
  int port{console::kDefaultPort};
  bool only_this_port{false};  ///< false: if the port is taken, the next free port is used

  /// Parses `--console` and `--foxglove`: "PORT", "ADDRESS:PORT", "off". The error says what was found and
  /// what is accepted.
  [[nodiscard]] static tl::expected<ConsoleChoice, std::string> Parse(const std::string& text);
};

/// The facts about a run that its live views show.
struct LiveRun {
  std::string command;            ///< "demo", "run"
  double seconds{0.0};            ///< requested duration of rendering; 0: until stopped
  std::string recording;          ///< the recording's file
  std::filesystem::path pages{};  ///< folder of the stops' pages; empty: the recording's folder
  std::filesystem::path tune{};   ///< result of `osteon tune`; empty: kTuneFile, if that file is of this cell
};

/// Translates a page's request into a request to a procedure's session. The error says what is accepted.
[[nodiscard]] tl::expected<SessionRequest, std::string> SessionRequestOf(
    const console::ProcedureRequest& request);

/// The views of a running cell, and the ways to make requests to it: the console, the server for Foxglove,
/// the status line on the terminal, and `osteon status`, `pause`, `resume`, `recover`, `stop` through the
/// local socket.
///
///     recorder ──▶ LiveFaults ──▶ LiveLatency ──▶ LiveFeed ◀── status line, local socket
///                                                                   └──▶ OperatorRequests ──▶ the state machine
///
/// A request cannot raise a limit or skip a condition of motion: the state machine decides whether it is
/// allowed.
class LiveViews {
 public:
  /// @param setup  has a packed bone; must outlive this object
  LiveViews(const CellSetup& setup, const LiveRun& run, base::OperatorRequests& requests);
  ~LiveViews();

  /// Passes requests to a procedure's session, and shows the depth of the tool in use. Call it before Open.
  /// @param session  null: there is none
  void SetSession(ProcedureSession* session);

  /// Opens the console, the server for Foxglove, and the local socket. If one of them cannot be opened, the
  /// run continues without it.
  void Open(const ConsoleChoice& choice, const ConsoleChoice& foxglove);
  /// Prints on stderr the console's address, and what could not be opened. Call it once the run begins, so
  /// that a refused run prints only the line with its reason.
  void Announce() const;
  /// Address of the console; empty: it is not served.
  [[nodiscard]] std::string console_url() const { return console_ ? console_->url() : ""; }

  /// The sink that gets all records.
  [[nodiscard]] io::RecordSink* sink() { return &faults_; }
  /// The thread that updates the carved surface for console and Foxglove; null if neither is served. The
  /// simulation's thread passes the swept paths to it.
  [[nodiscard]] surface::SurfaceThread* surface_thread() { return surface_thread_.get(); }
  /// The gains that pages may change.
  [[nodiscard]] GainsPanel* gains_panel() { return &gains_; }
  [[nodiscard]] console::LiveStatus Status() const;
  /// The status as a line of text for stderr; empty before the first message of the arm.
  [[nodiscard]] std::string Line() const;
  /// Answers a request by a line of JSON: {"done", "reason", …}. Any text gets an answer, also one that is no
  /// request.
  [[nodiscard]] std::string Answer(const std::string& request);

 private:
  void OpenConsole(const ConsoleChoice& choice);
  void OpenFoxglove(const ConsoleChoice& choice);
  [[nodiscard]] bool IsWatched() const;  // whether a page or a viewer is connected
  // Passes a request on if the cell's state allows it; the answer says why it is refused.
  [[nodiscard]] console::RequestAnswer Ask(console::OperatorRequest request);
  // Called when the operator's page has gone. Pauses the cell if its configuration says so
  // (pause_when_operator_leaves).
  void OnOperatorLeft();
  [[nodiscard]] console::RequestAnswer AskSession(const console::ProcedureRequest& request);

  const CellSetup& setup_;
  LiveRun run_;
  base::OperatorRequests& requests_;
  ProcedureSession* session_{nullptr};
  GainsPanel gains_;
  std::string cell_;
  std::string scene_;
  std::vector<std::string> not_opened_;  // for each server that could not be opened: why
  console::LiveContext context_;
  console::LiveFeed feed_;
  LiveLatency latency_;
  LiveFaults faults_;
  console::SurfaceStore surface_;
  console::SurfaceFeed surface_feed_{surface_};
  std::unique_ptr<surface::SurfaceThread> surface_thread_;  // outlives the servers, whose threads use it
  // Pointers to the surface's thread and to the servers below, for other threads; null until the objects
  // exist.
  std::atomic<const surface::SurfaceThread*> followed_{nullptr};
  std::atomic<const console::ConsoleServer*> pages_{nullptr};
  std::atomic<const console::FoxgloveServer*> viewers_{nullptr};
  // Declared last and so destroyed first: their threads use the members above. The socket's answers name the
  // console, so it comes after the console.
  std::unique_ptr<console::ConsoleServer> console_;
  std::unique_ptr<LiveTopics> topics_;
  std::unique_ptr<console::FoxgloveServer> foxglove_;
  std::unique_ptr<io::LocalServer> server_;
};

}  // namespace osteon::session
