#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "io/rsi/rsi_session.h"
#include "io/rsi/xml_reader.h"
#include "tests/fuzz/targets/fuzz_input.h"

// Fuzz target: RSI datagrams for the XML reader, the decoder and an RSI session, which answers each. The
// input's byte 0 sets up the session (Setup). For each datagram follow a byte with the loop's command and
// further events (Op), the datagram's size (two bytes, little-endian), and the datagram.

namespace osteon::fuzz {
namespace {

// Bits of the input's first byte.
enum Setup : unsigned { kRelative = 1u << 0, kKroshu = 1u << 1, kNoHold = 1u << 2, kQuick = 1u << 3 };
// Bits of the byte before a datagram.
enum Op : unsigned {
  kMove = 1u << 0,           // the command moves a joint by 0.01 rad
  kNaN = 1u << 1,            // the command has a NaN
  kFar = 1u << 2,            // the command moves a joint by 2 rad
  kOldActivation = 1u << 3,  // the command names another activation than the present one
  kWait = 1u << 4,           // the datagram is not answered
  kResetSession = 1u << 5,
  kStop = 1u << 6,
  kLate = 1u << 7,  // the datagram comes a second later
};
constexpr double kRange_deg = 30.0;  // largest accepted correction of an axis

// Claims that the pieces of the XML reader lie within the text, and that the reader reaches the text's end.
void ReadPieces(std::string_view text) {
  using Event = io::XmlReader::Event;
  io::XmlReader reader(text);
  const auto inside = [&](std::string_view piece) {
    return piece.empty() ||
           (piece.data() >= text.data() && piece.data() + piece.size() <= text.data() + text.size());
  };
  for (std::size_t pieces = 0;; ++pieces) {
    Claim(pieces <= 2 * text.size() + 2, "each piece takes some of the text");
    const Event event = reader.Next();
    Claim(reader.at() <= text.size() && reader.depth() <= io::XmlReader::kMaxDepth,
          "the reader stays inside");
    if (event == Event::kEnd || event == Event::kError) return;
    Claim(inside(reader.name()) && inside(reader.value()), "a piece lies in the text");
  }
}

void ClaimAccepted(const io::RsiRobotMessage& m, std::uint16_t needed) {
  Claim(m.axes_measured || (needed & static_cast<unsigned>(io::RsiElement::kAIPos)) == 0,
        "what is needed is there");
  Claim(m.ipoc_digits >= 1 && m.ipoc_digits <= 20, "IPOC has 1 to 20 digits");
  for (const auto& six :
       {m.axes_measured, m.axes_set, m.pose_measured, m.pose_set, m.external_axes, m.motor_currents})
    for (const double value : six.value_or(io::RsiAxes{}))
      Claim(std::abs(value) <= io::kRsiMaxValue, "a value is finite and at most 1e6");
}

// Runs one session with the whole input.
class SessionRun {
 public:
  explicit SessionRun(Input& in) : in_(in), setup_(in.Byte()) {}

  void All() {
    while (!in_.empty()) Step();
  }

 private:
  static io::RsiSessionParams Params(unsigned setup) {
    io::RsiSessionParams params{
        .layout = (setup & kKroshu) != 0 ? io::RsiLayout::kKroshu : io::RsiLayout::kImFree,
        .absolute = (setup & kRelative) == 0,
        .hold_on = (setup & kNoHold) == 0};
    if ((setup & kQuick) != 0) params.settle_messages = 1;
    params.range.fill(kRange_deg);
    return params;
  }

  void Step() {
    const unsigned op = in_.Byte();
    const auto bytes = in_.Bytes(in_.Word());
    const std::vector<std::uint8_t> datagram(bytes.begin(), bytes.end());
    const std::string_view text(reinterpret_cast<const char*>(datagram.data()), datagram.size());
    ReadPieces(text);
    io::RsiRobotMessage message;
    const auto needed =
        static_cast<std::uint16_t>((op & kMove) != 0 ? io::RsiElement::kAIPos : io::RsiElement::kNone);
    const io::RsiError error = io::DecodeRobot(datagram, needed, message);
    if (error)
      Claim(!io::Describe(error).empty() && error.byte <= datagram.size(), "an error says where");
    else
      ClaimAccepted(message, needed);

    if ((op & kResetSession) != 0) session_.ResetSession();
    if ((op & kStop) != 0) session_.RequestStop();
    now_ += (op & kLate) != 0 ? rt::kSecond : 4 * rt::kMillisecond;
    const control::ArmState before = state_;
    const io::RsiAccept accepted = session_.Accept(datagram, now_, state_);
    if (accepted == io::RsiAccept::kRejected)
      Claim(state_.q_meas == before.q_meas && state_.session == before.session,
            "what is refused changes nothing");
    for (std::size_t i = 0; i < state_.q_meas.size(); ++i)
      Claim(std::isfinite(state_.q_meas[i]) && std::isfinite(state_.q_ipo[i]),
            "the state's positions are finite");
    if ((op & kWait) == 0) Answer(op);
  }

  void Answer(unsigned op) {
    control::ArmCommand command{.q = state_.q_ipo, .activation = state_.activation, .F = {}, .tau = {}};
    if ((op & kMove) != 0) command.q[2] += 0.01;
    if ((op & kFar) != 0) command.q[4] -= 2.0;
    if ((op & kNaN) != 0) command.q[0] = std::nan("");
    if ((op & kOldActivation) != 0) --command.activation;
    const auto datagram = session_.Answer(command);
    if (datagram.empty()) return;
    Claim(datagram.size() <= io::kRsiMaxDatagram, "an answer has at most 2048 bytes");
    const std::string text(reinterpret_cast<const char*>(datagram.data()), datagram.size());
    ReadPieces(text);
    Claim(text.ends_with("</IPOC></Sen>"), "an answer is whole");
    for (const char* name : {" A1=\"", " A2=\"", " A3=\"", " A4=\"", " A5=\"", " A6=\""}) {
      const std::size_t at = text.find(name);
      Claim(at != std::string::npos, "an answer has six corrections");
      const char* begin = text.c_str() + at + std::string_view(name).size();
      char* end = nullptr;
      const double sent = std::strtod(begin, &end);
      Claim(end != begin && *end == '"' && std::isfinite(sent), "a correction is a number");
      if ((setup_ & kRelative) == 0)
        Claim(std::abs(sent) <= kRange_deg + 1e-3, "a correction is in its range");
    }
    for (const double sum : session_.status().sum)
      Claim(std::abs(sum) <= kRange_deg + 1e-3, "the sum of corrections is in its range");
    Claim(session_.Answer(command).empty(), "a message is answered once");
  }

  Input& in_;
  unsigned setup_;
  io::RsiSession session_{Params(setup_)};
  control::ArmState state_;
  rt::Nanoseconds now_{rt::kSecond};
};

}  // namespace
}  // namespace osteon::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  osteon::fuzz::Input in(data, size);
  osteon::fuzz::SessionRun(in).All();
  return 0;
}
