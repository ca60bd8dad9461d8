#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "session/procedure/procedure_session.h"
#include "session/procedure/unfinished.h"
#include "simulation/engine/state_hash.h"

// The passes and segments of a procedure's session: which states of the bone are saved, and when; the score;
// the end of the session.

namespace osteon::session {

// Ends the pass. Also saves the bone if a contact outside any pass has changed it, so that no cut is ever
// lost.
void ProcedureSession::EndOpenPass(const simulation::CuttingEngine& engine, rt::Nanoseconds stamp) {
  if (pass_.open() || std::exchange(end_pass_, false) ||
      simulation::HashText(engine.Snapshot()) != saved_hash_)
    EndPass(engine, stamp);
}

// Adds the pass to the session, and saves the bone as the state after this pass.
void ProcedureSession::EndPass(const simulation::CuttingEngine& engine, rt::Nanoseconds stamp) {
  auto state = std::make_shared<const simulation::CarvedState>(engine.Snapshot());
  const std::string name = fmt::format("{}{}{}", kStatePrefix, ++states_, kStateEnding);
  const std::string hash = simulation::HashText(*state);
  {
    const std::lock_guard lock(mutex_);
    file_.passes.push_back({.number = static_cast<int>(file_.passes.size()) + 1,
                            .segment = static_cast<int>(file_.segments.size()) - 1,
                            .tool_index = tool_,
                            .begin = pass_.begin(),
                            .end = stamp,
                            .cutting_s = pass_.cutting_s(),
                            .removed_mm3 = 1e9 * pass_.removed_m3(),
                            .state = name,
                            .state_hash = hash,
                            .undone = false,
                            .to_go_mm = to_go_m_ ? std::optional(1e3 * *to_go_m_) : std::nullopt});
  }
  score_.EndPass(static_cast<int>(File().passes.size()));
  to_go_m_.reset();
  saved_ = std::move(state);
  saved_name_ = name;
  saved_hash_ = hash;
  if (pass_.open()) pass_.Restart();
  writer_.WriteState(name, saved_);
  WriteFile();
}

// Sets end time and last saved state of the open segment.
void ProcedureSession::CloseSegment(rt::Nanoseconds end) {
  const std::lock_guard lock(mutex_);
  SessionSegment& segment = file_.segments.back();
  segment.end = end;
  segment.end_state = saved_name_ == segment.begin_state ? "" : saved_name_;
  segment.end_state_hash = saved_hash_;
}

// Begins a segment with the tool in use and the last saved state. @param begin  0: not known yet
void ProcedureSession::OpenSegment(rt::Nanoseconds begin) {
  const std::lock_guard lock(mutex_);
  file_.segments.push_back({.tool_index = tool_,
                            .recording = params_.recording,
                            .begin = begin,
                            .end = 0,
                            .begin_state = saved_name_,
                            .begin_state_hash = saved_hash_,
                            .end_state = "",
                            .end_state_hash = "",
                            .guidance_gain = guidance_gain_});
}

// Lists the planned tools that the scripted operator has not taken: no segment has them. Call it under
// mutex_.
std::vector<MissedChange> ProcedureSession::MissedChanges() const {
  std::vector<MissedChange> missed;
  if (!params_.scripted) return missed;
  for (int tool = params_.tool + 1; tool < static_cast<int>(params_.tools.size()); ++tool)
    if (std::ranges::none_of(file_.segments, [tool](const auto& s) { return s.tool_index == tool; }))
      missed.push_back({.tool_index = tool, .reason = script_.WhyNotChanged()});
  return missed;
}

// Scores the new state in the writer's thread, since measuring the bone takes some tenths of a second. In
// virtual time the bone is measured when the score is requested.
void ProcedureSession::RenewScore() {
  const SessionFile file = File();
  const bool guided = std::ranges::any_of(
      file.segments, [](const SessionSegment& segment) { return segment.guidance_gain > 0.0; });
  const bool is_over = [&] {
    const std::lock_guard lock(mutex_);
    return over_;
  }();
  if (score_.SetState(saved_, file.passes, file.cup_X_GT, guided, last_stamp_) && !is_over)
    writer_.RunAfter([this] { score_.Update(); });
}

std::string ProcedureSession::ScoreJson() {
  if (!params_.wall_time) score_.Update();
  return score_.Json(frame_stamp_.load(), in_pass_.load());
}

// Ends the session in order: saves the bone, and requests the run's end like an operator's stop.
SessionAnswer ProcedureSession::Finish(const SessionRequest& request, const simulation::ToolCommand& command,
                                       FrameRunner& runner) {
  if (pass_.open() && !pass_.clear()) return Refused("finish: the tool touches bone: retract it first");
  EndOpenPass(runner.engine(), command.stamp);
  if (const Unfinished left = UnfinishedOf(params_.plan, File().passes);
      !left.text.empty() && !request.confirmed)
    return Refused(fmt::format("finish: the plan is not finished: {}; `finish confirmed` ends the session so",
                               left.text));
  WriteFile();
  runner.Say("finish: the session is saved");
  finished_.store(true);
  return {.done = true, .reason = ""};
}

}  // namespace osteon::session
