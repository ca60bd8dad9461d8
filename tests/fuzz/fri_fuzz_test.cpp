#include <cmath>
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include "io/fri/fri_session.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/io/fri/fri_oracle.h"

// Fixed-seed fuzzing of the FRI messages' decoder and of the FRI session. They receive noise, and valid
// messages in which some bytes were changed, cut or repeated. OSTEON_FUZZ_RUNS sets the number of datagrams
// of each test, e.g. 1000000.

namespace osteon::io {
namespace {

constexpr unsigned kSeed = 20240607;
constexpr std::array kFamilies{FriFamily::k1, FriFamily::k2_5, FriFamily::k2_7};

// Number of datagrams: `usual`, or OSTEON_FUZZ_RUNS if set.
int Runs(int usual) {
  const char* wanted = std::getenv("OSTEON_FUZZ_RUNS");
  return wanted == nullptr ? usual : std::max(1, std::atoi(wanted));
}

bool Finite(const std::optional<control::JointArray>& joints) {
  return !joints || std::all_of(joints->begin(), joints->end(), [](double x) { return std::isfinite(x); });
}

// Makes wrong and hostile datagrams.
class Mutator {
 public:
  // Silences libprotobuf (the oracle), which otherwise reports to stderr each name that is not UTF-8.
  Mutator() { google::protobuf::SetLogHandler(nullptr); }
  // Makes up to six random changes of single bytes, or cuts the end off.
  std::vector<std::uint8_t> Change(std::vector<std::uint8_t> bytes) {
    const std::size_t changes = 1 + RandomBelow(6);
    for (std::size_t i = 0; i < changes && !bytes.empty(); ++i) {
      const std::size_t at = RandomBelow(bytes.size());
      const auto here = bytes.begin() + static_cast<std::ptrdiff_t>(at);
      switch (RandomBelow(6)) {
        case 0:
          *here = static_cast<std::uint8_t>(RandomBelow(256));
          break;
        case 1:
          *here ^= static_cast<std::uint8_t>(1u << RandomBelow(8));
          break;
        case 2:
          bytes.resize(at);
          break;
        case 3:
          bytes.insert(here, static_cast<std::uint8_t>(RandomBelow(256)));
          break;
        case 4:
          bytes.erase(here);
          break;
        default:  // writes an infinity or NaN somewhere: these are the top bytes of a little-endian double
          for (std::size_t k = at; k < std::min(at + 2, bytes.size()); ++k) bytes[k] = k == at ? 0xf0 : 0x7f;
      }
    }
    return bytes;
  }
  // A changed datagram of the message. In FRI 2.7, seven of eight datagrams have a changed message in a frame
  // with the right CRC, because the CRC would otherwise reject nearly all changes.
  std::vector<std::uint8_t> Change(FriFamily family, const fri::FRIMonitoringMessage& message) {
    if (family != FriFamily::k2_7 || RandomBelow(8) == 0) return Change(test::Datagram(family, message));
    return test::Framed(Change(test::Bytes(message)));
  }
  std::vector<std::uint8_t> Noise() {
    std::vector<std::uint8_t> bytes(RandomBelow(kFriMaxDatagram + 100));
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(RandomBelow(256));
    return bytes;
  }
  // A random number from 0 to n - 1.
  std::size_t RandomBelow(std::size_t n) { return random_() % n; }

 private:
  std::mt19937 random_{kSeed};
};

TEST(FriFuzz, ATruncatedMessageIsRefusedOrStillHasAllRequiredFields) {
  for (const FriFamily family : kFamilies) {
    const auto whole = test::Datagram(family, test::FullMonitoring(7, fri::COMMANDING_ACTIVE, family));
    for (std::size_t size = 0; size <= whole.size(); ++size) {
      const std::vector<std::uint8_t> cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      MonitoringMessage m;
      rt::CheckedNoAllocScope no_alloc;
      const CodecError error = DecodeMonitoring(family, cut, m);
      (void)DetectFamily(cut);
      no_alloc.End();
      // Only FRI 2.7 frames its message with a length and a CRC. In the other versions, a message that is cut
      // between two protobuf fields may be accepted, if it contains the required fields.
      if (error == CodecError::kNone) {
        ASSERT_TRUE(m.q_meas && m.q_ipo) << size;
        ASSERT_TRUE(family != FriFamily::k2_7 || size == whole.size());
      }
    }
    MonitoringMessage m;
    EXPECT_EQ(DecodeMonitoring(family, whole, m), CodecError::kNone);
  }
}

TEST(FriFuzz, AnAcceptedMessageIsFiniteAndInRange) {
  SCOPED_TRACE(kSeed);
  Mutator mutator;
  int accepted = 0, refused = 0;
  const int runs = Runs(60'000);
  for (int i = 0; i < runs; ++i) {
    const FriFamily family = kFamilies[mutator.RandomBelow(3)];
    const auto state = static_cast<fri::SessionState>(mutator.RandomBelow(5));
    const auto bytes =
        i % 4 == 3
            ? mutator.Noise()
            : mutator.Change(family, test::FullMonitoring(static_cast<std::uint32_t>(i), state, family));
    MonitoringMessage m;
    rt::CheckedNoAllocScope no_alloc;
    const CodecError error = DecodeMonitoring(family, bytes, m);
    no_alloc.End();
    if (error != CodecError::kNone) {
      ++refused;
      continue;
    }
    ++accepted;
    ASSERT_LE(bytes.size(), kFriMaxDatagram);
    ASSERT_TRUE(Finite(m.q_meas) && Finite(m.q_cmd) && Finite(m.q_ipo) && Finite(m.tau_meas) &&
                Finite(m.tau_cmd) && Finite(m.tau_ext) && std::isfinite(m.tracking_performance));
    ASSERT_LE(m.session, control::SessionState::kCommandingActive);
    ASSERT_LE(m.quality, FriQuality::kExcellent);
    ASSERT_LE(m.command_mode, control::CommandMode::kCartesianPose);
    ASSERT_TRUE(m.send_period_ms >= 1 && m.send_period_ms <= 100);
    for (const FriTransformation& frame : m.transformations) {
      const Pose X = frame.X;
      ASSERT_TRUE(X.matrix().allFinite() && std::abs(X.linear().determinant() - 1.0) < 0.01) << i;
    }
    for (const FriIo& io : m.ios) ASSERT_TRUE(std::isfinite(io.analog.value_or(0.0)));
    // libprotobuf is more tolerant, because it does not know the fixed sizes. So it must accept whatever the
    // decoder accepts
    fri::FRIMonitoringMessage oracle;
    const auto inside = test::Inside(family, bytes);
    ASSERT_TRUE(oracle.ParseFromArray(inside.data(), static_cast<int>(inside.size()))) << i;
    ASSERT_EQ(oracle.header().sequencecounter(), m.sequence);
  }
  EXPECT_GT(accepted, runs / 60) << "the mutations must not be so wild that nothing gets through";
  EXPECT_GT(refused, runs / 60);
}

TEST(FriFuzz, TheSessionNeverSendsAValueThatIsNotFinite) {
  SCOPED_TRACE(kSeed);
  Mutator mutator;
  std::array sessions{FriSession({.version = FriVersion::k1_15}), FriSession({.version = FriVersion::k2_5}),
                      FriSession({.version = FriVersion::k2_7})};
  control::ArmState state;
  int answers = 0;
  const int runs = Runs(20'000);
  for (int i = 0; i < runs; ++i) {
    const std::size_t which = mutator.RandomBelow(3);
    const FriFamily family = kFamilies[which];
    FriSession& session = sessions[which];
    const auto kind = static_cast<fri::SessionState>(mutator.RandomBelow(5));
    fri::FRIMonitoringMessage message = test::FullMonitoring(static_cast<std::uint32_t>(i), kind, family);
    message.mutable_ipodata()->set_clientcommandmode(
        static_cast<fri::ClientCommandMode>(mutator.RandomBelow(family == FriFamily::k1 ? 4 : 5)));
    session.Accept(mutator.Change(family, message), i, state);
    control::ArmCommand command{.q = test::Joints(0.3), .activation = state.activation};
    command.F.f = Vector3(1, 2, 3);
    if (i % 3 == 0) command.q[mutator.RandomBelow(7)] = std::nan("");
    if (i % 5 == 0) command.tau[mutator.RandomBelow(7)] = std::nan("");
    if (i % 7 == 0) command.F.t.y = std::nan("");
    const auto answer = session.Answer(command);
    if (answer.empty()) continue;
    ++answers;
    const auto sent = test::Command(answer, family);
    ASSERT_TRUE(sent);
    const auto& data = sent->commanddata();
    if (data.has_jointposition()) {
      ASSERT_EQ(data.jointposition().value_size(), control::kJoints);
      ASSERT_TRUE(Finite(test::Values(data.jointposition())));
    }
    if (data.has_jointtorque()) {
      ASSERT_TRUE(Finite(test::Values(data.jointtorque())));
    }
    for (const double element : data.cartesianwrenchfeedforward().element())
      ASSERT_TRUE(std::isfinite(element));
    for (const double element : data.cartesianpose().element()) ASSERT_TRUE(std::isfinite(element));
  }
  EXPECT_GT(answers, runs / 40);
  for (const FriSession& session : sessions) EXPECT_LT(session.Diagnosis().size(), 2000u);
}

}  // namespace
}  // namespace osteon::io
