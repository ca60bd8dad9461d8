#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "io/rsi/rsi_session.h"
#include "tests/io/rsi/rsi_oracle.h"

// Fixed-seed fuzzing of the RSI messages' decoder and of the RSI session. They receive noise that looks like
// XML, and valid messages in which bytes were changed, cut or repeated.

namespace osteon::io {
namespace {

constexpr unsigned kSeed = 20240931;

// Makes wrong and hostile datagrams.
class Mutator {
 public:
  std::vector<std::uint8_t> Change(std::vector<std::uint8_t> bytes) {
    static constexpr std::string_view kXml = "<>/=\"' .-+e0123456789ABCXYZ!?&;\0\n";
    const std::size_t changes = 1 + Below(4);
    for (std::size_t i = 0; i < changes && !bytes.empty(); ++i) {
      const auto here = bytes.begin() + static_cast<std::ptrdiff_t>(Below(bytes.size()));
      const auto there = bytes.begin() + static_cast<std::ptrdiff_t>(Below(bytes.size()));
      switch (Below(7)) {
        case 0:
          *here = static_cast<std::uint8_t>(Below(256));
          break;
        case 1:
        case 2:
          *here = static_cast<std::uint8_t>(kXml[Below(kXml.size())]);
          break;
        case 3:
          bytes.insert(here, static_cast<std::uint8_t>(kXml[Below(kXml.size())]));
          break;
        case 4:
          bytes.erase(here);
          break;
        case 5:
          if (Below(4) == 0) bytes.erase(here, bytes.end());
          break;
        default:  // repeats a piece
          bytes.insert(here, std::min(here, there), std::min(std::min(here, there) + 20, bytes.end()));
          break;
      }
    }
    return bytes;
  }
  std::vector<std::uint8_t> Noise() {
    static constexpr std::string_view kXml = "<<>>//==\"\"''   RobIPOCAIPosA1234567890.-";
    std::vector<std::uint8_t> bytes(Below(kRsiMaxDatagram + 100));
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(kXml[Below(kXml.size())]);
    return bytes;
  }
  std::size_t Below(std::size_t n) { return random_() % n; }

 private:
  std::mt19937 random_{kSeed};
};

// Whether expat has read this number under this name.
bool SameNumber(const test::XmlValues& read, const std::string& name, double value) {
  const auto found = read.find(name);
  return found != read.end() && std::stod(found->second) == value;
}

TEST(RsiFuzz, AcceptedValuesAreFiniteAndThoseThatExpatReads) {
  SCOPED_TRACE(kSeed);
  Mutator mutator;
  int accepted = 0, refused = 0, agreed = 0;
  for (int i = 0; i < 60'000; ++i) {
    const auto bytes = i % 8 == 7 ? mutator.Noise()
                                  : mutator.Change(test::Bytes(i % 2 ? test::kFullRobot : test::kShortRobot));
    RsiRobotMessage m;
    if (DecodeRobot(bytes, static_cast<std::uint16_t>(RsiElement::kAIPos), m)) {
      ++refused;
      continue;
    }
    ++accepted;
    ASSERT_TRUE(m.axes_measured);
    for (const auto& six :
         {m.axes_measured, m.axes_set, m.pose_measured, m.pose_set, m.external_axes, m.motor_currents})
      for (const double value : six.value_or(RsiAxes{})) ASSERT_LE(std::abs(value), 1e6);
    // oracle: expat refuses more texts than the decoder (entities, encodings). From the texts that it
    // accepts, it must read the same values
    std::string text = test::Text(bytes);
    while (!text.empty() && text.back() == '\0') text.pop_back();
    const auto read = test::ReadByExpat(text);
    if (!read) continue;
    ++agreed;
    for (std::size_t k = 0; k < 6; ++k)
      ASSERT_TRUE(SameNumber(*read, "AIPos/A" + std::to_string(k + 1), (*m.axes_measured)[k])) << text;
    ASSERT_EQ(std::stoull(read->at("IPOC")), m.ipoc) << text;
  }
  EXPECT_GT(accepted, 5000) << "the mutations must not be so wild that nothing gets through";
  EXPECT_GT(agreed, accepted * 9 / 10) << "refused by expat alone must stay rare";
  EXPECT_GT(refused, 5000);
}

TEST(RsiFuzz, TheSessionAnswersOnlyWithWholeMessagesInItsRange) {
  SCOPED_TRACE(kSeed);
  Mutator mutator;
  int answers = 0;
  for (const bool absolute : {true, false}) {
    RsiSession session({.absolute = absolute,
                        .entry_step_deg = 180.0,
                        .settle_messages = 1,
                        .range = {30, 30, 30, 30, 30, 30}});
    control::ArmState state;
    rt::Nanoseconds now = 0;
    for (int i = 0; i < 20'000; ++i) {
      std::string text = test::kShortRobot;
      text.replace(text.find("0000012345"), 10, std::to_string(1000 + 4 * i));
      session.Accept(mutator.Below(3) ? test::Bytes(text) : mutator.Change(test::Bytes(text)),
                     now += 4 * rt::kMillisecond, state);
      control::ArmCommand command{.q = state.q_meas, .activation = state.activation, .F = {}, .tau = {}};
      command.q[mutator.Below(6)] += i % 7 ? 0.001 * static_cast<double>(mutator.Below(1000)) : std::nan("");
      const auto answer = session.Answer(command);
      if (answer.empty()) continue;
      ++answers;
      const auto read = test::ReadByExpat(test::Text(answer));
      ASSERT_TRUE(read) << test::Text(answer);
      for (std::size_t k = 0; k < 6; ++k) {
        const double sent = std::stod(read->at("AK/A" + std::to_string(k + 1)));
        ASSERT_TRUE(std::isfinite(sent));
        if (absolute) {
          ASSERT_LE(std::abs(sent), 30.0 + 1e-4);
        } else {
          ASSERT_LE(std::abs(session.status().sum[k]), 30.0 + 1e-4);
        }
      }
    }
  }
  EXPECT_GT(answers, 20'000);
}

}  // namespace
}  // namespace osteon::io
