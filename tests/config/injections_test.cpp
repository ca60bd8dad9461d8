#include "config/reading/simulated/read_injections.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

// Tests a cell's list `injections`: faults such as loss or delay that act on the simulated wires.

namespace osteon::config {
namespace {

using hil::Direction;
using hil::Wire;
using testing::HasSubstr;

// The injections in a cell of this text.
hil::InjectionParams Read(const std::string& text) {
  Reader reader = Reader::Parse(text, "cell.yaml");
  const hil::InjectionParams params = ReadInjections(reader);
  reader.Finish();
  return params;
}

// The error of Read for this text; "accepted" if there is none.
std::string Refusal(const std::string& text) {
  try {
    static_cast<void>(Read(text));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "accepted";
}

// Text of a list with one injection, which lasts from 1 s to 2 s and has these keys in addition.
std::string OneInjection(const std::string& keys, const std::string& wire = "arm",
                         const std::string& direction = "both") {
  return "injections:\n  - {wire: " + wire + ", direction: " + direction + ", from_s: 1, to_s: 2, " + keys +
         "}\n";
}

TEST(Injections, AreEmptyWhereACellNamesNone) {
  EXPECT_TRUE(Read("{}").injections.empty());
  EXPECT_TRUE(Read("injections: []").injections.empty());
}

TEST(Injections, EveryKeyIsReadAndConvertedToSi) {
  const hil::InjectionParams params = Read(R"(
injection_seed: 77
injections:
  - wire: arm
    direction: to_controller
    from_s: -1
    to_s: 2.5
    loss_ratio: 0.05
    burst_count: 20
    duplicate_ratio: 0.01
    reorder_ratio: 0.02
    corrupt_ratio: 0.03
    delay_ms: 0.4
    jitter_ms: 2
  - {wire: force_sensor, direction: from_controller, from_s: 1, to_s: 1.2, silence: true}
  - {wire: drive, direction: both, from_s: 0, to_s: 9, corrupt_ratio: 1}
  - {wire: plc, direction: both, from_s: 0, to_s: 9, delay_ms: 100, silence: false}
)");
  EXPECT_EQ(params.seed, 77u);
  ASSERT_EQ(params.injections.size(), 4u);
  const hil::Injection& arm = params.injections[0];
  EXPECT_EQ(arm.wire, Wire::kArm);
  EXPECT_EQ(arm.direction, Direction::kToController);
  EXPECT_EQ(arm.from_s, -1.0);
  EXPECT_EQ(arm.to_s, 2.5);
  EXPECT_EQ(arm.faults, (hil::WireFaults{.loss = 0.05,
                                         .burst = 20,
                                         .duplicate = 0.01,
                                         .reorder = 0.02,
                                         .corrupt = 0.03,
                                         .delay = 400'000,
                                         .jitter = 2'000'000}));
  EXPECT_EQ(params.injections[1].wire, Wire::kForceSensor);
  EXPECT_EQ(params.injections[1].direction, Direction::kFromController);
  EXPECT_EQ(params.injections[1].faults, hil::WireFaults{.silence = true});
  EXPECT_EQ(params.injections[2].wire, Wire::kDrive);
  EXPECT_EQ(params.injections[2].direction, Direction::kBoth);
  EXPECT_EQ(params.injections[3].wire, Wire::kPlc);
  EXPECT_EQ(params.injections[3].faults, hil::WireFaults{.delay = 100'000'000});
  EXPECT_NO_THROW(hil::Validate(params));
}

TEST(Injections, RefusalsNameTheKeyAndWhatIsAccepted) {
  EXPECT_THAT(Refusal(OneInjection("loss_ratio: 1.5")),
              HasSubstr("cell.yaml:2: loss_ratio: found 1.5, accepted 0 … 1"));
  EXPECT_THAT(Refusal(OneInjection("delay_ms: 201")), HasSubstr("delay_ms: found 201, accepted 0 … 200"));
  EXPECT_THAT(Refusal(OneInjection("loss_ratio: 0.1", "radio")),
              HasSubstr("wire: found radio, accepted arm, force_sensor, drive, plc"));
  EXPECT_THAT(Refusal(OneInjection("los_ratio: 0.1")), HasSubstr("did you mean \"loss_ratio\"?"));
  EXPECT_THAT(Refusal(OneInjection("burst_count: 5, delay_ms: 1")),
              HasSubstr("burst_count: needs a loss_ratio"));
  EXPECT_THAT(Refusal(OneInjection("silence: false")),
              HasSubstr("an injection of nothing; accepted at least one of "));
  EXPECT_THAT(Refusal("injections: [{wire: arm, direction: both, from_s: 2, to_s: 2, silence: true}]"),
              HasSubstr("to_s: found 2, accepted more than from_s (2)"));
  EXPECT_THAT(Refusal("injections: [{wire: arm, direction: both, from_s: 2, silence: true}]"),
              HasSubstr("missing key \"to_s\""));
  EXPECT_THAT(Refusal("injection_seed: -1"), HasSubstr("injection_seed: found -1"));
}

TEST(Injections, OnThePlcsWireOnlyFaultsOfTcpAreAccepted) {
  for (const char* key : {"duplicate_ratio: 0.1", "reorder_ratio: 0.1", "corrupt_ratio: 0.1"})
    EXPECT_THAT(Refusal(OneInjection(key, "plc")), HasSubstr("which is TCP"));
  EXPECT_THAT(Refusal(OneInjection("silence: true", "plc", "to_controller")), HasSubstr("accepted both"));
  EXPECT_EQ(Refusal(OneInjection("loss_ratio: 1", "plc")), "accepted");
}

}  // namespace
}  // namespace osteon::config
