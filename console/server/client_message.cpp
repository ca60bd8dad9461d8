#include "console/server/client_message.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace osteon::console {
namespace {

constexpr const char* kAccepted = "accepted {\"ask\": pause, resume, stop, role, watch or all}";
constexpr std::size_t kShown = 40;  // characters of a wrong word in an error

tl::unexpected<std::string> Refuse(const std::string& found) {
  return tl::unexpected(fmt::format("message: found {}, {}", found, kAccepted));
}

}  // namespace

tl::expected<ClientMessage, std::string> ParseClientMessage(std::string_view bytes) {
  if (bytes.size() > kMaxClientMessage)
    return Refuse(fmt::format("{} bytes (at most {})", bytes.size(), kMaxClientMessage));
  const nlohmann::json json = nlohmann::json::parse(bytes, nullptr, false);
  if (!json.is_object() || json.size() != 1 || !json.contains("ask") || !json["ask"].is_string())
    return Refuse(json.is_discarded() ? "no JSON" : "another object");
  const auto& ask = json["ask"].get_ref<const std::string&>();
  if (ask == "pause") return OperatorRequest::kPause;
  if (ask == "resume") return OperatorRequest::kResume;
  if (ask == "stop") return OperatorRequest::kStop;
  if (ask == "role") return RoleRequest::kTake;
  if (ask == "watch") return RoleRequest::kGiveBack;
  if (ask == "all") return ResendRequest{};
  return Refuse("\"" + ask.substr(0, kShown) + "\"");
}

}  // namespace osteon::console
