#include "session/procedure/session_file.h"

#include "tests/fuzz/targets/file_claims.h"

// Fuzz target: the text of session.json. This file lists the recordings and carved states in a procedure's
// folder.

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace osteon;
  const auto session = session::ParseSession(fuzz::Text({data, size}));
  if (!session) {
    fuzz::Claim(!session.error().empty(), "an error says something");
    return 0;
  }
  const auto tools = static_cast<int>(session->diameters_mm.size());
  const auto segments = static_cast<int>(session->segments.size());
  for (const session::SessionSegment& segment : session->segments) {
    fuzz::Claim(segment.tool_index >= 0 && segment.tool_index < tools, "a segment has a tool of the plan");
    fuzz::Claim(segment.recording.find('/') == std::string::npos, "files lie in the session's folder");
  }
  for (const session::SessionPass& pass : session->passes) {
    fuzz::Claim(pass.segment >= 0 && pass.segment < segments, "a pass is of a segment");
    fuzz::Claim(pass.tool_index >= 0 && pass.tool_index < tools, "and has a tool of the plan");
    fuzz::Claim(pass.state.find('/') == std::string::npos, "states lie in the session's folder");
  }
  fuzz::Claim(session->PassesLeft() <= static_cast<int>(session->passes.size()), "no pass counts twice");
  const std::string text = session::ToJson(*session);
  const auto again = session::ParseSession(text);
  fuzz::Claim(again && session::ToJson(*again) == text, "what was read can be written and read");
  return 0;
}
