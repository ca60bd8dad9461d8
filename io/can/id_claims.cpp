#include "io/can/id_claims.h"

#include <fmt/format.h>

#include <utility>

namespace osteon::io {
namespace {

// Describes a claim for an error text: its identifiers, device and purpose.
std::string ClaimText(const IdClaim& claim) {
  const std::string ids =
      claim.first == claim.last ? IdText(claim.first) : IdText(claim.first) + " … " + IdText(claim.last);
  return fmt::format("{} of the {} ({})", ids, claim.device, claim.purpose);
}

}  // namespace

std::vector<IdClaim> Claims(const RobotousParams& params) {
  const std::string device = fmt::format("Robotous force sensor (command id 0x{:03X})", params.command_id);
  const std::string advice = "give the sensor other ids";
  return {{device, "commands", params.command_id, params.command_id, advice},
          {device, "first half of an answer", params.first_id, params.first_id, advice},
          {device, "second half of an answer", params.second_id, params.second_id, advice}};
}

std::vector<IdClaim> Claims(const AtiParams& params) {
  const int first = params.base << 4;
  return {{fmt::format("ATI force sensor (base 0x{:02X})", params.base), "requests and answers",
           static_cast<std::uint16_t>(first), static_cast<std::uint16_t>(first + 0xF),
           "give the sensor another base"}};
}

std::vector<IdClaim> Claims(const ReamerDriveParams& params) {
  const std::string device = fmt::format("reamer drive (node {})", params.node);
  std::vector<IdClaim> claims;
  const auto add = [&](const char* purpose, int id, std::string advice = "give the drive another node") {
    const auto narrow = static_cast<std::uint16_t>(id);
    claims.push_back({device, purpose, narrow, narrow, std::move(advice)});
  };
  add("NMT", canopen::kNmt, "it belongs to CANopen");
  add("SYNC", canopen::kSync, "it belongs to CANopen");
  add("EMCY", canopen::kEmergency + params.node);
  add("TPDO1", canopen::kTpdo1 + params.node);
  add("RPDO1", canopen::kRpdo1 + params.node,
      "give the drive another node (16 or more beside an ATI sensor)");
  add("TPDO2", canopen::kTpdo2 + params.node);
  add("SDO answers", canopen::kSdoAnswer + params.node);
  add("SDO requests", canopen::kSdoRequest + params.node);
  add("heartbeat", canopen::kHeartbeat + params.node);
  add("our heartbeat", canopen::kHeartbeat + params.master_node, "take another master_node");
  return claims;
}

std::optional<std::string> FindOverlap(std::span<const IdClaim> claims) {
  for (std::size_t i = 0; i < claims.size(); ++i) {
    for (std::size_t j = i + 1; j < claims.size(); ++j) {
      const IdClaim &one = claims[i], &other = claims[j];
      if (one.device == other.device || one.first > other.last || other.first > one.last) continue;
      return fmt::format("CAN ids overlap: {} and {}; {}, {}, or use a bus for each", ClaimText(one),
                         ClaimText(other), one.advice, other.advice);
    }
  }
  return std::nullopt;
}

}  // namespace osteon::io
