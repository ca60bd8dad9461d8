#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include <tl/expected.hpp>

// The messages that a page may send to the server, each as JSON in one WebSocket message. Everything else is
// refused.

namespace osteon::console {

/// Longest message that is read from a page [bytes].
inline constexpr std::size_t kMaxClientMessage = 1024;

/// {"ask": "pause"}, and likewise "resume", "stop" and "recover": a request to the cell. Only the page with
/// the operator's role may make one.
enum class OperatorRequest : std::uint8_t { kPause, kResume, kStop, kRecover };
/// {"ask": "role"} requests the operator's role, which is granted if no page has it; {"ask": "watch"} gives
/// it back.
enum class RoleRequest : std::uint8_t { kTake, kGiveBack };
/// {"ask": "all"}: send all data again, because the page has lost some of them.
struct ResendRequest {};

/// {"ask": "play"}, {"ask": "halt"}, {"ask": "seek", "value": seconds}, {"ask": "speed", "value": factor},
/// {"ask": "map", "value": 1 or 0}: a request to the playback of recordings. "map" colours two bones by their
/// difference. The value is finite.
struct ViewRequest {
  enum class Kind : std::uint8_t { kPlay, kHalt, kSeek, kSpeed, kMap } kind{Kind::kPlay};
  double value{0.0};
};

/// {"ask": "stiffness", "value": N_per_m}, {"ask": "drag", "value": Ns_per_m}, {"ask": "undo_gains"}: changes
/// the gains of the running cell. Only the page with the operator's role may ask. The value is finite.
struct GainsRequest {
  enum class Kind : std::uint8_t { kStiffness, kDrag, kUndo } kind{Kind::kUndo};
  double value{0.0};
};

/// {"ask": "next_tool"}, {"ask": "tool", "value": diameter in mm}, {"ask": "undo_pass"}, {"ask": "save"},
/// {"ask": "cup"}, {"ask": "guidance", "value": 0 … 1}, {"ask": "finish"}: a request to a procedure's
/// session. Only the page with the operator's role may ask. With a change of tool, "confirmed": true means
/// that a person has confirmed which tool is mounted. With "finish", it means that the session shall end
/// although its plan is not finished. The value is finite.
struct ProcedureRequest {
  enum class Kind : std::uint8_t { kNext, kTool, kUndo, kSave, kCup, kGuidance, kFinish } kind{Kind::kNext};
  double value{0.0};
  bool confirmed{false};
};

/// {"ask": "drawn", "value": seconds}: the page has drawn the figures of the window whose last tick has this
/// stamp. The server only computes delays from it. The value is finite.
struct DrawnReport {
  double stamp_s{0.0};
};

using ClientMessage = std::variant<OperatorRequest, RoleRequest, ResendRequest, ViewRequest, GainsRequest,
                                   ProcedureRequest, DrawnReport>;

/// Parses a page's message. The error names what was found and what is accepted; it is at most 300 bytes and
/// in ASCII apart from the message's own first characters.
[[nodiscard]] tl::expected<ClientMessage, std::string> ParseClientMessage(std::string_view bytes);

}  // namespace osteon::console
