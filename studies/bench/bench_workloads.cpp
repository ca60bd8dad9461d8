#include "studies/bench/bench_workloads.h"

#include <algorithm>

namespace osteon::studies {
namespace {

constexpr const char* kAll = "all";  // the name that selects every workload

}  // namespace

const std::vector<std::string>& BenchWorkloadNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all{kAll};
    for (const BenchWorkload& workload : kBenchWorkloads) all.emplace_back(workload.name);
    return all;
  }();
  return names;
}

std::vector<BenchWorkload> SelectWorkloads(const std::vector<std::string>& names) {
  const auto named = [&](const std::string& name) { return std::ranges::count(names, name) > 0; };
  std::vector<BenchWorkload> selected;
  for (const BenchWorkload& workload : kBenchWorkloads)
    if (named(kAll) || named(workload.name)) selected.push_back(workload);
  return selected;
}

}  // namespace osteon::studies
