#include <cmath>
#include <cstdlib>

#include "config/reading/load_scenario.h"
#include "config/reading/load_sweep.h"
#include "tests/fuzz/targets/config_claims.h"

// Fuzz target: a scenario of `osteon regress`, and a sweep over a scenario. The input is read as both.

namespace osteon::fuzz {
namespace {

void ClaimScenario(const config::ScenarioConfig& scenario) {
  Claim(scenario.seconds > 0.0 && scenario.frame_s > 0.0 && scenario.sample_s > 0.0, "times are positive");
  Claim(scenario.seconds / scenario.sample_s < 1e7, "a trace has a size that a file can have");
  Claim(scenario.recoveries >= 0, "a count is not negative");
  if (scenario.guidance) Claim(*scenario.guidance >= 0.0 && *scenario.guidance <= 1.0, "a gain is a share");
}

void ClaimSweep(const config::SweepConfig& sweep) {
  Claim(sweep.seeds >= 1 && sweep.Runs() <= config::kMaxSweepRuns, "the runs can be counted");
  for (const config::SweepParameter& parameter : sweep.parameters) {
    for (const std::string& value : parameter.values) {
      Claim(!value.empty(), "a listed value is a word");
      if (parameter.values.size() > 1) {
        char* end = nullptr;
        const double number = std::strtod(value.c_str(), &end);
        const bool is_number = *end == '\0' && value.find_first_of("nN") == std::string::npos;
        if (is_number) Claim(std::isfinite(number), "and a number is finite");
      }
    }
    if (parameter.draw == config::SweepDraw::kUniform)
      Claim(std::isfinite(parameter.high - parameter.low) && parameter.high > parameter.low,
            "a range is one");
    if (parameter.draw == config::SweepDraw::kNormal) Claim(parameter.sd > 0.0, "a deviation is positive");
  }
}

}  // namespace
}  // namespace osteon::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace osteon;
  const fuzz::YamlInput input(data, size);
  if (const auto scenario = input.Read(config::LoadScenario)) fuzz::ClaimScenario(*scenario);
  if (const auto sweep = input.Read(config::LoadSweep)) fuzz::ClaimSweep(*sweep);
  return 0;
}
