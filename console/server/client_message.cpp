#include "console/server/client_message.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace osteon::console {
namespace {

constexpr const char* kAccepted =
    "accepted {\"ask\": pause, resume, recover, stop, role, watch, all, play, halt, undo_gains, next_tool, "
    "undo_pass, save, cup, finish; with \"value\": drawn, seek, speed, map, stiffness, drag, tool, guidance}";
constexpr std::size_t kShown = 30;  // number of characters of a wrong word that an error repeats

// The error for a message that is not accepted. @param found  what the message is instead
tl::unexpected<std::string> Refuse(const std::string& found) {
  return tl::unexpected(fmt::format("message: found {}, {}", found, kAccepted));
}

}  // namespace

tl::expected<ClientMessage, std::string> ParseClientMessage(std::string_view bytes) {
  if (bytes.size() > kMaxClientMessage)
    return Refuse(fmt::format("{} bytes (at most {})", bytes.size(), kMaxClientMessage));
  const nlohmann::json json = nlohmann::json::parse(bytes, nullptr, false);
  if (!json.is_object() || !json.contains("ask") || !json["ask"].is_string())
    return Refuse(json.is_discarded() ? "no JSON" : "another object");
  const bool has_value = json.contains("value") && json["value"].is_number();
  const bool confirmed = json.contains("confirmed") && json["confirmed"] == true;
  if (json.size() != 1u + (has_value ? 1u : 0u) + (confirmed ? 1u : 0u)) return Refuse("another object");
  const auto& ask = json["ask"].get_ref<const std::string&>();
  const double value = has_value ? json["value"].get<double>() : 0.0;
  using Procedure = ProcedureRequest::Kind;
  if (ask == "next_tool" && !has_value)
    return ProcedureRequest{.kind = Procedure::kNext, .value = 0.0, .confirmed = confirmed};
  if (ask == "tool" && has_value && std::isfinite(value))
    return ProcedureRequest{.kind = Procedure::kTool, .value = value, .confirmed = confirmed};
  if (ask == "finish" && !has_value)
    return ProcedureRequest{.kind = Procedure::kFinish, .value = 0.0, .confirmed = confirmed};
  if (confirmed) return Refuse("another object");
  if (has_value && std::isfinite(value)) {
    if (ask == "drawn") return DrawnReport{.stamp_s = value};
    if (ask == "seek") return ViewRequest{.kind = ViewRequest::Kind::kSeek, .value = value};
    if (ask == "stiffness") return GainsRequest{.kind = GainsRequest::Kind::kStiffness, .value = value};
    if (ask == "drag") return GainsRequest{.kind = GainsRequest::Kind::kDrag, .value = value};
    if (ask == "guidance") return ProcedureRequest{.kind = Procedure::kGuidance, .value = value};
    if (ask == "map") return ViewRequest{.kind = ViewRequest::Kind::kMap, .value = value};
    if (ask == "speed") return ViewRequest{.kind = ViewRequest::Kind::kSpeed, .value = value};
  }
  if (has_value) return Refuse("a value with \"" + ask.substr(0, kShown) + "\"");
  if (ask == "undo_pass") return ProcedureRequest{.kind = Procedure::kUndo};
  if (ask == "save") return ProcedureRequest{.kind = Procedure::kSave};
  if (ask == "cup") return ProcedureRequest{.kind = Procedure::kCup};
  if (ask == "undo_gains") return GainsRequest{.kind = GainsRequest::Kind::kUndo};
  if (ask == "play") return ViewRequest{.kind = ViewRequest::Kind::kPlay};
  if (ask == "halt") return ViewRequest{.kind = ViewRequest::Kind::kHalt};
  if (ask == "pause") return OperatorRequest::kPause;
  if (ask == "resume") return OperatorRequest::kResume;
  if (ask == "recover") return OperatorRequest::kRecover;
  if (ask == "stop") return OperatorRequest::kStop;
  if (ask == "role") return RoleRequest::kTake;
  if (ask == "watch") return RoleRequest::kGiveBack;
  if (ask == "all") return ResendRequest{};
  return Refuse("\"" + ask.substr(0, kShown) + "\"");
}

}  // namespace osteon::console
