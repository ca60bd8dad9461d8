#pragma once

#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace osteon::session {

/// A request to a session, from `osteon tell` or the console's buttons.
struct SessionRequest {
  enum class Kind { kNext, kTool, kUndo, kSave, kCup, kResume, kGuidance, kFinish };
  Kind kind{Kind::kNext};
  double diameter_mm{0.0};  ///< for kTool: diameter of the tool
  double gain{0.0};         ///< for kGuidance, 0 … 1
  bool confirmed{false};    ///< a person has confirmed size (and load), or the end of an unfinished plan
};
/// The answer to a request: whether it was carried out.
struct SessionAnswer {
  bool done{false};
  std::string reason;  ///< if not done: what was found and what to do
};
[[nodiscard]] inline SessionAnswer Refused(std::string reason) {
  return {.done = false, .reason = std::move(reason)};
}
/// Parses "next [confirmed]", "tool D [confirmed]", "undo", "save", "cup", "resume", "guidance G",
/// "finish [confirmed]". The error says what is accepted.
[[nodiscard]] tl::expected<SessionRequest, std::string> ParseSessionRequest(const std::string& text);

}  // namespace osteon::session
