#include "session/procedure/session_cut.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/write_text.h"
#include "config/reading/load_surgical_plan.h"
#include "config/reading/strict/config_error.h"
#include "io/recording/recording_reader.h"

namespace osteon::session {

SessionCut::SessionCut(const SessionFile& session, std::vector<simulation::Tool> tools, const Pose& X_WG)
    : tools_(std::move(tools)) {
  for (const SessionPass& pass : session.passes) {
    const auto tool = static_cast<std::size_t>(pass.tool_index);
    if (pass.undone || tool >= tools_.size()) continue;
    passes_.push_back({.recording = session.segments[static_cast<std::size_t>(pass.segment)].recording,
                       .begin = pass.begin,
                       .end = pass.end,
                       .tool = pass.tool_index,
                       .path = simulation::ProxyPath(tools_[tool], X_WG)});
  }
}

void SessionCut::Add(const std::string& recording, const simulation::FrameRecord& frame) {
  const rt::Nanoseconds stamp = frame.model.pose_stamp;
  for (Pass& pass : passes_)
    if (pass.recording == recording && stamp >= pass.begin && stamp <= pass.end) pass.path.Add(frame);
}

std::vector<simulation::ToolPath> SessionCut::paths() const {
  std::vector<simulation::ToolPath> paths;
  for (const Pass& pass : passes_)
    if (!pass.path.X_GP().empty())
      paths.push_back({.tool = &tools_[static_cast<std::size_t>(pass.tool)], .X_GP = pass.path.X_GP()});
  return paths;
}

double SessionCut::tolerance_m() const {
  double tolerance_m = 0.0;
  for (const Pass& pass : passes_) tolerance_m = std::max(tolerance_m, pass.path.tolerance_m());
  return tolerance_m;
}

std::optional<SessionFile> FindSessionOf(const std::filesystem::path& recording) {
  std::filesystem::path folder = recording.parent_path();
  if (folder.empty()) folder = ".";
  std::error_code error;
  if (!std::filesystem::exists(folder / kSessionFileName, error)) return std::nullopt;
  auto session = ReadSession(folder);
  if (!session || std::ranges::find(session->segments, recording.filename().string(),
                                    &SessionSegment::recording) == session->segments.end())
    return std::nullopt;
  return std::move(*session);
}

SessionFile SessionUpTo(SessionFile session, const std::string& recording) {
  int last = 0;
  for (std::size_t i = 0; i < session.segments.size(); ++i)
    if (session.segments[i].recording == recording) last = static_cast<int>(i);
  session.segments.resize(static_cast<std::size_t>(last) + 1);
  std::erase_if(session.passes, [last](const SessionPass& pass) { return pass.segment > last; });
  return session;
}

tl::expected<SessionCut, std::string> ReadSessionCut(const std::filesystem::path& folder,
                                                     const SessionFile& session,
                                                     std::vector<simulation::Tool> tools, const Pose& X_WG,
                                                     const CountsFrame& counts) {
  SessionCut cut(session, std::move(tools), X_WG);
  for (const std::string& recording : BegunRecordings(session, folder)) {
    auto stream = io::RecordingStream::Open(folder / recording);
    if (!stream) return tl::make_unexpected(stream.error());
    while (true) {
      const auto topic = stream->Next();
      if (!topic) return tl::make_unexpected(topic.error());
      if (*topic == io::RecordedTopic::kOther) break;
      if (*topic == io::RecordedTopic::kFrame && (!counts || counts(recording, stream->frame)))
        cut.Add(recording, stream->frame);
    }
  }
  return cut;
}

tl::expected<std::optional<SessionCut>, std::string> ReadCutBefore(const std::filesystem::path& folder,
                                                                   const SessionFile& session,
                                                                   const std::string& recording,
                                                                   std::vector<simulation::Tool> tools,
                                                                   const Pose& X_WG) {
  const auto first = std::ranges::find(session.segments, recording, &SessionSegment::recording);
  if (first == session.segments.begin() || first == session.segments.end()) return std::nullopt;
  auto cut =
      ReadSessionCut(folder, SessionUpTo(session, std::prev(first)->recording), std::move(tools), X_WG);
  if (!cut) return tl::make_unexpected(std::move(cut.error()));
  return std::optional(std::move(*cut));
}

std::optional<procedure::PlannedCavity> ReadPlannedCavity(const std::filesystem::path& folder,
                                                          const SessionFile& session) {
  try {
    return config::LoadSurgicalPlan(folder / session.plan_file).plan.cavity();
  } catch (const config::ConfigError&) {  // the plan, or its scene, cannot be read on this machine
    return std::nullopt;
  }
}

tl::expected<std::filesystem::path, std::string> WritePassTable(const SessionFile& session,
                                                                const std::filesystem::path& recording,
                                                                rt::Nanoseconds start,
                                                                const std::filesystem::path& folder) {
  const std::string name = recording.filename().string();
  std::string text = "number,tool_mm,begin_s,end_s,cutting_s,removed_mm3,to_go_mm,undone\n";
  for (const SessionPass& pass : session.passes) {
    if (session.segments[static_cast<std::size_t>(pass.segment)].recording != name) continue;
    text += fmt::format("{},{},{},{},{},{},{},{}\n", pass.number,
                        session.diameters_mm[static_cast<std::size_t>(pass.tool_index)],
                        rt::ToSeconds(pass.begin - start), rt::ToSeconds(pass.end - start), pass.cutting_s,
                        pass.removed_mm3, pass.to_go_mm ? fmt::format("{}", *pass.to_go_mm) : "",
                        pass.undone ? 1 : 0);
  }
  const std::filesystem::path path = folder / (recording.stem().string() + "_passes.csv");
  if (const auto written = base::WriteText(path, text); !written) return tl::make_unexpected(written.error());
  return path;
}

}  // namespace osteon::session
