#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include <tl/expected.hpp>

// What a page may say to the server, as JSON in one WebSocket message. Everything else is refused.

namespace osteon::console {

/// Longest message that is read from a page.
inline constexpr std::size_t kMaxClientMessage = 1024;

/// {"ask": "pause"}: a request to the cell. Only the page with the operator's role may make one.
enum class OperatorRequest : std::uint8_t { kPause, kResume, kStop, kRecover };
/// {"ask": "role"} and {"ask": "watch"}: takes the operator's role if nobody has it; gives it back.
enum class RoleRequest : std::uint8_t { kTake, kGiveBack };
/// {"ask": "all"}: everything again, after a page has lost its picture.
struct ResendRequest {};

/// {"ask": "play"}, {"ask": "halt"}, {"ask": "seek", "value": seconds}, {"ask": "speed", "value": factor},
/// {"ask": "map", "value": 1 or 0}, the bones' difference as their colour: of recordings that are viewed. The
/// value is finite.
struct ViewRequest {
  enum class Kind : std::uint8_t { kPlay, kHalt, kSeek, kSpeed, kMap } kind{Kind::kPlay};
  double value{0.0};
};

/// {"ask": "stiffness", "value": N_per_m}, {"ask": "drag", "value": Ns_per_m}, {"ask": "undo_gains"}: of the
/// running cell, by the page with the operator's role. The value is finite.
struct GainsRequest {
  enum class Kind : std::uint8_t { kStiffness, kDrag, kUndo } kind{Kind::kUndo};
  double value{0.0};
};

/// {"ask": "next_tool"}, {"ask": "tool", "value": diameter in mm}, {"ask": "undo_pass"}, {"ask": "save"},
/// {"ask": "cup"}, {"ask": "guidance", "value": 0 … 1}, {"ask": "finish"}: of a procedure's session, by the
/// page with the operator's role. "confirmed": true beside a change of tool: a person has confirmed what is
/// mounted; beside finish: that the session ends although its plan is not finished. The value is finite.
struct ProcedureRequest {
  enum class Kind : std::uint8_t { kNext, kTool, kUndo, kSave, kCup, kGuidance, kFinish } kind{Kind::kNext};
  double value{0.0};
  bool confirmed{false};
};

/// {"ask": "drawn", "value": seconds}: the page has drawn the figures of the window whose last tick has this
/// stamp. A measurement: nothing acts on it. The value is finite.
struct DrawnReport {
  double stamp_s{0.0};
};

using ClientMessage = std::variant<OperatorRequest, RoleRequest, ResendRequest, ViewRequest, GainsRequest,
                                   ProcedureRequest, DrawnReport>;

/// Parses a page's message. The error names what was found and what is accepted; it is at most 300 bytes and
/// in ASCII apart from the message's own first characters.
[[nodiscard]] tl::expected<ClientMessage, std::string> ParseClientMessage(std::string_view bytes);

}  // namespace osteon::console
