#include "studies/sweep/sweep_run.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "config/reading/load_sweep.h"
#include "config/reading/strict/config_error.h"
#include "studies/sweep/sweep_result.h"
#include "tests/io/temporary_folder.h"

namespace osteon::studies {
namespace {

class Sweep : public testing::Test {
 protected:
  // Loads a sweep of these parameters (YAML) over a shipped scenario.
  config::SweepConfig LoadSweepOf(const std::string& parameters, int seeds) {
    io::test::WriteAll(folder_.path() / "s.yaml", "shows: x\nscenario: " OSTEON_SOURCE_DIR
                                                  "/config/scenarios/tremor.yaml\nseed_count: " +
                                                      std::to_string(seeds) + "\nparameters:\n" + parameters);
    return config::LoadSweep(folder_.path() / "s.yaml");
  }
  // Expects that loading is refused with this text.
  void ExpectRefused(const std::string& parameters, int seeds, const std::string& text) {
    try {
      LoadSweepOf(parameters, seeds);
      ADD_FAILURE() << parameters;
    } catch (const config::ConfigError& error) {
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
  }
  io::test::TemporaryFolder folder_;
};

TEST_F(Sweep, HasEachCombinationWithEachSeedOnce) {
  const auto sweep = LoadSweepOf(
      "  - {key: a, takes: \"1, 2, 3\"}\n  - {key: b, takes: 0 to 1 in 5 steps}\n  - {key: s, takes: seed}\n",
      4);
  EXPECT_EQ(sweep.Combinations(), 15u);
  ASSERT_EQ(sweep.Runs(), 60u);
  std::set<std::vector<std::string>> all;
  for (std::size_t i = 0; i < sweep.Runs(); ++i) {
    const SweepRun run = SweepRunAt(sweep, i);
    EXPECT_EQ(run.values[2], std::to_string(run.seed));
    all.insert(run.values);
  }
  EXPECT_EQ(all.size(), 60u);
  EXPECT_EQ(AssignmentsOf(sweep, SweepRunAt(sweep, 59)), (std::vector<std::string>{"a=3", "b=1", "s=4"}));
  std::set<std::string> seen;
  for (const std::size_t i : RunsWithEachValue(sweep))
    for (const std::string& assignment : AssignmentsOf(sweep, SweepRunAt(sweep, i))) seen.insert(assignment);
  for (const char* value : {"a=1", "a=2", "a=3", "b=0", "b=0.25", "b=0.5", "b=0.75", "b=1"})
    EXPECT_TRUE(seen.contains(value)) << value;
}

// Random draws depend only on their key and the seed. All combinations are therefore compared with equal
// draws, even after a parameter is added.
TEST_F(Sweep, ADrawDependsOnlyOnItsKeyAndTheSeed) {
  const auto one = LoadSweepOf("  - {key: u, takes: uniform 2 to 4}\n", 8);
  const auto more = LoadSweepOf("  - {key: a, takes: \"1, 2\"}\n  - {key: u, takes: uniform 2 to 4}\n", 8);
  for (std::size_t i = 0; i < more.Runs(); ++i)
    EXPECT_EQ(SweepRunAt(more, i).values[1], SweepRunAt(one, i % 8).values[0]);
}

// Mean and standard deviation of 20 000 draws must lie within four standard errors.
TEST_F(Sweep, DrawsHaveTheirDistributions) {
  const auto sweep =
      LoadSweepOf("  - {key: u, takes: uniform 2 to 4}\n  - {key: n, takes: normal -1 sd 0.5}\n", 20'000);
  double sum[2]{}, squares[2]{};
  for (std::size_t i = 0; i < sweep.Runs(); ++i) {
    const SweepRun run = SweepRunAt(sweep, i);
    for (std::size_t p = 0; p < 2; ++p) {
      const double value = std::stod(run.values[p]);
      if (p == 0) {
        EXPECT_TRUE(value > 2.0 && value <= 4.0) << value;
      }
      sum[p] += value;
      squares[p] += value * value;
    }
  }
  const double count = static_cast<double>(sweep.Runs());
  const double mean[2]{3.0, -1.0}, sd[2]{2.0 / std::sqrt(12.0), 0.5};
  for (std::size_t p = 0; p < 2; ++p) {
    const double found = sum[p] / count;
    EXPECT_NEAR(found, mean[p], 4.0 * sd[p] / std::sqrt(count));
    EXPECT_NEAR(std::sqrt(squares[p] / count - found * found), sd[p], 4.0 * sd[p] / std::sqrt(2.0 * count));
  }
}

TEST_F(Sweep, RefusesInvalidFilesNamingTheWrongEntry) {
  ExpectRefused("  - {key: a, takes: uniform 4 to 2}\n", 2,
                "takes: found \"uniform 4 to 2\", accepted a list");
  ExpectRefused("  - {key: a, takes: normal 4 sd 0}\n", 2, "found \"normal 4 sd 0\"");
  ExpectRefused("  - {key: a, takes: 1 to 2 in 1 steps}\n", 1, "found \"1 to 2 in 1 steps\"");
  ExpectRefused("  - {key: a, takes: \"1,,2\"}\n", 1, "found \"1,,2\"");
  ExpectRefused("  - {key: a, takes: \"1, 2\"}\n", 3, "seed_count: found 3, accepted 1");
  ExpectRefused("  - {key: a, takes: seed}\n  - {key: a, takes: seed}\n", 3, "found a twice");
  ExpectRefused("  - {key: a}\n", 1, "takes");
  ExpectRefused("  - {key: a, takes: 0 to 1 in 10000 steps}\n  - {key: b, takes: 0 to 1 in 10000 steps}\n", 1,
                "found 100000000 runs");
}

TEST_F(Sweep, QuantilesAreByNearestRank) {
  std::vector<double> values;
  for (int i = 100; i >= 1; --i) values.push_back(i);
  const Quantiles q = QuantilesOf(values);
  EXPECT_EQ(q.min, 1.0);
  EXPECT_EQ(q.p05, 5.0);
  EXPECT_EQ(q.median, 50.0);
  EXPECT_EQ(q.p95, 95.0);
  EXPECT_EQ(q.max, 100.0);
  EXPECT_EQ(QuantilesOf({7.0}).p95, 7.0);
}

}  // namespace
}  // namespace osteon::studies
