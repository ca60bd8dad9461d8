#include "session/procedure/bone_history.h"

#include <stdexcept>

#include "report/bone_view.h"
#include "session/procedure/procedure_session.h"
#include "session/procedure/session_cut.h"

namespace osteon::session {

UndonePasses FindUndone(const SessionFile& session, const std::string& recording) {
  UndonePasses found;
  for (const SessionPass& pass : session.passes) {
    if (!pass.undone) continue;
    if (session.segments.at(static_cast<std::size_t>(pass.segment)).recording == recording)
      found.here.push_back({.begin = pass.begin, .end = pass.end});
    else
      ++found.earlier;
  }
  return found;
}

BoneHistory HistoryOf(const ProcedureSession& session, const Pose& X_WG) {
  BoneHistory history;
  history.undone = [&session] { return FindUndone(session.File(), session.recording()); };
  const SessionFile file = session.File();
  if (file.segments.empty() || file.segments.front().recording == session.recording()) return history;
  history.carve_earlier = [&session, X_WG](surface::CarvedField& field) {
    const auto cut =
        ReadCutBefore(session.folder(), session.File(), session.recording(), ToolsOf(session.tools()), X_WG);
    if (!cut) throw std::runtime_error(cut.error());
    if (*cut) report::CarveAlong(field, (*cut)->paths());
  };
  return history;
}

}  // namespace osteon::session
