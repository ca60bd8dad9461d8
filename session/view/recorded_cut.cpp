#include "session/view/recorded_cut.h"

#include <algorithm>
#include <utility>

#include "report/bone_view.h"
#include "session/procedure/bone_history.h"
#include "session/setup/recorded_config.h"

namespace osteon::session {

bool RecordedCut::Counts(rt::Nanoseconds pose_stamp) const {
  return std::ranges::none_of(undone, [pose_stamp](const surface::SweepTimes& pass) {
    return pose_stamp >= pass.begin && pose_stamp <= pass.end;
  });
}

void RecordedCut::CarveEarlier(surface::CarvedField& field) const {
  if (earlier) report::CarveAlong(field, earlier->paths());
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
  cut->undone = FindUndone(*session, name).here;
  auto earlier = ReadCutBefore(recording.parent_path(), *session, name, cut->tools, setup.X_WG);
  if (!earlier) return tl::make_unexpected(earlier.error());
  cut->earlier = std::move(*earlier);
  return cut;
}

}  // namespace osteon::session
