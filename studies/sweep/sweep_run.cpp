#include "studies/sweep/sweep_run.h"

#include <cmath>
#include <cstdint>
#include <numbers>

#include <fmt/format.h>

#include "base/fnv1a.h"

namespace osteon::studies {
namespace {

using config::SweepDraw, config::SweepParameter;

// Random numbers from a counter (Steele, Lea, Flood: Fast Splittable Pseudorandom Number Generators, OOPSLA
// 2014).
class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t state) : state_(state) {}
  // Returns a uniformly distributed number, above 0 and at most 1.
  double Next() {
    state_ += 0x9e3779b97f4a7c15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (static_cast<double>((z ^ (z >> 31)) >> 11) + 1.0) * 0x1p-53;
  }

 private:
  std::uint64_t state_;
};

// Draws a parameter's value for a seed, as text. It depends only on the parameter's key and the seed.
std::string DrawnValue(const SweepParameter& parameter, int seed) {
  if (parameter.draw == SweepDraw::kSeed) return std::to_string(seed);
  base::Fnv1a hash;
  hash.Add(parameter.key);
  hash.AddWord(static_cast<std::uint64_t>(seed));
  SplitMix64 random(hash.hash());
  const double first = random.Next(), second = random.Next();
  if (parameter.draw == SweepDraw::kUniform)
    return fmt::format("{:.10g}", parameter.low + (parameter.high - parameter.low) * first);
  // normally distributed number by Box and Muller, 1958
  const double normal = std::sqrt(-2.0 * std::log(first)) * std::cos(2.0 * std::numbers::pi * second);
  return fmt::format("{:.10g}", parameter.mean + parameter.sd * normal);
}

}  // namespace

SweepRun SweepRunAt(const config::SweepConfig& sweep, std::size_t index) {
  const auto seeds = static_cast<std::size_t>(sweep.seeds);
  SweepRun run{.index = index,
               .combination = index / seeds,
               .seed = static_cast<int>(index % seeds) + 1,
               .values = std::vector<std::string>(sweep.parameters.size())};
  // The index of the combination is a number whose digits are the indices of the listed values. The last
  // listed parameter is the last digit, which changes fastest.
  std::size_t rest = run.combination;
  for (std::size_t i = sweep.parameters.size(); i-- > 0;) {
    const SweepParameter& parameter = sweep.parameters[i];
    if (parameter.draw != SweepDraw::kListed) {
      run.values[i] = DrawnValue(parameter, run.seed);
      continue;
    }
    run.values[i] = parameter.values[rest % parameter.values.size()];
    rest /= parameter.values.size();
  }
  return run;
}

std::vector<std::string> AssignmentsOf(const config::SweepConfig& sweep, const SweepRun& run) {
  std::vector<std::string> assignments;
  for (std::size_t i = 0; i < run.values.size(); ++i)
    assignments.push_back(sweep.parameters[i].key + "=" + run.values[i]);
  return assignments;
}

std::vector<std::size_t> RunsWithEachValue(const config::SweepConfig& sweep) {
  std::vector<std::size_t> runs{0};
  // distance of the runs for two successive values of a parameter, with all other parameters at their first
  // value
  auto stride = static_cast<std::size_t>(sweep.seeds);
  for (std::size_t i = sweep.parameters.size(); i-- > 0;) {
    const std::size_t count = sweep.parameters[i].values.size();
    if (sweep.parameters[i].draw != SweepDraw::kListed) continue;
    for (std::size_t value = 1; value < count; ++value) runs.push_back(value * stride);
    stride *= count;
  }
  return runs;
}

}  // namespace osteon::studies
