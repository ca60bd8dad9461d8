#include "io/fri/fri_session.h"
#include "io/fri/proto_reader.h"
#include "tests/fuzz/targets/fri_claims.h"

// Fuzz target: an FRI session that receives datagrams and answers each. The input's byte 0 is the version of
// FRI. For each datagram follow
//
//     byte  0     the loop's command and further events (Op)
//           1, 2  number of bytes that follow, little-endian
//           3     the datagram, without 2.7's frame, which is added here

namespace osteon::fuzz {
namespace {

// Bits of byte 0 of a datagram.
enum Op : unsigned {
  kCommandMeasured =
      1u << 0,               // the command is the measured position; if not set, the interpolator's position
  kCommandNaN = 1u << 1,     // the command has a NaN
  kCommandFar = 1u << 2,     // the command moves a joint by 1 rad
  kOldActivation = 1u << 3,  // the command names another activation than the present one
  kResetSession = 1u << 5,   // the session is reset; bit 4 is not used
  kWait = 1u << 6,           // the datagram is not answered
  kBare = 1u << 7,           // the datagram gets no frame of 2.7
};

// The parts of an answer that the claims need. They are read by the program's own protobuf reader, whose
// tests compare it with libprotobuf.
struct Answer {
  std::uint32_t id{0}, sequence{0}, reflected{0};
  std::array<double, 7> q{};
  std::size_t joints{0};
  bool finite{true};
};

// Reads an answer's fields recursively. @param path  the field numbers from the outermost field inward, four
// bits each
void ReadAnswer(std::span<const std::uint8_t> bytes, Answer& answer, unsigned depth, std::uint32_t path) {
  io::ProtoReader in(bytes);
  while (in.Next()) {
    const std::uint32_t here = path << 4 | in.number();
    if (here == 0x11) {
      answer.id = in.Uint32();
    } else if (here == 0x12) {
      answer.sequence = in.Uint32();
    } else if (here == 0x13) {
      answer.reflected = in.Uint32();
    } else if (here == 0x211) {
      in.Append(answer.q, answer.joints);
    } else if (here == 0x231) {  // torques
      answer.finite &= std::isfinite(in.Double());
    } else if (here == 0x221 || here == 0x242 || here == 0x262) {  // wrench, frames, pose: packed
      std::array<double, 12> values;
      std::size_t count = 0;
      in.Append(values, count);
      for (std::size_t i = 0; i < count; ++i) answer.finite &= std::isfinite(values[i]);
    } else if (depth < 2 && (here == 1 || (here >> 4 == 2 && here != 0x25 && here != 0x27) || here == 2)) {
      ReadAnswer(in.Bytes(), answer, depth + 1, here);
    } else {
      in.Skip();
    }
  }
  Claim(in.ok(), "an answer is a protobuf");
}

// Runs one session with the whole input.
class SessionRun {
 public:
  explicit SessionRun(Input& in) : in_(in), version_(io::kFriVersions[in.Byte() % io::kFriVersions.size()]) {}

  void All() {
    while (!in_.empty()) Step();
    Claim(session_.Diagnosis().size() < 2000, "a diagnosis is some sentences");
  }

 private:
  void Step() {
    const unsigned op = in_.Byte();
    const auto body = in_.Bytes(in_.Word());
    const bool framed = io::FamilyOf(version_) == io::FriFamily::k2_7 && (op & kBare) == 0;
    const auto datagram = framed ? Framed(body) : std::vector<std::uint8_t>(body.begin(), body.end());
    if ((op & kResetSession) != 0) session_.ResetSession();
    const control::ArmState before = state_;
    now_ += rt::kMillisecond;
    const io::FriAccept accepted = session_.Accept(datagram, now_, state_);
    ClaimState(before, accepted);
    if ((op & kWait) == 0) AnswerOnce(op);
  }

  // Claims about the arm's state after a datagram.
  void ClaimState(const control::ArmState& before, io::FriAccept accepted) {
    ClaimFinite(std::optional(state_.q_meas), "the state's position is finite");
    ClaimFinite(std::optional(state_.q_ipo), "the state's interpolator is finite");
    ClaimFinite(std::optional(state_.tau_ext), "the state's torques are finite");
    Claim(state_.period_s > 0.0 && state_.period_s <= 0.1, "the period is 1 to 100 ms");
    Claim(state_.activation - before.activation <= 1, "a message begins one activation at most");
    const std::uint32_t rejected = state_.rejected - before.rejected;
    Claim(rejected == (accepted == io::FriAccept::kRejected ? 1u : 0u), "what is rejected is counted");
    if (accepted == io::FriAccept::kAccepted) {
      Claim(state_.stamp == now_, "what is accepted is new");
      ClaimAccepted(io::FamilyOf(version_), session_.message());
    } else {
      Claim(
          state_.stamp == before.stamp && state_.q_meas == before.q_meas && state_.session == before.session,
          "what is not accepted leaves the state alone");
    }
  }

  control::ArmCommand Command(unsigned op) const {
    control::ArmCommand command{.q = (op & kCommandMeasured) != 0 ? state_.q_meas : state_.q_ipo,
                                .activation = state_.activation};
    if ((op & kCommandFar) != 0) command.q[1] += 1.0;
    if ((op & kCommandNaN) != 0) command.q[3] = command.tau[2] = command.F.f.x = std::nan("");
    if ((op & kOldActivation) != 0) --command.activation;
    return command;
  }

  void AnswerOnce(unsigned op) {
    const control::ArmCommand command = Command(op);
    const auto datagram = session_.Answer(command);
    if (datagram.empty()) return;
    Claim(state_.session != control::SessionState::kIdle, "an idle arm gets no answer");
    Claim(datagram.size() <= io::kFriMaxDatagram, "an answer has at most 1500 bytes");
    std::span<const std::uint8_t> body = datagram;
    if (io::FamilyOf(version_) == io::FriFamily::k2_7)
      Claim(io::Unframe(datagram, body) == io::FrameError::kNone, "2.7's answers are framed");
    Answer answer;
    ReadAnswer(body, answer, 0, 0);
    Claim(answer.id == io::kFriCommandId, "an answer is a command");
    Claim(answer.sequence == ++sequence_, "answers are counted one by one");
    Claim(answer.reflected == session_.message().sequence, "an answer names its message");
    Claim(answer.finite, "an answer is finite");
    ClaimPosition(answer, command);
    Claim(session_.Answer(command).empty(), "a message is answered once");
  }

  // Claims that the session sends only positions that the loop may command: the arm's own, and positions that
  // were sent before.
  void ClaimPosition(const Answer& answer, const control::ArmCommand& command) {
    if (answer.joints == 0) return;
    Claim(answer.joints == 7, "seven joints or none");
    ClaimFinite(std::optional(answer.q), "a position sent is finite");
    const io::MonitoringMessage& m = session_.message();
    const bool active = m.session == control::SessionState::kCommandingActive;
    const bool loops = active && answer.q == command.q && command.activation == state_.activation;
    Claim(loops || m.q_ipo == answer.q || (active ? held_ == answer.q : m.q_cmd == answer.q),
          "a position sent is the loop's, the arm's own, or the one before");
    held_ = answer.q;
  }

  Input& in_;
  io::FriVersion version_;
  io::FriSession session_{{.version = version_}};
  control::ArmState state_;
  rt::Nanoseconds now_{rt::kSecond};
  std::uint32_t sequence_{0};
  std::optional<control::JointArray> held_;
};

}  // namespace
}  // namespace osteon::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  osteon::fuzz::Input in(data, size);
  osteon::fuzz::SessionRun(in).All();
  return 0;
}
