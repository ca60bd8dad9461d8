#include "base/percentile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace osteon::base {
namespace {

// The whole numbers from `from` down to 1.
std::vector<double> Falling(int from) {
  std::vector<double> values;
  for (int i = from; i >= 1; --i) values.push_back(i);
  return values;
}

TEST(Percentile, IsTheNearestRank) {
  std::vector<double> values = Falling(1000);
  EXPECT_EQ(Percentile(values, 0.5), 500.0);
  EXPECT_EQ(Percentile(values, 0.999), 999.0);
  EXPECT_EQ(Percentile(values, 1.0), 1000.0);
  EXPECT_EQ(Percentile(values, 0.0), 1.0);
  EXPECT_TRUE(std::isnan(Percentile({}, 0.5)));
}

TEST(LowerPercentile, IsTheRankBelowTheShareOfTheRange) {
  std::vector<double> values = Falling(10);
  EXPECT_EQ(LowerPercentile(values, 0.95), 9.0) << "where the nearest rank is the 10th";
  EXPECT_EQ(LowerPercentile(values, 0.0), 1.0);
  EXPECT_EQ(LowerPercentile(values, 1.0), 10.0);
  EXPECT_EQ(LowerPercentile({}, 0.5), 0.0);
}

TEST(Median, IsTheLargerOfTheTwoInTheMiddle) {
  std::vector<double> even = Falling(4), odd = Falling(5);
  EXPECT_EQ(Median(even), 3.0);
  EXPECT_EQ(Median(odd), 3.0);
  EXPECT_EQ(Median({}), 0.0);
}

}  // namespace
}  // namespace osteon::base
