#include "session/procedure/session_request.h"

#include <charconv>
#include <cmath>
#include <sstream>
#include <vector>

#include <fmt/format.h>

namespace osteon::session {

tl::expected<SessionRequest, std::string> ParseSessionRequest(const std::string& text) {
  std::istringstream words(text);
  std::vector<std::string> all;
  for (std::string word; words >> word;) all.push_back(word);
  const auto refuse = [&] {
    return tl::make_unexpected(
        fmt::format("found \"{}\", accepted next, tool D (mm), undo, save, cup, guidance G (0 … 1), finish, "
                    "resume; \"confirmed\" may follow a change of tool, and finish",
                    text.substr(0, 80)));
  };
  if (all.empty()) return refuse();
  SessionRequest request;
  if (all.back() == "confirmed") {
    request.confirmed = true;
    all.pop_back();
    if (all.empty() || (all[0] != "next" && all[0] != "tool" && all[0] != "finish")) return refuse();
  }
  using Kind = SessionRequest::Kind;
  const auto number = [&](double& value) {
    const char* end = all[1].data() + all[1].size();
    const auto [rest, error] = std::from_chars(all[1].data(), end, value);
    return error == std::errc() && rest == end && std::isfinite(value);
  };
  if (all[0] == "tool" && all.size() == 2) {
    request.kind = Kind::kTool;
    if (!number(request.diameter_mm)) return refuse();
    return request;
  }
  if (all[0] == "guidance" && all.size() == 2) {
    request.kind = Kind::kGuidance;
    if (!number(request.gain) || !(request.gain >= 0.0 && request.gain <= 1.0)) return refuse();
    return request;
  }
  if (all.size() != 1) return refuse();
  if (all[0] == "next")
    request.kind = Kind::kNext;
  else if (all[0] == "undo")
    request.kind = Kind::kUndo;
  else if (all[0] == "save")
    request.kind = Kind::kSave;
  else if (all[0] == "cup")
    request.kind = Kind::kCup;
  else if (all[0] == "finish")
    request.kind = Kind::kFinish;
  else if (all[0] == "resume")
    request.kind = Kind::kResume;
  else
    return refuse();
  return request;
}

}  // namespace osteon::session
