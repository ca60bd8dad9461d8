#include <zlib.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "io/engine/codec.h"
#include "io/engine/engine_setup.h"
#include "tests/fuzz/targets/fuzz_input.h"

// Fuzz target: messages between a run and an engine in its own process. Bit 0 of the input's byte 0 says
// whether size and checksum are corrected first. Bits 1 and 2 select the kind of message: frame, command or
// set-up. The rest of the input is the message.

namespace osteon::fuzz {
namespace {

// Offsets of the header's fields, and size of the set-up's header [byte].
constexpr std::size_t kSizeAt = 8, kCrcAt = 12, kSetupCrcAt = 12, kSetupHead = 16;

// Corrects size and checksum of a frame or command.
void SealMessage(std::vector<std::uint8_t>& bytes) {
  if (bytes.size() < io::kEngineHeaderBytes) return;
  const auto size = static_cast<std::uint32_t>(bytes.size());
  std::memcpy(bytes.data() + kSizeAt, &size, sizeof size);
  const uLong head = crc32_z(0, bytes.data(), kCrcAt);
  const auto crc = static_cast<std::uint32_t>(
      crc32_z(head, bytes.data() + kCrcAt + sizeof size, bytes.size() - kCrcAt - sizeof size));
  std::memcpy(bytes.data() + kCrcAt, &crc, sizeof crc);
}

// Corrects the checksum of a set-up.
void SealSetup(std::vector<std::uint8_t>& bytes) {
  if (bytes.size() < kSetupHead) return;
  const auto crc =
      static_cast<std::uint32_t>(crc32_z(0, bytes.data() + kSetupHead, bytes.size() - kSetupHead));
  std::memcpy(bytes.data() + kSetupCrcAt, &crc, sizeof crc);
}

void ClaimFrame(const std::vector<std::uint8_t>& bytes) {
  io::EngineHeader header;
  io::EngineFrame frame;
  const io::EngineError error = io::DecodeEngine(bytes, header, frame);
  Claim(*io::Describe(error) != '\0', "an error has a text");
  if (error != io::EngineError::kNone)
    return Claim(frame.model.frame == 0, "what is refused changes nothing");
  const simulation::ContactModel& m = frame.model;
  Claim(m.contact_count >= 0 && m.contact_count <= simulation::kMaxContacts, "contacts fit their array");
  for (int i = 0; i < m.contact_count; ++i)
    Claim(std::isfinite(m.contacts[static_cast<std::size_t>(i)].stiffness_N_per_m), "a contact is finite");
  Claim(Pose(m.X_WP).matrix().allFinite() && Vector3(m.F_T_W.f).allFinite(), "pose and force are finite");
  io::EngineBytes again;
  io::EncodeEngine(header, frame, again);
  Claim(std::equal(bytes.begin(), bytes.end(), again.view().begin(), again.view().end()),
        "encodes to itself");
}

void ClaimCommand(const std::vector<std::uint8_t>& bytes) {
  io::EngineHeader header;
  io::EngineCommand command;
  if (io::DecodeEngine(bytes, header, command) != io::EngineError::kNone) return;
  Claim(command.command.stamp > 0 && std::isfinite(command.command.spindle_rad_per_s), "a usable command");
  io::EngineBytes again;
  io::EncodeEngine(header, command, again);
  Claim(std::equal(bytes.begin(), bytes.end(), again.view().begin(), again.view().end()),
        "encodes to itself");
}

void ClaimSetup(const std::vector<std::uint8_t>& bytes) {
  const auto setup = io::DecodeSetup(bytes);
  if (!setup) return Claim(setup.error().starts_with("engine's set-up: "), "a refusal says of what");
  Claim(!setup->bone.balls.empty() && !setup->tool.balls.empty(), "bone and tool have balls");
  for (const simulation::MassPoint& point : setup->bone.points)
    Claim(point.material < setup->bone.materials.size(), "a point's material is listed");
  Claim(io::EncodeSetup(*setup) == bytes, "encodes to itself");
}

}  // namespace
}  // namespace osteon::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace osteon;
  fuzz::Input in(data, size);
  const unsigned how = in.Byte();
  const auto rest = in.Rest();
  std::vector<std::uint8_t> bytes(rest.begin(), rest.end());
  const unsigned kind = (how >> 1u) % 4;
  if ((how & 1u) != 0) kind < 2 ? fuzz::SealMessage(bytes) : fuzz::SealSetup(bytes);
  if (kind == 0)
    fuzz::ClaimFrame(bytes);
  else if (kind == 1)
    fuzz::ClaimCommand(bytes);
  else
    fuzz::ClaimSetup(bytes);
  return 0;
}
