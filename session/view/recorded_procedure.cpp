#include "session/view/recorded_procedure.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/realtime_thread.h"
#include "config/reading/load_surgical_plan.h"
#include "config/reading/strict/config_error.h"
#include "session/procedure/session_cut.h"
#include "session/setup/recorded_config.h"
#include "session/view/recording_timeline.h"

namespace osteon::session {

std::unique_ptr<RecordedProcedure> RecordedProcedure::Open(const std::filesystem::path& recording,
                                                           const io::SessionInfo& info, const Pose& X_WG) {
  auto session = FindSessionOf(recording);
  if (!session) return nullptr;
  const auto cell = LoadRecordedTools(info.config);
  if (!cell || cell->tools.empty()) return nullptr;
  try {
    auto loaded = config::LoadSurgicalPlan(recording.parent_path() / session->plan_file);
    if (!session->plan_name.empty()) loaded.plan.name = session->plan_name;
    if (loaded.plan.tools.size() != cell->tools.size()) return nullptr;
    return std::unique_ptr<RecordedProcedure>(
        new RecordedProcedure(recording, std::move(*session), loaded.plan, X_WG));
  } catch (const config::ConfigError&) {  // the plan's scene cannot be read on this machine
    return nullptr;
  }
}

RecordedProcedure::RecordedProcedure(const std::filesystem::path& recording, SessionFile session,
                                     const procedure::SurgicalPlan& plan, const Pose& X_WG)
    : name_(recording.filename().string()),
      session_(std::move(session)),
      panel_(plan, X_WG, false),
      steps_{JsonAt(0)},
      thread_([this, recording] { Run(recording); }) {}

RecordedProcedure::~RecordedProcedure() {
  stop_.store(true);
  thread_.join();
}

std::string RecordedProcedure::Json(double at_s) const {
  const auto step = static_cast<std::size_t>(std::max(0.0, at_s) / kStep_s);
  const std::lock_guard lock(mutex_);
  return steps_[std::min(step, steps_.size() - 1)];
}

std::string RecordedProcedure::JsonAt(rt::Nanoseconds stamp) const {
  SessionFile session_until;  // the part of the session's file that the panel needs, as it was at the stamp
  session_until.cup_X_GT = session_.cup_X_GT;
  double gain = 0.0;
  bool is_earlier = true;  // true while the segments belong to earlier recordings
  for (std::size_t i = 0; i < session_.segments.size(); ++i) {
    const SessionSegment& segment = session_.segments[i];
    const bool is_own = segment.recording == name_;
    if (is_own) is_earlier = false;
    if (!is_own && !is_earlier) break;  // this segment belongs to a later recording
    if (is_own && segment.begin <= stamp) gain = segment.guidance_gain;
    for (const SessionPass& pass : session_.passes)
      if (pass.segment == static_cast<int>(i) && (!is_own || pass.end <= stamp))
        session_until.passes.push_back(pass);
  }
  return panel_.Json(session_until, gain);
}

void RecordedProcedure::Run(const std::filesystem::path& recording) {
  rt::NameThread("procedure");
  rt::LowerPriority();
  auto timeline = RecordingTimeline::Open(recording);
  if (!timeline) return;
  (void)timeline->Seek(0.0);
  int tool = 0;
  std::size_t steps = 1;
  while (!stop_.load()) {
    const auto topic = timeline->Next();
    if (!topic || *topic == io::RecordedTopic::kOther) return;
    const io::RecordingStream& message = timeline->message();
    if (*topic == io::RecordedTopic::kTick) {
      tool = std::min<int>(message.tick.input.tool_index, static_cast<int>(session_.diameters_mm.size()) - 1);
      for (; static_cast<double>(steps) * kStep_s <= timeline->At(message.tick.stamp); ++steps) {
        std::string json = JsonAt(message.tick.stamp);
        const std::lock_guard lock(mutex_);
        steps_.push_back(std::move(json));
      }
    }
    if (*topic != io::RecordedTopic::kFrame) continue;
    panel_.Step(tool, message.frame.model, message.frame.model.pose_stamp);
  }
}

}  // namespace osteon::session
