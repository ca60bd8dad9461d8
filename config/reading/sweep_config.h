#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace osteon::config {

/// How the values of a parameter are chosen.
enum class SweepDraw : std::uint8_t {
  kListed,   ///< each of `values`, combined with each value of the other listed parameters
  kUniform,  ///< between low and high, drawn for each seed
  kNormal,   ///< about mean, with standard deviation sd, drawn for each seed
  kSeed,     ///< the value is the number of the seed
};

/// A value of the scenario's cell that a sweep changes.
struct SweepParameter {
  std::string key;  ///< key as in a scenario's overrides: "coupling.stiffness_N_per_mm"
  SweepDraw draw{SweepDraw::kListed};
  std::vector<std::string> values{};  ///< only for kListed
  double low{0.0}, high{0.0};         ///< only for kUniform
  double mean{0.0}, sd{0.0};          ///< only for kNormal
};

/// A sweep with more runs is refused.
inline constexpr std::size_t kMaxSweepRuns = 1'000'000;

/// A Monte-Carlo study of `osteon regress --sweep`: a scenario with each combination of listed values, and
/// `seeds` draws of each combination.
struct SweepConfig {
  std::filesystem::path file;
  std::string name;   ///< of the file, without its extension
  std::string shows;  ///< what the sweep shows, in one line
  std::filesystem::path scenario;
  int seeds{1};
  std::vector<SweepParameter> parameters;

  /// Number of combinations of the listed values.
  [[nodiscard]] std::size_t Combinations() const {
    std::size_t count = 1;
    for (const SweepParameter& parameter : parameters)
      if (parameter.draw == SweepDraw::kListed) count *= parameter.values.size();
    return count;
  }
  /// Number of runs: each combination with each seed.
  [[nodiscard]] std::size_t Runs() const { return Combinations() * static_cast<std::size_t>(seeds); }
};

}  // namespace osteon::config
