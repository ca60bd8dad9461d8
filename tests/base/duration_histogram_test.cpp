#include "base/duration_histogram.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace osteon::rt {
namespace {

TEST(DurationHistogram, EveryValueLiesInItsBin) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> exponent(0.0, 10.0);
  for (int i = 0; i < 100'000; ++i) {
    const auto value = static_cast<Nanoseconds>(std::pow(10.0, exponent(random)));
    const int bin = DurationHistogram::BinOf(value);
    ASSERT_LE(DurationHistogram::LowerEdge(bin), value);
    ASSERT_GT(DurationHistogram::LowerEdge(bin + 1), value);
  }
}

// Oracle: the quantiles of the sorted values.
TEST(DurationHistogram, QuantilesAreWithinHalfAPercentOfTheSortedValues) {
  std::mt19937_64 random(5);
  std::lognormal_distribution<double> lognormal(std::log(50e3), 1.0);
  DurationHistogram histogram;
  std::vector<Nanoseconds> values;
  for (int i = 0; i < 50'000; ++i) {
    values.push_back(static_cast<Nanoseconds>(lognormal(random)));
    histogram.Add(values.back());
  }
  std::sort(values.begin(), values.end());
  for (const double share : {0.01, 0.5, 0.99, 0.999}) {
    const auto exact = static_cast<double>(values[static_cast<std::size_t>(share * 50'000.0) - 1]);
    EXPECT_NEAR(static_cast<double>(histogram.Quantile(share)), exact, 0.005 * exact) << share;
  }
  EXPECT_EQ(histogram.max(), values.back());
  EXPECT_EQ(histogram.count(), 50'000u);
}

TEST(DurationHistogram, ValuesBeyondTheBinsCountInTheFirstAndLastBin) {
  DurationHistogram histogram;
  EXPECT_EQ(histogram.Quantile(0.5), 0) << "empty";
  histogram.Add(-5);
  histogram.Add(std::numeric_limits<Nanoseconds>::max());
  EXPECT_EQ(histogram.bins().front(), 1u);
  EXPECT_EQ(histogram.bins().back(), 1u);
  EXPECT_EQ(histogram.max(), std::numeric_limits<Nanoseconds>::max());
}

}  // namespace
}  // namespace osteon::rt
