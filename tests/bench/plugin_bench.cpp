// Times the two calls that a haptic device's loop makes through the C interface, while an engine reams in
// another thread. For comparison, times a computation of about the same duration that uses no memory. The
// computation's longest time shows how much the machine itself delays a thread.
//
//     osteon_plugin_bench [SECONDS] > plugin.json

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/clock.h"
#include "base/realtime_thread.h"
#include "plugin/include/osteon.h"

namespace {

// Prints the library's last error and exits with 1 if a call has failed.
void Check(OsteonResult result) {
  if (result >= OSTEON_OK) return;
  (void)std::fprintf(stderr, "%s\n", osteon_last_error());
  std::exit(1);
}

double Quantile(const std::vector<double>& sorted, double share) {
  return sorted[std::min(sorted.size() - 1,
                         static_cast<std::size_t>(share * static_cast<double>(sorted.size())))];
}

constexpr int kRoots = 400;  // about 2 us of computation

// A chain of square roots, each taken of the previous result. The computation uses neither memory nor another
// thread.
double ChainOfRoots(double x) {
  for (int i = 0; i < kRoots; ++i) x = std::sqrt(x + 1.0);
  return x;
}

std::string TimesJson(std::vector<double> times_us) {
  std::sort(times_us.begin(), times_us.end());
  return fmt::format(R"({{"p50": {:.3f}, "p99": {:.3f}, "p99_9": {:.3f}, "max": {:.3f}}})",
                     Quantile(times_us, 0.5), Quantile(times_us, 0.99), Quantile(times_us, 0.999),
                     times_us.back());
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 10.0;
  OsteonBoneParams bone_params;
  OsteonToolParams tool_params;
  osteon_bone_params_default(&bone_params);
  osteon_tool_params_default(&tool_params);
  OsteonBone* bone = nullptr;
  OsteonTool* tool = nullptr;
  OsteonSession* session = nullptr;
  Check(osteon_bone_create(OSTEON_ABI, &bone_params, &bone));
  Check(osteon_tool_create(OSTEON_ABI, &tool_params, &tool));
  Check(osteon_session_create(OSTEON_ABI, bone, tool, nullptr, &session));
  const double spindle = osteon_tool_spindle_rad_per_s(tool);

  OsteonPose pose;
  Check(osteon_bone_approach(bone, -0.016, &pose));
  OsteonFigures figures{};
  while (figures.frame == 0) {  // until the engine has computed a frame
    Check(osteon_session_set_tool_pose(session, &pose, spindle));
    osteon::rt::SleepUntil(osteon::rt::MonotonicNow() + 1'000'000);
    Check(osteon_session_figures(session, &figures));
  }
  const std::size_t ticks = static_cast<std::size_t>(1000.0 * seconds);
  std::vector<double> call_us, machine_us;
  call_us.reserve(ticks);
  machine_us.reserve(ticks);
  double largest_N = 0.0, root = 0.0;
  osteon::rt::RaisePriority();  // the same priority as a device's thread has
  osteon::rt::Nanoseconds due = osteon::rt::MonotonicNow();
  for (std::size_t i = 0; i < ticks; ++i) {
    osteon::rt::SleepUntil(due += 1'000'000);
    // moves down during the run: to the cup's floor and 1 mm into it
    Check(osteon_bone_approach(bone, -0.016 - 0.009 * static_cast<double>(i) / static_cast<double>(ticks),
                               &pose));
    OsteonWrench wrench;
    const osteon::rt::Nanoseconds start = osteon::rt::MonotonicNow();
    const OsteonResult set = osteon_session_set_tool_pose(session, &pose, spindle);
    const OsteonResult evaluated = osteon_session_evaluate(session, &pose, nullptr, &wrench);
    const osteon::rt::Nanoseconds between = osteon::rt::MonotonicNow();
    root = ChainOfRoots(root);
    machine_us.push_back(1e-3 * static_cast<double>(osteon::rt::MonotonicNow() - between));
    call_us.push_back(1e-3 * static_cast<double>(between - start));
    Check(set);
    Check(evaluated);
    largest_N = std::max(largest_N, std::hypot(wrench.force_N[0], wrench.force_N[1], wrench.force_N[2]));
  }
  Check(osteon_session_figures(session, &figures));
  fmt::print(
      "{{\"engine\": \"{}\", \"calls\": {}, \"frames\": {}, \"call_us\": {}, \"machine_us\": {}, "
      "\"peak_force_N\": {:.2f}, \"removed_volume_mm3\": {:.1f}, \"root\": {:.3f}}}\n",
      osteon_session_engine(session), call_us.size(), figures.frame, TimesJson(call_us),
      TimesJson(machine_us), largest_N, 1e9 * figures.removed_volume_m3, root);
  osteon_session_destroy(session);
  osteon_tool_destroy(tool);
  osteon_bone_destroy(bone);
  return 0;
}
