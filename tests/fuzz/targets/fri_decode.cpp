#include "tests/fuzz/targets/fri_claims.h"

// Fuzz target: one FRI datagram. Two bits of the input's byte 0 give the family of FRI versions. Bit 2 says
// whether the frame of 2.7 is added. The rest of the input is the datagram.

namespace osteon::fuzz {
namespace {

constexpr std::array kFamilies{io::FriFamily::k1, io::FriFamily::k2_5, io::FriFamily::k2_7,
                               io::FriFamily::k2_7};
constexpr std::uint32_t kMark =
    0xdecafbad;  // sequence number by which the claims see whether a refused datagram has changed the message

// Encodes a command that contains the arm's own data. Claims that it fits into a datagram, or is refused for
// lack of space.
void ClaimCommandOf(io::FriFamily family, const io::MonitoringMessage& m) {
  io::CommandMessage answer{.sequence = m.sequence, .reflected_sequence = m.reflected_sequence};
  answer.q = m.q_ipo;
  answer.wire_wrench = m.wire_force;
  answer.tau = m.tau_ext;
  answer.X = m.X_ipo;
  std::array<std::uint8_t, io::kFriMaxDatagram> buffer;
  std::size_t size = 0;
  const io::CodecError error = io::EncodeCommand(family, answer, buffer, size);
  Claim(error == io::CodecError::kNone || error == io::CodecError::kNoSpace, "what was read can be written");
  Claim(size <= buffer.size(), "an answer fits its buffer");
}

}  // namespace
}  // namespace osteon::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace osteon;
  fuzz::Input in(data, size);
  const unsigned first = in.Byte();
  const io::FriFamily family = fuzz::kFamilies[first & 3u];
  const auto rest = in.Rest();
  // the memory has exactly the datagram's size, so that a sanitizer detects a read behind its end
  const std::vector<std::uint8_t> datagram =
      (first & 4u) != 0 ? fuzz::Framed(rest) : std::vector<std::uint8_t>(rest.begin(), rest.end());

  io::MonitoringMessage m;
  m.sequence = fuzz::kMark;
  const io::CodecError error = io::DecodeMonitoring(family, datagram, m);
  const auto detected = io::DetectFamily(datagram);
  fuzz::Claim(std::string_view(io::Describe(error)) != "unknown error", "an error has a text");
  if (error != io::CodecError::kNone) {
    fuzz::Claim(m.sequence == fuzz::kMark && !m.q_meas && m.ios.empty(), "an error leaves the message alone");
    return 0;
  }
  fuzz::Claim(datagram.size() <= io::kFriMaxDatagram, "a datagram has at most 1500 bytes");
  fuzz::Claim(detected.value_or(family) == family, "a message is of the family that took it, or of none");
  fuzz::ClaimAccepted(family, m);
  fuzz::ClaimCommandOf(family, m);
  return 0;
}
