#include <cmath>

#include "config/reading/load.h"
#include "tests/fuzz/targets/config_claims.h"

// Fuzz target: a tool's YAML file. Fitting balls to the tool takes most of the time, so only few inputs can
// be run.

namespace osteon::fuzz {
namespace {

void ClaimTool(const config::ToolConfig& tool) {
  Claim(!tool.tool.balls.empty(), "a tool has balls");
  for (const simulation::ToolBall& ball : tool.tool.balls)
    Claim(Vector3(ball.center_m).allFinite() && ball.radius_m > 0.0 && ball.radius_m < 1.0,
          "a ball has a place and a size");
  Claim(tool.tool.mass_kg > 0.0 && Vector3(tool.tool.center_of_mass_m).allFinite(), "a tool has a mass");
  Claim(tool.spindle_rad_per_s > 0.0 && tool.X_FT.matrix().allFinite(), "and a speed and a place");
}

}  // namespace
}  // namespace osteon::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace osteon;
  const fuzz::YamlInput input(data, size);
  if (const auto tool = input.Read([](const auto& path) { return config::LoadTool(path); }))
    fuzz::ClaimTool(*tool);
  return 0;
}
