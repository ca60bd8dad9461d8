#include "safety/fault.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

namespace osteon::safety {
namespace {

TEST(FaultText, EveryFaultHasItsOwnNameCauseReactionAndClearing) {
  std::set<std::string> names;
  for (int bit = 0; bit < kFaultCount; ++bit) {
    const FaultText text = Describe(static_cast<Fault>(1u << bit));
    EXPECT_TRUE(names.insert(text.name).second) << text.name << " twice";
    EXPECT_NE(std::string(text.name), "unknown fault") << "bit " << bit;
    EXPECT_GT(std::string(text.cause).size(), 5u);
    EXPECT_GT(std::string(text.reaction).size(), 5u);
    EXPECT_GT(std::string(text.clearing).size(), 5u);
  }
}

TEST(FaultText, ABitBeyondTheLastFaultIsUnknown) {
  EXPECT_EQ(std::string(Describe(static_cast<Fault>(1u << kFaultCount)).name), "unknown fault");
}

TEST(FaultSet, StaysLatchedUntilCleared) {
  FaultSet faults, other;
  EXPECT_FALSE(faults.Any());
  faults.Latch(Fault::kModelStale);
  other.Latch(Fault::kWorkspace);
  faults.Latch(other);
  EXPECT_TRUE(faults.Has(Fault::kModelStale));
  EXPECT_TRUE(faults.Has(Fault::kWorkspace));
  EXPECT_FALSE(faults.Has(Fault::kArmStale));
  faults.Clear();
  EXPECT_EQ(faults.bits(), 0u);
}

}  // namespace
}  // namespace osteon::safety
