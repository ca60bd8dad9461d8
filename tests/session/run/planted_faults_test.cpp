// Five faults, each planted in a run of a whole cell. The console, `osteon status`, the stop's page and the
// summary must name the measured value, the cell's reaction and how to clear the fault, so that nobody needs
// a manual.

#include <fstream>
#include <functional>
#include <ostream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/read_text.h"
#include "io/recording/recording_reader.h"
#include "report/svg_text.h"
#include "safety/fault.h"
#include "session/run/live_views.h"
#include "session/stops/stop_records.h"
#include "tests/session/run/virtual_run.h"

namespace osteon::session {
namespace {

using safety::Fault;
using testing::HasSubstr;

// A fault, how it is planted, and a part of the text that describes the measured value.
struct Planted {
  const char* name;
  Fault fault;
  std::function<void(config::CellConfig&)> plant;
  const char* seen;
};
void PrintTo(const Planted& planted, std::ostream* out) { *out << planted.name; }

// Silences the devices on a wire from 2 s on.
std::function<void(config::CellConfig&)> Silence(hil::Wire wire) {
  return [wire](config::CellConfig& cell) {
    cell.injections.injections = {{.wire = wire, .from_s = 2.0, .faults = {.silence = true}}};
  };
}

class PlantedFault : public testing::TestWithParam<Planted> {};

TEST_P(PlantedFault, IsShownWithItsMeasuredValueReactionAndClearing) {
  const Planted& planted = GetParam();
  auto setup = SetUpCell(OSTEON_SOURCE_DIR "/config/cells/thin_plate.yaml", std::nullopt);
  ASSERT_TRUE(setup) << setup.error();
  planted.plant(setup->config);
  auto engine = MakeEngine(*setup, {});
  ASSERT_TRUE(engine) << engine.error();
  const io::test::TemporaryFolder folder;
  const std::filesystem::path recording = folder.path() / "r.mcap";
  base::OperatorRequests requests;
  LiveViews live(*setup, {.command = "run", .seconds = 4.0, .recording = recording.string()}, requests);
  const CellRunParams params{
      .seconds = 4.0, .virtual_time = true, .recording = recording, .live = live.sink()};
  const auto result = RunCell(*setup, **engine, params);
  ASSERT_TRUE(result) << result.error().what;
  ASSERT_TRUE(result->faults.Has(planted.fault)) << result->faults.bits();

  // The console and `osteon status` show the same JSON, which is read here.
  const auto status = nlohmann::json::parse(live.Answer("status")).at("status");
  const safety::FaultText text = safety::Describe(planted.fault);
  nlohmann::json card;
  for (const nlohmann::json& fault : status.at("faults"))
    if (fault.at("name") == text.name) card = fault;
  ASSERT_TRUE(card.is_object()) << status.at("faults");
  EXPECT_EQ(card.at("cause"), text.cause);
  EXPECT_EQ(card.at("reaction"), text.reaction);
  EXPECT_EQ(card.at("clearing"), text.clearing);
  EXPECT_THAT(card.at("seen").get<std::string>(), HasSubstr(planted.seen));

  // The JSON must state the right path of the stop's page.
  StopPages stops({.folder = folder.path(), .stem = "r", .cell = setup->config, .recording = recording});
  const auto run = ReadRun(recording, *setup, stops, nullptr);
  ASSERT_TRUE(run) << run.error();
  const auto pages = stops.Finish();
  ASSERT_TRUE(pages) << pages.error();
  ASSERT_FALSE(pages->empty());
  EXPECT_EQ(card.at("page"), pages->front().page.string());
  const std::string page = base::ReadText(pages->front().page);
  for (const char* part : {text.name, text.reaction, text.clearing, planted.seen})
    EXPECT_THAT(page, HasSubstr(report::Escape(part)));

  // the terminal's summary
  std::string rows;
  for (const report::SummaryRow& row : Rows(Summarise(*setup, **engine, params, *result, *run)))
    rows += row.key + ": " + row.value + "\n";
  EXPECT_THAT(rows, HasSubstr(text.name));
  EXPECT_THAT(rows, HasSubstr(text.clearing));
}

INSTANTIATE_TEST_SUITE_P(
    Five, PlantedFault,
    testing::Values(Planted{"arm_silent", Fault::kArmStale, Silence(hil::Wire::kArm), "deadlines in a row"},
                    Planted{"sensor_silent", Fault::kSensorStale, Silence(hil::Wire::kForceSensor), "ms old"},
                    Planted{"drive_silent", Fault::kSpindle, Silence(hil::Wire::kDrive), "ms old"},
                    Planted{"plc_silent", Fault::kInterlock, Silence(hil::Wire::kPlc), "PLC"},
                    Planted{"hand_too_hard", Fault::kForceLimit,
                            [](config::CellConfig& cell) {
                              cell.servo.wrench.max_force_N = 20.0;
                              cell.servo.on_force_limit.reaction = safety::OnForceLimit::kStop;
                            },
                            "N asked of the coupling, accepted 20 N"}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace osteon::session
