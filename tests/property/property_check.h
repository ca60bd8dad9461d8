#pragma once

#include <rapidcheck.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

// Runs rapidcheck for this folder: a fixed seed per shard, a number of cases, and the smallest failing case
// as GoogleTest's failure. OSTEON_PROPERTY_CASES overrides the number of cases of each property,
// OSTEON_PROPERTY_SEED the seed.

namespace osteon::property {

/// Returns the number in an environment variable, at least 1; `fallback` if the variable is not set.
inline long long FromEnvironment(const char* name, long long fallback) {
  const char* wanted = std::getenv(name);
  return wanted ? std::max(1ll, std::atoll(wanted)) : fallback;
}

/// Runs one shard of a property's cases: ctest runs the shards in parallel.
/// @param holds  the property: a function of generated arguments that fails by RC_ASSERT
template <typename Property>
void CheckShard(int shard, int shards, long long cases, const Property& holds) {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  rc::detail::TestMetadata metadata;
  metadata.id = std::string(test->test_suite_name()) + "/" + test->name();
  metadata.description = test->name();
  rc::detail::TestParams params;
  params.seed = static_cast<std::uint64_t>(FromEnvironment("OSTEON_PROPERTY_SEED", 20261123)) * 1000 +
                static_cast<std::uint64_t>(shard);
  params.maxSuccess =
      static_cast<int>((FromEnvironment("OSTEON_PROPERTY_CASES", cases) + shards - 1) / shards);
  const auto result = rc::detail::checkTestable(holds, metadata, params);
  if (result.template is<rc::detail::SuccessResult>()) return;
  std::ostringstream text;
  rc::detail::printResultMessage(result, text);
  FAIL() << "seed " << params.seed << ", " << params.maxSuccess << " cases\n" << text.str();
}

}  // namespace osteon::property
