#include <utility>

#include <fmt/format.h>

#include "session/procedure/procedure_session.h"
#include "simulation/engine/state_hash.h"

// The passes and segments of a procedure's session: what is kept, and when.

namespace osteon::session {

// Also where a touch has changed the bone without being a pass: what is cut is never lost.
void ProcedureSession::EndOpenPass(const simulation::CuttingEngine& engine, rt::Nanoseconds stamp) {
  if (pass_.open() || std::exchange(end_pass_, false) ||
      simulation::HashText(engine.Snapshot()) != saved_hash_)
    EndPass(engine, stamp);
}

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
  to_go_m_.reset();
  saved_ = std::move(state);
  saved_name_ = name;
  saved_hash_ = hash;
  if (pass_.open()) pass_.Restart();
  writer_.WriteState(name, saved_);
  WriteFile();
}

void ProcedureSession::CloseSegment(rt::Nanoseconds end) {
  const std::lock_guard lock(mutex_);
  SessionSegment& segment = file_.segments.back();
  segment.end = end;
  segment.end_state = saved_name_ == segment.begin_state ? "" : saved_name_;
  segment.end_state_hash = saved_hash_;
}

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

}  // namespace osteon::session
