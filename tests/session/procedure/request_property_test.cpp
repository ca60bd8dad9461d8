// Random sequences of requests to a session, by `osteon tell` or the console's pages, in any state of the
// cell. A paused arm stays where it is, every limit is kept, and no saved state of the bone is lost.

#include "tests/property/property_check.h"

#include <atomic>
#include <cmath>
#include <map>
#include <ostream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "console/server/client_message.h"
#include "io/recording/recording_reader.h"
#include "safety/cell_state.h"
#include "session/procedure/session_request.h"
#include "session/replay/replay.h"
#include "session/run/live_views.h"
#include "session/setup/recorded_config.h"
#include "simulation/engine/tool_change.h"
#include "simulation/files/carved_file.h"
#include "tests/session/procedure/procedure_rig.h"

namespace osteon::session {
namespace {

using safety::CellState;

constexpr double kSeconds = 6.0;  // duration of rendering in each run
constexpr int kMaxTicks = 9000;   // a run that stays paused ends here
constexpr double kForceCeiling_N = 200.0, kRounding = 1.0 + 1e-9;
constexpr int kTicksToRest = 300;            // number of ticks after a fault in which the arm may still brake
constexpr double kMaxRestMotion_rad = 1e-4;  // a joint that moves at most so far stands still

/// How a case begins.
enum class Begins : std::uint8_t {
  kInOrder,
  kAtAFault,  ///< the arm sends nothing as rendering begins; the fault holds the cell until a recovery
};

/// A request, with the number of ticks after the previous one at which it is sent.
struct TimedRequest {
  int after_ticks{0};
  std::string text;
};
void showValue(const TimedRequest& asked, std::ostream& out) {
  out << "+" << asked.after_ticks << " \"" << asked.text << "\"";
}

// Words of `osteon tell`, messages of pages (they begin with a brace), and nonsense.
rc::Gen<std::string> AnyText() {
  return rc::gen::weightedOneOf<std::string>(
      {{6, rc::gen::element<std::string>("pause", "resume")},
       {6, rc::gen::element<std::string>("next", "next confirmed", "tool 48", "tool 50", "tool 50 confirmed",
                                         "undo", "save", "cup", "guidance 0", "guidance 0.5", "guidance 1")},
       {4, rc::gen::element<std::string>(R"({"ask":"pause"})", R"({"ask":"resume"})",
                                         R"({"ask":"next_tool"})", R"({"ask":"next_tool","confirmed":true})",
                                         R"({"ask":"tool","value":48})", R"({"ask":"undo_pass"})",
                                         R"({"ask":"save"})", R"({"ask":"cup"})",
                                         R"({"ask":"guidance","value":0.7})")},
       {2, rc::gen::element<std::string>(
               "tool 47", "tool -1 confirmed", "tool nan", "tool 1e308", "guidance 2", "guidance -0",
               "guidance inf", "undo undo", "NEXT", "", R"({"ask":"guidance","value":1e9})",
               R"({"ask":"tool","value":-1e308})", R"({"ask":"tool"})", R"({"ask":"recover"})", "{", "[]")},
       {1, rc::gen::arbitrary<std::string>()}});
}

rc::Gen<std::vector<TimedRequest>> AnyRequests() {
  return rc::gen::resize(
      30, rc::gen::container<std::vector<TimedRequest>>(rc::gen::build<TimedRequest>(
              rc::gen::set(&TimedRequest::after_ticks, rc::gen::resize(100, rc::gen::inRange(0, 250))),
              rc::gen::set(&TimedRequest::text, AnyText()))));
}

/// A run in which the requests are sent. Each tick is checked, and the first violation is kept.
class AskedRun {
 public:
  explicit AskedRun(std::vector<TimedRequest> asked, Begins begins = Begins::kInOrder)
      : rig_("asked_" + std::to_string(count_++), {.seconds = kSeconds, .guided = true}),
        asked_(std::move(asked)),
        speed_limit_m_per_s_(rig_.setup->config.servo.twist.max_speed_m_per_s) {
    if (begins == Begins::kAtAFault) {
      rig_.setup->config.simulated.fri.request_again_after_loss = true;
      rig_.setup->config.injections.injections = {{.from_s = 0.1, .to_s = 0.16, .faults = {.silence = true}}};
      rig_.params.hold_at_fault = true;
      rig_.may_fault = may_fault_ = true;
      // Recoveries are inserted in the middle, so that some requests reach the cell while the fault holds it,
      // and some afterwards.
      for (const int after_ticks : {400, 400})
        asked_.insert(asked_.begin() + static_cast<std::ptrdiff_t>(asked_.size() / 2),
                      {after_ticks, R"({"ask":"recover"})"});
    }
    // After its random requests, each case sends these.
    for (const auto& [after_ticks, text] :
         {std::pair(150, "pause"), {600, "save"}, {50, "resume"}, {500, "guidance 1"}, {1000, "status"}})
      asked_.push_back({after_ticks, text});
    rig_.params.requests = &buttons_;
    rig_.params.stop = &stop_;
    rig_.params.ticked = [this](const control::TickRecord& tick, const simulation::ContactModel&) {
      Check(tick);
      Ask();
    };
  }
  ~AskedRun() { std::filesystem::remove_all(rig_.folder); }
  AskedRun(const AskedRun&) = delete;
  AskedRun& operator=(const AskedRun&) = delete;

  // Runs the case. @returns the first violation; empty: none
  [[nodiscard]] std::string Run() {
    rig_.Run();
    CheckFolder();
    CheckReplay();
    return wrong_;
  }

  static inline int changes = 0, passes = 0, undone = 0, refused = 0, held = 0;  // sums over all cases

 private:
  void Complain(const std::string& what) {
    if (wrong_.empty()) wrong_ = fmt::format("tick {}: {}", ticks_, what);
  }

  void Check(const control::TickRecord& tick) {
    const bool paused = tick.cell_state == static_cast<std::uint8_t>(CellState::kPaused);
    if (paused && was_paused_ && tick.q_cmd != held_) Complain("the paused arm moved");
    if (ticks_ > 0 && tick.input.tool_index != tool_) {
      ++changes;
      if (!paused || tick.q_cmd != held_) Complain("the arm moved, or was not at rest, as the tool changed");
    }
    CheckHeldFault(tick);
    held_ = tick.q_cmd;
    was_paused_ = paused;
    tool_ = tick.input.tool_index;
    ++ticks_;
    if (!(Vector3(tick.F_coupling_T_W.f).norm() <= kForceCeiling_N * kRounding))
      Complain(fmt::format("{} N were rendered", Vector3(tick.F_coupling_T_W.f).norm()));
    if (!(Vector3(tick.v_WT_cmd_m_per_s).norm() <= speed_limit_m_per_s_ * kRounding))
      Complain(fmt::format("{} m/s were commanded", Vector3(tick.v_WT_cmd_m_per_s).norm()));
    if (tick.faults != 0 && !may_fault_) Complain(fmt::format("faults {:x}", tick.faults));
    if (ticks_ >= kMaxTicks) stop_.store(true);
  }

  // Checks that a cell which a fault holds stands still and keeps its tool, and that no fault follows its
  // recovery.
  void CheckHeldFault(const control::TickRecord& tick) {
    if (!may_fault_) return;
    const bool faulted = tick.cell_state == static_cast<std::uint8_t>(CellState::kFault);
    if (!faulted && fault_ticks_ > 0) may_fault_ = tick.faults != 0;
    fault_ticks_ = faulted ? fault_ticks_ + 1 : may_fault_ ? fault_ticks_ : 0;
    if (faulted && fault_ticks_ == kTicksToRest) {
      ++held;
      rest_ = tick.q_meas;
    }
    if (!faulted || fault_ticks_ <= kTicksToRest) return;
    // Compare measured positions: while the arm takes no commands, the command follows the measured arm.
    for (std::size_t j = 0; j < rest_.size(); ++j)
      if (!(std::abs(tick.q_meas[j] - rest_[j]) <= kMaxRestMotion_rad))
        Complain(fmt::format("the arm that is held at a fault moved by {} rad", tick.q_meas[j] - rest_[j]));
    if (tick.input.tool_index != tool_) Complain("the tool changed at a fault");
  }

  // Sends the next request if it is due. Checks that no saved state was replaced.
  void Ask() {
    if (next_ >= asked_.size() || ++waited_ < asked_[next_].after_ticks) return;
    waited_ = 0;
    Send(asked_[next_++].text);
    const std::vector<SessionPass> all = rig_.session->File().passes;
    for (const SessionPass& pass : all) {
      const auto [known, is_new] = saved_.try_emplace(pass.state, pass.state_hash);
      if (!is_new && known->second != pass.state_hash) Complain(pass.state + " was replaced");
    }
    if (!all.empty() && !std::exchange(undo_is_asked_, true)) AskUndo();
  }

  // Inserts a pause, an undo and a resume before the remaining requests. A pass ends once the tool has been
  // clear of bone, so this undo is accepted; an undo after random requests might be refused.
  void AskUndo() {
    const std::vector<TimedRequest> undo{{0, "pause"}, {400, "undo"}, {50, "resume"}};
    asked_.insert(asked_.begin() + static_cast<std::ptrdiff_t>(next_), undo.begin(), undo.end());
  }

  void Send(const std::string& text) {
    if (text == "pause") return buttons_.pause.store(true);
    if (!text.starts_with('{')) return Post(ParseSessionRequest(text));
    const auto message = console::ParseClientMessage(text);
    if (!message) return;
    if (const auto* own = std::get_if<console::ProcedureRequest>(&*message))
      return Post(SessionRequestOf(*own));
    const auto* cell = std::get_if<console::OperatorRequest>(&*message);
    if (cell && *cell == console::OperatorRequest::kPause) buttons_.pause.store(true);
    if (cell && *cell == console::OperatorRequest::kResume) buttons_.resume.store(true);
    if (cell && *cell == console::OperatorRequest::kRecover) buttons_.recover.store(true);
  }

  void Post(const tl::expected<SessionRequest, std::string>& request) {
    if (!request) return;
    (void)rig_.session->Post(*request, [this](const SessionAnswer& answer) {
      if (answer.done != answer.reason.empty()) Complain("an answer without a reason: " + answer.reason);
      if (!answer.done) ++refused;
    });
  }

  // Checks that the session ended properly, and that every state that it saved still exists.
  void CheckFolder() {
    const auto session = ReadSession(rig_.folder);
    if (!session) return Complain(session.error());
    if (!session->ended) Complain("the session did not end in order");
    for (const SessionPass& pass : session->passes) {
      saved_[pass.state] = pass.state_hash;
      ++passes;
      if (pass.undone) ++undone;
    }
    for (const auto& [name, hash] : saved_) {
      const auto state = simulation::ReadCarvedState(rig_.folder / name, rig_.setup->bone);
      if (!state || HashText(*state) != hash) Complain(name + " is lost");
    }
  }

  void CheckReplay() {
    const auto recording = io::ReadRecording(rig_.params.recording);
    if (!recording) return Complain(recording.error());
    const auto cell = LoadRecordedTools(recording->session.config);
    if (!cell) return Complain(cell.error());
    if (!Replay(*recording, cell->config, cell->tools, cell->list.first).identical)
      Complain("replay differs");
  }

  static inline int count_ = 0;
  Rig rig_;
  std::vector<TimedRequest> asked_;
  double speed_limit_m_per_s_;
  base::OperatorRequests buttons_;
  std::atomic<bool> stop_{false};
  std::string wrong_;
  std::map<std::string, std::string> saved_;  // hash by file
  control::JointArray held_{}, rest_{};
  std::uint8_t tool_{0};
  bool was_paused_{false}, undo_is_asked_{false};
  bool may_fault_{false};
  int ticks_{0}, waited_{0}, fault_ticks_{0};
  std::size_t next_{0};
};

TEST(ProcedureRequests, NoSequenceOfRequestsMovesThePausedArmExceedsALimitOrLosesAState) {
  constexpr long long kCases = 3;
  property::CheckShard(0, 1, kCases, [] {
    const std::vector<TimedRequest> asked = *AnyRequests();
    const std::string wrong = AskedRun(asked).Run();
    if (!wrong.empty()) RC_FAIL(wrong);
  });
  EXPECT_GT(AskedRun::changes, 1) << "the cases must reach what they are about";
  EXPECT_GT(AskedRun::passes, 3);
  EXPECT_GT(AskedRun::undone, 0);
  EXPECT_GT(AskedRun::refused, 5);
}

// A fault holds the cell soon after its start: no request but a recovery moves the arm, and the session goes
// on after the recovery.
TEST(ProcedureRequests, NoSequenceOfRequestsMovesACellThatAFaultHolds) {
  constexpr long long kCases = 2;
  const int held_before = AskedRun::held;
  property::CheckShard(0, 1, kCases, [] {
    const std::vector<TimedRequest> asked = *AnyRequests();
    const std::string wrong = AskedRun(asked, Begins::kAtAFault).Run();
    if (!wrong.empty()) RC_FAIL(wrong);
  });
  EXPECT_GE(AskedRun::held - held_before, 2) << "the cases must reach what they are about";
}

}  // namespace
}  // namespace osteon::session
