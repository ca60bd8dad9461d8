#include "session/procedure/session_request.h"

#include <charconv>
#include <cmath>
#include <sstream>
#include <vector>

#include <fmt/format.h>

namespace osteon::session {

tl::expected<SessionRequest, std::string> ParseSessionRequest(const std::string& text) {
  std::istringstream words(text);
  std::vector<std::string> parts;
  for (std::string word; words >> word;) parts.push_back(word);
  const auto refuse = [&] {
    return tl::make_unexpected(
        fmt::format("found \"{}\", accepted next, tool D (mm), undo, save, cup, guidance G (0 … 1), finish, "
                    "resume; \"confirmed\" may follow a change of tool, and finish",
                    text.substr(0, 80)));
  };
  if (parts.empty()) return refuse();
  SessionRequest request;
  if (parts.back() == "confirmed") {
    request.confirmed = true;
    parts.pop_back();
    if (parts.empty() || (parts[0] != "next" && parts[0] != "tool" && parts[0] != "finish")) return refuse();
  }
  using Kind = SessionRequest::Kind;
  // reads the second word as a finite number
  const auto read_number = [&](double& value) {
    const char* end = parts[1].data() + parts[1].size();
    const auto [rest, error] = std::from_chars(parts[1].data(), end, value);
    return error == std::errc() && rest == end && std::isfinite(value);
  };
  if (parts[0] == "tool" && parts.size() == 2) {
    request.kind = Kind::kTool;
    if (!read_number(request.diameter_mm)) return refuse();
    return request;
  }
  if (parts[0] == "guidance" && parts.size() == 2) {
    request.kind = Kind::kGuidance;
    if (!read_number(request.gain) || !(request.gain >= 0.0 && request.gain <= 1.0)) return refuse();
    return request;
  }
  if (parts.size() != 1) return refuse();
  if (parts[0] == "next")
    request.kind = Kind::kNext;
  else if (parts[0] == "undo")
    request.kind = Kind::kUndo;
  else if (parts[0] == "save")
    request.kind = Kind::kSave;
  else if (parts[0] == "cup")
    request.kind = Kind::kCup;
  else if (parts[0] == "finish")
    request.kind = Kind::kFinish;
  else if (parts[0] == "resume")
    request.kind = Kind::kResume;
  else
    return refuse();
  return request;
}

}  // namespace osteon::session
