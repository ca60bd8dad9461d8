#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "io/fri/fri_session.h"
#include "tests/io/fri_oracle.h"

// Fixed-seed fuzzing of what a socket may bring: valid messages with some bytes changed, cut or repeated, and
// noise.

namespace osteon::io {
namespace {

constexpr unsigned kSeed = 20240607;

bool Finite(const std::optional<control::JointArray>& joints) {
  return !joints || std::all_of(joints->begin(), joints->end(), [](double x) { return std::isfinite(x); });
}

class Mutator {
 public:
  std::vector<std::uint8_t> Change(std::vector<std::uint8_t> bytes) {
    const std::size_t changes = 1 + Below(6);
    for (std::size_t i = 0; i < changes && !bytes.empty(); ++i) {
      const std::size_t at = Below(bytes.size());
      const auto here = bytes.begin() + static_cast<std::ptrdiff_t>(at);
      switch (Below(6)) {
        case 0:
          *here = static_cast<std::uint8_t>(Below(256));
          break;
        case 1:
          *here ^= static_cast<std::uint8_t>(1u << Below(8));
          break;
        case 2:
          bytes.resize(at);
          break;
        case 3:
          bytes.insert(here, static_cast<std::uint8_t>(Below(256)));
          break;
        case 4:
          bytes.erase(here);
          break;
        default:  // an infinity or NaN somewhere: the top bytes of a little-endian double
          for (std::size_t k = at; k < std::min(at + 2, bytes.size()); ++k) bytes[k] = k == at ? 0xf0 : 0x7f;
      }
    }
    return bytes;
  }
  std::vector<std::uint8_t> Noise() {
    std::vector<std::uint8_t> bytes(Below(kFriMaxDatagram + 100));
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(Below(256));
    return bytes;
  }
  std::size_t Below(std::size_t n) { return random_() % n; }

 private:
  std::mt19937 random_{kSeed};
};

TEST(FriFuzz, WhatIsAcceptedIsFiniteAndInRange) {
  SCOPED_TRACE(kSeed);
  Mutator mutator;
  int accepted = 0, refused = 0;
  for (int i = 0; i < 60'000; ++i) {
    const auto state = static_cast<fri::SessionState>(mutator.Below(5));
    const auto bytes =
        i % 4 == 3 ? mutator.Noise()
                   : mutator.Change(test::Bytes(test::Monitoring(static_cast<std::uint32_t>(i), state)));
    MonitoringMessage m;
    if (DecodeMonitoring(bytes, m) != CodecError::kNone) {
      ++refused;
      continue;
    }
    ++accepted;
    ASSERT_LE(bytes.size(), kFriMaxDatagram);
    ASSERT_TRUE(Finite(m.q_meas) && Finite(m.q_cmd) && Finite(m.q_ipo) && Finite(m.tau_meas) &&
                Finite(m.tau_cmd) && Finite(m.tau_ext) && std::isfinite(m.tracking_performance));
    ASSERT_LE(m.session, control::SessionState::kCommandingActive);
    ASSERT_LE(m.quality, FriQuality::kExcellent);
    ASSERT_TRUE(m.send_period_ms >= 1 && m.send_period_ms <= 100);
    // What libprotobuf refuses, we refuse: it is the looser reader (it knows no fixed sizes).
    fri::FRIMonitoringMessage oracle;
    ASSERT_TRUE(oracle.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) << i;
    ASSERT_EQ(oracle.header().sequencecounter(), m.sequence);
  }
  EXPECT_GT(accepted, 1000) << "the mutations must not be so wild that nothing gets through";
  EXPECT_GT(refused, 1000);
}

TEST(FriFuzz, TheSessionNeverAnswersWithWhatIsNotFinite) {
  SCOPED_TRACE(kSeed);
  Mutator mutator;
  FriSession session;
  control::ArmState state;
  int answers = 0;
  for (int i = 0; i < 20'000; ++i) {
    const auto kind = static_cast<fri::SessionState>(mutator.Below(5));
    const auto bytes = mutator.Change(test::Bytes(test::Monitoring(static_cast<std::uint32_t>(i), kind)));
    session.Accept(bytes, i, state);
    control::ArmCommand command{test::Joints(0.1)};
    if (i % 3 == 0) command.q[mutator.Below(7)] = std::nan("");
    const auto answer = session.Answer(command);
    if (answer.empty()) continue;
    ++answers;
    const auto sent = test::Command(answer);
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
  }
  EXPECT_GT(answers, 500);
}

}  // namespace
}  // namespace osteon::io
