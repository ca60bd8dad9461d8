#include <gtest/gtest.h>

#include "io/modbus/plc_reading.h"

// The register map: registers 970 … 983 become PlcInputs, and Judge() derives whether the arm may move.

namespace osteon::io {
namespace {

using Block = std::array<std::uint16_t, kPlcReadCount>;

// 970 …: T2, 0, 0, no brake test, run, 0, 0, version 3, no stop, enabled, pedal, spindle, power, heartbeat
constexpr Block kGood{2, 0, 0, 0, 1, 0, 0, 3, 0, 1, 1, 1, 1, 4711};

TEST(PlcMap, ReadsEachRegisterFromItsAddress) {
  PlcInputs inputs;
  ASSERT_FALSE(DecodePlc(kGood, inputs));
  EXPECT_EQ(inputs.mode, PlcMode::kT2);
  EXPECT_EQ(inputs.enabling, PlcEnabling::kEnabled);
  EXPECT_TRUE(inputs.run_permitted && inputs.foot_pedal && inputs.spindle_permitted && inputs.power_on);
  EXPECT_FALSE(inputs.emergency_stop || inputs.brake_test_requested);
  EXPECT_EQ(inputs.heartbeat, 4711);

  // if one register alone is 1, one field alone is true
  struct Row {
    std::size_t offset;
    bool PlcInputs::*field;
  };
  for (const Row& row : {Row{3, &PlcInputs::brake_test_requested}, Row{4, &PlcInputs::run_permitted},
                         Row{8, &PlcInputs::emergency_stop}, Row{10, &PlcInputs::foot_pedal},
                         Row{11, &PlcInputs::spindle_permitted}, Row{12, &PlcInputs::power_on}}) {
    Block block{};
    block[7] = 3;
    block[row.offset] = 1;
    ASSERT_FALSE(DecodePlc(block, inputs));
    for (bool PlcInputs::*field :
         {&PlcInputs::brake_test_requested, &PlcInputs::run_permitted, &PlcInputs::emergency_stop,
          &PlcInputs::foot_pedal, &PlcInputs::spindle_permitted, &PlcInputs::power_on})
      EXPECT_EQ(inputs.*field, field == row.field) << 970 + row.offset;
  }
}

TEST(PlcMap, RefusesValuesOutOfRange) {
  for (const auto& [offset, most] :
       {std::pair{0, 3}, {3, 1}, {4, 1}, {8, 1}, {9, 2}, {10, 1}, {11, 1}, {12, 1}})
    for (const int value : {most + 1, 0xffff}) {
      Block block = kGood;
      block[static_cast<std::size_t>(offset)] = static_cast<std::uint16_t>(value);
      PlcInputs inputs;
      const auto bad = DecodePlc(block, inputs);
      ASSERT_TRUE(bad) << 970 + offset;
      EXPECT_EQ(bad->address, 970 + offset);
      EXPECT_EQ(bad->found, value);
      EXPECT_EQ(bad->accepted_most, most);
      EXPECT_FALSE(inputs.run_permitted) << "unchanged";
    }
}

// Registers of an unknown version are not interpreted: the inputs stay at their safe defaults.
TEST(PlcMap, OfAnotherVersionReadsOnlyTheVersion) {
  Block block = kGood;
  block[7] = 2;
  block[0] = 999;
  PlcInputs inputs;
  ASSERT_FALSE(DecodePlc(block, inputs));
  EXPECT_EQ(inputs.version, 2);
  EXPECT_FALSE(inputs.run_permitted || inputs.power_on);
  EXPECT_TRUE(inputs.emergency_stop);
}

// A good reading with the stamp 1000 ms is judged at 1050 ms; the accepted age is 60 ms. Each change of one
// condition gives one verdict.
TEST(PlcMap, EachConditionGivesItsVerdict) {
  const auto verdict = [](auto change) {
    PlcReading reading{.stamp = 1000 * rt::kMillisecond, .link = PlcLink::kConnected};
    EXPECT_FALSE(DecodePlc(kGood, reading.inputs));
    reading.heartbeat_changed = reading.stamp;
    change(reading);
    return Judge(reading, 1050 * rt::kMillisecond, 60 * rt::kMillisecond);
  };
  EXPECT_EQ(verdict([](auto&) {}), PlcVerdict::kRun);
  EXPECT_EQ(Judge(PlcReading{}, 0, rt::kSecond), PlcVerdict::kNoConnection);
  EXPECT_EQ(verdict([](auto& r) { r.link = PlcLink::kConnecting; }), PlcVerdict::kNoConnection);
  EXPECT_EQ(verdict([](auto& r) { r.link = PlcLink::kWrongVersion; }), PlcVerdict::kWrongVersion);
  EXPECT_EQ(verdict([](auto& r) { r.stamp -= 20 * rt::kMillisecond; }), PlcVerdict::kStale);
  EXPECT_EQ(verdict([](auto& r) { r.heartbeat_changed -= 80 * rt::kMillisecond; }), PlcVerdict::kPlcStopped);
  EXPECT_EQ(verdict([](auto& r) { r.inputs.emergency_stop = true; }), PlcVerdict::kEmergencyStop);
  EXPECT_EQ(verdict([](auto& r) { r.inputs.run_permitted = false; }), PlcVerdict::kNotPermitted);
}

}  // namespace
}  // namespace osteon::io
