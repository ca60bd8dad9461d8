#include "session/view/recorded_cut.h"

#include <algorithm>
#include <utility>

#include "report/bone_view.h"
#include "session/setup/recorded_config.h"

namespace osteon::session {

bool RecordedCut::Counts(rt::Nanoseconds pose_stamp) const {
  return std::ranges::none_of(taken_back, [pose_stamp](const TakenBack& pass) {
    return pose_stamp >= pass.begin && pose_stamp <= pass.end;
  });
}

void RecordedCut::CarveEarlier(surface::CarvedField& field) const {
  if (!earlier) return;
  for (const simulation::ToolPath& path : earlier->paths()) report::CarveAlong(field, path);
}

tl::expected<std::shared_ptr<const RecordedCut>, std::string> ReadRecordedCut(
    const std::filesystem::path& recording, const io::SessionInfo& info, const CellSetup& setup) {
  auto cut =
      std::make_shared<RecordedCut>(RecordedCut{.tools = {setup.config.tool.tool}, .X_WG = setup.X_WG});
  const auto list = FindToolList(info.config);
  if (!list) return tl::make_unexpected(recording.string() + ": " + list.error());
  if (!*list) return cut;
  auto cell = LoadRecordedTools(info.config);
  if (!cell) return tl::make_unexpected(recording.string() + ": " + cell.error());
  cut->tools = ToolsOf(cell->tools);

  const auto session = FindSessionOf(recording);
  if (!session) return cut;
  const std::string name = recording.filename().string();
  for (const SessionPass& pass : session->passes)
    if (pass.undone && session->segments.at(static_cast<std::size_t>(pass.segment)).recording == name)
      cut->taken_back.push_back({.begin = pass.begin, .end = pass.end});
  const auto first = std::ranges::find(session->segments, name, &SessionSegment::recording);
  if (first == session->segments.begin()) return cut;
  auto earlier = ReadSessionCut(recording.parent_path(), SessionUpTo(*session, std::prev(first)->recording),
                                cut->tools, setup.X_WG);
  if (!earlier) return tl::make_unexpected(earlier.error());
  cut->earlier = std::move(*earlier);
  return cut;
}

}  // namespace osteon::session
