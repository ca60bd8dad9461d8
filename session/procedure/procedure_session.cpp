#include "session/procedure/procedure_session.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "session/procedure/bone_history.h"
#include "session/procedure/session_bone.h"
#include "simulation/engine/state_hash.h"
#include "simulation/engine/tool_change.h"

namespace osteon::session {
namespace {

using simulation::CarvedState;
using simulation::ToolCommand;

// Longest wait of Ask: a client of the local socket expects its answer within a second.
constexpr std::chrono::milliseconds kMaxWait{700};
constexpr double kSameSize_mm = 1e-6;  // diameters that differ by less are the same

/// For how long the scripted operator pauses before a change of tool [ns]: the time until both means of the
/// sensor's readings are known (PausedReadings), times 5/3, since the loop needs time to begin the pause.
rt::Nanoseconds PauseForReadings(double period_s) {
  return static_cast<rt::Nanoseconds>(1e9 * period_s * (5 * PausedReadings::kTicksUntilKnown / 3));
}

}  // namespace

ProcedureSession::ProcedureSession(ProcedureParams params)
    : params_(std::move(params)),
      panel_(params_.plan, params_.X_WG, params_.confirm_size || params_.confirm_load),
      score_({.plan = params_.plan,
              .rubric = params_.rubric,
              .without_rubric = params_.without_rubric,
              .bone = params_.bone,
              .solid = params_.solid,
              .walls = params_.plan_events.value_or(params_.events),
              .X_WG = params_.X_WG}),
      writer_(params_.folder, *params_.bone, params_.wall_time),
      tool_(params_.tool),
      script_(params_.scripted_heights, params_.confirm_size ? PauseForReadings(params_.period_s) : 0),
      file_(params_.file) {
  if (const auto& guidance = params_.tools[static_cast<std::size_t>(tool_)].loop.guidance)
    guidance_gain_ = guidance->gain;
  // Every pass has a state file, whether it was undone or not. New numbers follow the largest one in the
  // folder, so that no file is overwritten.
  states_ =
      std::max(static_cast<int>(file_.passes.size()), LastNumber(params_.folder, kStatePrefix, kStateEnding));
  framed_tool_.store(tool_);
}

tl::expected<void, std::string> ProcedureSession::Begin(simulation::CuttingEngine& engine) {
  uncut_ = std::make_shared<const CarvedState>(engine.Snapshot());
  saved_ = uncut_;
  saved_hash_ = simulation::HashText(*uncut_);
  if (file_.bone_checksum.empty()) file_.bone_checksum = saved_hash_;
  if (file_.bone_checksum != saved_hash_)
    return tl::make_unexpected(
        fmt::format("{}: found a bone of {}, accepted the session's, {}: the packing must be the same",
                    (params_.folder / kSessionFileName).string(), saved_hash_, file_.bone_checksum));
  if (const std::string name = file_.LastState(); !name.empty()) {
    auto state = ReadSessionState(params_.folder, file_, name, *params_.bone);
    if (!state) return tl::make_unexpected(state.error());
    saved_ = std::make_shared<const CarvedState>(std::move(*state));
    saved_name_ = name;
    saved_hash_ = simulation::HashText(*saved_);
    engine.Restore(simulation::WithoutContact(*saved_));
  }
  OpenSegment(0);
  file_.ended = false;
  file_.missed_changes.clear();
  writer_.WriteSession(file_);
  if (std::string wrong = writer_.Flush(); !wrong.empty()) return tl::make_unexpected(std::move(wrong));
  if (file_.PassesLeft() > 0) RenewScore();
  return {};
}

SessionFile ProcedureSession::File() const {
  const std::lock_guard lock(mutex_);
  return file_;
}

std::string ProcedureSession::PanelJson() const {
  SessionFile file;
  double gain = 0.0;
  {
    const std::lock_guard lock(mutex_);
    file.passes = file_.passes;
    file.cup_X_GT = file_.cup_X_GT;
    gain = guidance_gain_;
  }
  return panel_.Json(file, gain);
}

std::optional<double> ProcedureSession::min_wall_m() const {
  std::optional<double> thinnest_m;
  for (const auto& [index, watched] : watched_)
    if (const auto wall_m = watched.watch->min_wall_m(); wall_m && (!thinnest_m || *wall_m < *thinnest_m))
      thinnest_m = wall_m;
  return thinnest_m;
}

void ProcedureSession::OnTick(const control::TickRecord& tick) {
  const std::lock_guard lock(mutex_);
  readings_.Add(tick);
}

void ProcedureSession::Poll(control::ServoLoop& loop) {
  if (const int tool = wanted_tool_.exchange(-1); tool >= 0) loop.RequestTool(tool);
  if (resume_.exchange(false)) loop.RequestResume();
  if (pause_.exchange(false)) loop.RequestPause();
  if (const double gain = wanted_gain_.exchange(-1.0); gain >= 0.0) loop.RequestGuidanceGain(gain);
}

SessionAnswer ProcedureSession::Ask(const SessionRequest& request) {
  struct Waiting {  // where the frames' thread puts its answer
    std::mutex mutex;
    std::condition_variable done;
    std::optional<SessionAnswer> answer;
  };
  const auto waiting = std::make_shared<Waiting>();  // the answer may come after this call has returned
  if (!Post(request, [waiting](const SessionAnswer& answer) {
        {
          const std::lock_guard lock(waiting->mutex);
          waiting->answer = answer;
        }
        waiting->done.notify_all();
      })) {
    const std::lock_guard lock(mutex_);
    return Refused(over_ ? "the run has ended" : "another request is being carried out: ask again");
  }
  std::unique_lock lock(waiting->mutex);
  if (!waiting->done.wait_for(lock, kMaxWait, [&] { return waiting->answer.has_value(); }))
    return Refused("asked for; not carried out yet: see `osteon tell DIR status`");
  return *waiting->answer;
}

bool ProcedureSession::Post(const SessionRequest& request,
                            std::function<void(const SessionAnswer&)> answered) {
  const std::lock_guard lock(mutex_);
  if (open_ || over_) return false;
  open_ = Open{.request = request, .answered = std::move(answered)};
  return true;
}

void ProcedureSession::Answer(const SessionAnswer& answer) {
  std::function<void(const SessionAnswer&)> answered;
  {
    const std::lock_guard lock(mutex_);
    if (!open_) return;
    answered = std::move(open_->answered);
    open_.reset();
  }
  if (answered) answered(answer);
}

void ProcedureSession::BeforeFrame(const ToolCommand& command, FrameRunner& runner) {
  {
    const std::lock_guard lock(mutex_);
    if (SessionSegment& segment = file_.segments.back(); segment.begin == 0) segment.begin = command.stamp;
  }
  if (command.tool_index != tool_) SwitchTool(command, runner);
  if (!command.paused) changed_ = false;
  HandleRequest(command, runner);
  HandleResume(command, runner);
  if (params_.scripted) PressButtons(command);
  last_stamp_ = command.stamp;
}

void ProcedureSession::AfterFrame(const ToolCommand& command, const simulation::FrameRecord& record) {
  panel_.Step(tool_, record.model, command.stamp);
  const auto change = pass_.Step(record.model, command.stamp, command.spindle_rad_per_s);
  score_.AddFrame(tool_, record.model, command.spindle_rad_per_s, change == PassDetector::Change::kBegan);
  framed_tool_.store(tool_);
  frame_stamp_.store(command.stamp);
  in_pass_.store(pass_.open());
  if (change == PassDetector::Change::kBegan) to_go_m_.reset();
  if (pass_.open()) {
    const double to_go_m = PlaceAlongPlan(params_.plan, params_.plan.tools[static_cast<std::size_t>(tool_)],
                                          params_.X_WG.inverse() * Pose(record.model.X_WP))
                               .to_go_m;
    to_go_m_ = std::min(to_go_m, to_go_m_.value_or(to_go_m));
  }
  if (change == PassDetector::Change::kEnded) end_pass_ = true;
}

void ProcedureSession::HandleRequest(const ToolCommand& command, FrameRunner& runner) {
  if (std::exchange(end_pass_, false)) EndPass(runner.engine(), last_stamp_);
  SessionRequest request;
  bool left_pause = false;
  {
    const std::lock_guard lock(mutex_);
    if (!open_) return;
    left_pause = open_->waits_for_loop && !command.paused;
    if (open_->waits_for_loop && !left_pause) return;
    request = open_->request;
  }
  if (left_pause) {  // a fault or a stop ended the pause before the loop took the tool
    wanted_tool_.store(-1);
    return Answer(Refused("the cell is no longer paused: retract the tool, then pause"));
  }
  if (finished_.load()) return Answer(Refused("the session is finished: the run ends"));
  using Kind = SessionRequest::Kind;
  bool waits = false;
  SessionAnswer answer;
  switch (request.kind) {
    case Kind::kNext:
    case Kind::kTool:
      answer = StartChange(request, command, runner, waits);
      break;
    case Kind::kUndo:
      answer = Undo(command, runner);
      break;
    case Kind::kSave:
      answer = Save(command, runner);
      break;
    case Kind::kFinish:
      answer = Finish(request, command, runner);
      break;
    case Kind::kResume:
      answer = Resume(command, runner);
      break;
    case Kind::kGuidance:
      answer = SetGuidance(request.gain);
      break;
    case Kind::kCup: {
      if (params_.plan.kind != procedure::PlanKind::kCup) {
        answer = Refused("found a plan for an opening, accepted `cup` with a plan for a cup");
        break;
      }
      const Pose X_GT = params_.X_WG.inverse() * Pose(command.X_WT);
      {
        const std::lock_guard lock(mutex_);
        file_.cup_X_GT = X_GT;
      }
      WriteFile();
      answer.done = true;
      break;
    }
  }
  if (!waits) return Answer(answer);
  const std::lock_guard lock(mutex_);
  if (open_) open_->waits_for_loop = true;
}

// Steps 1 and 2 of a change of tool: checks everything, then requests the tool from the loop.
// @param waits  becomes true if the answer follows once the loop has the tool
SessionAnswer ProcedureSession::StartChange(const SessionRequest& request, const ToolCommand& command,
                                            FrameRunner& runner, bool& waits) {
  const std::vector<double> sizes = File().diameters_mm;
  int index = tool_ + 1;
  if (request.kind == SessionRequest::Kind::kTool) {
    const auto at = std::find_if(sizes.begin(), sizes.end(), [&](double size) {
      return std::abs(size - request.diameter_mm) < kSameSize_mm;
    });
    index = static_cast<int>(at - sizes.begin());
  }
  if (index >= static_cast<int>(sizes.size())) {
    if (request.kind == SessionRequest::Kind::kNext)
      return Refused(fmt::format("next: {:g} mm is the plan's last tool", sizes.back()));
    std::string planned;
    for (const double size : sizes) planned += fmt::format("{}{:g}", planned.empty() ? "" : ", ", size);
    return Refused(fmt::format("tool: found {:g} mm, accepted the plan's: {}", request.diameter_mm, planned));
  }
  if (index == tool_)
    return Refused(fmt::format("tool: {:g} mm is in use", sizes[static_cast<std::size_t>(index)]));
  if (!command.paused) return Refused("the cell is not paused: retract the tool, then pause");
  if ((params_.confirm_size || params_.confirm_load) && !request.confirmed)
    return Refused(fmt::format("{:g} mm: mount it, {}then ask with \"confirmed\": no sensor tells the size",
                               sizes[static_cast<std::size_t>(index)],
                               params_.confirm_load ? "set the controller's load, " : ""));
  const Pose X_TN = params_.tools[static_cast<std::size_t>(tool_)].loop.X_FT.inverse() *
                    params_.tools[static_cast<std::size_t>(index)].loop.X_FT;
  const Pose X_GN = params_.X_WG.inverse() * Pose(command.X_WT) * X_TN;
  if (std::string why = RetractFirst(runner.engine().Snapshot(), index, X_GN); !why.empty())
    return Refused(std::move(why));
  if (params_.confirm_size)
    if (std::string why = CheckLoad(index, command); !why.empty()) return Refused(std::move(why));
  EndOpenPass(runner.engine(), command.stamp);
  wanted_tool_.store(index);
  waits = true;
  return {};
}

// Checks that the sensor's reading has changed by the difference of the tools' weights. @returns what is
// wrong; empty: nothing
std::string ProcedureSession::CheckLoad(int tool, const ToolCommand& command) const {
  const control::LoopTool& before = params_.tools[static_cast<std::size_t>(tool_)].loop;
  const control::LoopTool& after = params_.tools[static_cast<std::size_t>(tool)].loop;
  const std::lock_guard lock(mutex_);
  if (!readings_.known()) return "the sensor's reading at rest is not known yet: ask again in a second";
  const double error_N = LoadStepError_N(readings_.first_S(), readings_.newest_S(), before.sensor,
                                         after.sensor, Pose(command.X_WT) * before.X_FT.inverse());
  if (error_N <= kMaxLoadError_N) return {};
  return fmt::format(
      "found a step of the sensor that is {:.2f} N off the tools' weights, accepted {:g} N: is the "
      "tool mounted, and does nobody hold it?",
      error_N, kMaxLoadError_N);
}

// Checks that a tool is clear of bone. @returns how far it must be retracted; empty: it is clear
std::string ProcedureSession::RetractFirst(const CarvedState& state, int tool, const Pose& X_GT) const {
  const double clear_m =
      simulation::ToolClearance(state, params_.tools[static_cast<std::size_t>(tool)].tool, X_GT);
  if (clear_m >= kClearToResume_m) return {};
  return fmt::format("retract {:.1f} mm first: the tool of {:g} mm would be {}",
                     std::ceil(1e4 * (kClearToResume_m - clear_m)) / 10.0,
                     1e3 * params_.tools[static_cast<std::size_t>(tool)].diameter_m,
                     clear_m < 0.0 ? fmt::format("{:.2f} mm in bone", -1e3 * clear_m)
                                   : fmt::format("{:.2f} mm from bone, accepted 0.5 mm", 1e3 * clear_m));
}

// Step 3 of a change of tool: the loop has taken the new tool, and the command's pose is already that of the
// new tool.
void ProcedureSession::SwitchTool(const ToolCommand& command, FrameRunner& runner) {
  const int index = command.tool_index;
  const ProcedureTool& tool = params_.tools[static_cast<std::size_t>(index)];
  auto engine = params_.make_engine(tool.tool);
  if (!engine) {
    error_ = engine.error();
    runner.Say("tool: " + error_);
    return Answer(Refused(error_));
  }
  // Start the new engine from the saved state, not from a snapshot of the present bone, because a replay of
  // the session also starts from the saved state.
  CarvedState state = simulation::WithoutContact(*saved_);
  state.frame = runner.engine().Snapshot().frame;
  (*engine)->Restore(state);
  Watched& watched = watched_[index];
  if (!watched.watch) {
    watched.depth.emplace(*params_.bone, tool.tool);
    watched.watch.emplace(params_.solid, *params_.bone, tool.tool, params_.events);
  }
  runner.ReplaceEngine(std::move(*engine), *watched.depth, *watched.watch);
  if (surface::SurfaceThread* surface = runner.surface())
    surface->Apply([&](surface::CarvedField&, surface::ToolSweep& sweep) {
      sweep = surface::ToolSweep(tool.tool, params_.X_WG);
    });
  CloseSegment(last_stamp_);
  tool_ = index;
  {
    const std::lock_guard lock(mutex_);
    readings_.Restart();
  }
  changed_ = true;
  pass_.Restart();
  OpenSegment(command.stamp);
  WriteFile();
  runner.Say(fmt::format("tool: {:g} mm", 1e3 * tool.diameter_m));
  Answer({.done = true, .reason = ""});
}

SessionAnswer ProcedureSession::Undo(const ToolCommand& command, FrameRunner& runner) {
  if (!command.paused) return Refused("the cell is not paused: retract the tool, then pause");
  EndOpenPass(runner.engine(), command.stamp);
  SessionFile after = File();
  const auto last = std::find_if(after.passes.rbegin(), after.passes.rend(),
                                 [](const SessionPass& pass) { return !pass.undone; });
  if (last == after.passes.rend()) return Refused("undo: there is no pass to take back");
  last->undone = true;
  const std::string name = after.LastState();
  std::shared_ptr<const CarvedState> state = uncut_;
  if (!name.empty()) {
    auto read = ReadSessionState(params_.folder, after, name, *params_.bone);
    if (!read) return Refused(read.error());
    state = std::make_shared<const CarvedState>(std::move(*read));
  }
  const Pose X_GT = params_.X_WG.inverse() * Pose(command.X_WT);
  if (std::string why = RetractFirst(*state, tool_, X_GT); !why.empty()) return Refused(std::move(why));
  CarvedState restored = simulation::WithoutContact(*state);
  restored.frame = runner.engine().Snapshot().frame;
  runner.engine().Restore(restored);
  CloseSegment(last_stamp_);
  const int number = last->number;
  {
    const std::lock_guard lock(mutex_);
    file_.passes = after.passes;
  }
  saved_ = state;
  saved_name_ = name;
  saved_hash_ = simulation::HashText(*state);
  if (surface::SurfaceThread* surface = runner.surface())
    surface->Undo(FindUndone(after, params_.recording).here);
  changed_ = true;
  pass_.Restart();
  OpenSegment(command.stamp);
  WriteFile();
  runner.Say(fmt::format("undo: pass {}", number));
  return {.done = true, .reason = ""};
}

SessionAnswer ProcedureSession::Save(const ToolCommand& command, FrameRunner& runner) {
  if (pass_.open() && !pass_.clear()) return Refused("save: the tool touches bone: retract it first");
  EndOpenPass(runner.engine(), command.stamp);
  WriteFile();
  // In virtual time everything is written now. In wall time a thread writes it: the answer does not wait for
  // a slow disk.
  return {.done = true, .reason = ""};
}

// Requests a resume from the loop. After a change of tool or bone, does so only if the tool is clear of bone.
SessionAnswer ProcedureSession::Resume(const ToolCommand& command, const FrameRunner& runner) {
  if (!command.paused) return Refused("the cell is not paused");
  std::string why;
  if (changed_)
    why = RetractFirst(runner.engine().Snapshot(), tool_, params_.X_WG.inverse() * Pose(command.X_WT));
  if (why.empty()) resume_.store(true);
  return why.empty() ? SessionAnswer{.done = true, .reason = ""} : Refused(std::move(why));
}

// Carries out RequestResume. Nobody waits for an answer, so a refusal is reported as a notice of the run.
void ProcedureSession::HandleResume(const ToolCommand& command, FrameRunner& runner) {
  if (!resume_asked_.load()) return;
  {
    const std::lock_guard lock(mutex_);
    if (open_ && open_->waits_for_loop) return;  // first finish the change to the requested tool
  }
  resume_asked_.store(false);
  if (const SessionAnswer answer = Resume(command, runner); !answer.done)
    runner.Say("resume: " + answer.reason);
}

// Presses the buttons of the scripted operator.
void ProcedureSession::PressButtons(const ToolCommand& command) {
  const simulation::ToolBall* head =
      simulation::CuttingHead(params_.tools[static_cast<std::size_t>(tool_)].tool);
  const Vector3 p_T = head ? Vector3(head->center_m) : Vector3::Zero();
  const Vector3 p_C = (params_.X_WG * params_.X_GC).inverse() * (Pose(command.X_WT) * p_T);
  using Action = ScriptedChanges::Action;
  switch (script_.Step(command.stamp, p_C.z(), command.paused,
                       tool_ + 1 < static_cast<int>(params_.tools.size()))) {
    case Action::kNone:
      break;
    case Action::kPause:
      pause_.store(true);
      break;
    case Action::kNext:
      if (!Post({.kind = SessionRequest::Kind::kNext, .diameter_mm = 0.0, .confirmed = true},
                [this](const SessionAnswer& answer) { script_.OnNextAnswered(answer.reason); }))
        script_.OnNextAnswered("another request was being carried out");
      break;
    case Action::kResume:
      resume_asked_.store(true);
      break;
  }
}

// Sets the gain of the guidance. The segment keeps the largest gain that was in force, so that a session that
// was guided for a while counts as guided.
SessionAnswer ProcedureSession::SetGuidance(double gain) {
  if (!params_.tools[static_cast<std::size_t>(tool_)].loop.guidance)
    return Refused("the plan has no guidance");
  {
    const std::lock_guard lock(mutex_);
    guidance_gain_ = gain;
    double& kept = file_.segments.back().guidance_gain;
    kept = std::max(kept, gain);
  }
  wanted_gain_.store(gain);
  WriteFile();
  return {.done = true, .reason = ""};
}

void ProcedureSession::WriteFile() {
  writer_.WriteSession(File());
  RenewScore();
}

std::string ProcedureSession::End(const simulation::CuttingEngine& engine) {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  Answer(Refused("the run has ended"));
  EndOpenPass(engine, last_stamp_);
  CloseSegment(last_stamp_);
  {
    const std::lock_guard lock(mutex_);
    file_.missed_changes = MissedChanges();
    file_.ended = true;
  }
  WriteFile();
  const std::string written = writer_.Flush();
  return written.empty() ? error_ : written;
}

}  // namespace osteon::session
