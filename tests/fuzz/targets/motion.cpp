#include <cmath>

#include "simulation/tools/tool_motion.h"
#include "tests/fuzz/targets/file_claims.h"

// Fuzz target: a recorded tool motion. The input is the text of the CSV file.

namespace osteon::fuzz {
namespace {

void ClaimAccepted(const simulation::ToolMotion& motion) {
  Claim(motion.samples.size() >= 2 && motion.samples.size() <= simulation::kMaxMotionRows,
        "a motion has 2 … 200000 rows");
  Claim(motion.samples.front().time_s == 0.0, "the first at time 0");
  double before_s = -1.0;
  for (const simulation::MotionSample& sample : motion.samples) {
    Claim(sample.time_s > before_s && sample.time_s <= 36000.0, "times ascend, up to 10 h");
    before_s = sample.time_s;
    Claim(sample.p_GT_m.cwiseAbs().maxCoeff() <= 10.0 + 1e-12, "positions are within 10 m");
    Claim(std::abs(sample.R_GT.norm() - 1.0) <= 1e-12, "a rotation has length 1");
    Claim(sample.spindle_rad_per_s >= 0.0 && sample.spindle_rad_per_s <= 52'400.0, "the spindle is in range");
  }
}

}  // namespace
}  // namespace osteon::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace osteon;
  const std::string name = "fuzz.csv";
  const std::string text = fuzz::Text({data, size});
  const auto motion = simulation::ParseMotion(text, name);
  if (!motion) {
    fuzz::Claim(motion.error().starts_with(name + ":"), "an error names the file");
    fuzz::Claim(motion.error().find("accepted") != std::string::npos, "and what is accepted");
    if (!motion.error().starts_with(name + ": ")) fuzz::ClaimNamesLine(motion.error(), name, text);
    return 0;
  }
  fuzz::ClaimAccepted(*motion);
  // writing rounds the values to the file's last digit, so the written text may be refused. If it is
  // accepted, writing it again must not change it
  const std::string written = simulation::MotionText(*motion);
  const auto rounded = simulation::ParseMotion(written, name);
  if (rounded) fuzz::Claim(simulation::MotionText(*rounded) == written, "what was read can be written");
  return 0;
}
