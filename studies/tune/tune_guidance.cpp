#include "studies/tune/tune_guidance.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "hil/loops/admittance_loop.h"

namespace osteon::studies {
namespace {

constexpr double kMaxFactor = 4.0;  // boundaries are searched up to this multiple of the plan's gains

// The planar loop of hand, arm and guidance, with the task's arm and delays and the law's virtual tool.
GuidedLoopParams LoopOf(const TuneTask& task, const control::AdmittanceParams& law,
                        const control::GuidanceParams& guidance) {
  GuidedLoopParams loop{.arm = task.loop.arm,
                        .sensor_delay = task.loop.sensor_delay,
                        .period_s = task.loop.period_s,
                        .guidance = guidance};
  // The loop is planar: use the lighter of the two lateral axes, and of the two rotations.
  loop.mass_kg = std::min(law.mass_kg.x(), law.mass_kg.y());
  loop.damping_Ns_per_m = std::min(law.damping_Ns_per_m.x(), law.damping_Ns_per_m.y());
  loop.inertia_kg_m2 = std::min(law.inertia_kg_m2.x(), law.inertia_kg_m2.y());
  loop.damping_Nms_per_rad = std::min(law.damping_Nms_per_rad.x(), law.damping_Nms_per_rad.y());
  loop.centre_m = -law.centre_T_m.z();
  return loop;
}

// The largest stiffness of the depth spring that is stable with every hand. Hands that are unstable even
// without the spring are left out.
hil::Boundary DepthBoundary(const TuneTask& task, double max_N_per_m) {
  hil::Boundary least{.value = max_N_per_m, .crossed = false};
  hil::AdmittanceLoopParams loop = task.loop;
  loop.wall = {};
  for (const HeldHand& held : GuidanceHands()) {
    loop.hand = held.hand;
    if (hil::AdmittanceLoop(loop).SpectralRadius() >= 1.0) continue;
    const hil::Boundary found =
        hil::MaxWallStiffness(loop, {.from = 100.0, .to = max_N_per_m, .tolerance = 1e-2});
    if (found.crossed && found.value < least.value) least = found;
  }
  return least;
}

// A boundary's value as text, in another unit. @param unit_factor  multiplies the value to give that unit
std::string BoundaryText(const hil::Boundary& boundary, double unit_factor) {
  return fmt::format("{}{:.3g}", boundary.crossed ? "" : "at least ", boundary.value * unit_factor);
}

}  // namespace

GuidanceMap MapGuidance(const TuneTask& task, const control::AdmittanceParams& law,
                        const control::GuidanceParams& guidance, bool (*stopped)()) {
  GuidanceMap map{.guidance = guidance};
  GuidedLoopParams loop = LoopOf(task, law, guidance);
  const std::vector<HeldHand> hands = HandsStableWithoutGuidance(loop);
  map.hands = hands.size();
  for (const std::size_t i : HandsThatGuidanceMakesUnstable(loop, hands))
    map.unstable.push_back(
        fmt::format("{} held {:g} mm above the apex", hands[i].hand.name, 1e3 * hands[i].lever_m));
  if (stopped()) return map;
  map.factor = GuidanceBoundary(loop, hands, kMaxFactor);
  map.depth_N_per_m = DepthBoundary(task, kMaxFactor * std::max(1e3, guidance.depth.stiffness));
  for (int row = 0; row < GuidanceMap::kNodes && !stopped(); ++row) {
    std::vector<int>& counts = map.counts.emplace_back();
    for (int column = 0; column < GuidanceMap::kNodes; ++column) {
      // stiffness at a node of the map, as a factor on the plan's stiffness
      const auto plan_factor = [](int node) {
        return GuidanceMap::kMargin * node / (GuidanceMap::kNodes - 1);
      };
      loop.guidance.lateral.stiffness = plan_factor(row) * guidance.lateral.stiffness;
      loop.guidance.cone.stiffness = plan_factor(column) * guidance.cone.stiffness;
      counts.push_back(static_cast<int>(std::ranges::count_if(hands, [&](const HeldHand& held) {
        loop.hand = held.hand;
        loop.lever_m = held.lever_m;
        return !GuidedLoop(loop).IsStable();
      })));
    }
  }
  return map;
}

void JudgeGuidance(const GuidanceMap& map, session::Verdict& verdict) {
  if (map.Accepted()) return;
  if (!map.unstable.empty())
    verdict.Add(session::VerdictLevel::kBad,
                fmt::format("the plan's guidance makes {} of {} hands unstable: {}", map.unstable.size(),
                            map.hands, fmt::join(map.unstable, "; ")));
  else
    verdict.Add(
        session::VerdictLevel::kBad,
        fmt::format("the plan's guidance is beyond half of its boundary: funnel and cone stand {} times "
                    "the plan's stiffness, {:g} accepted; depth {} N/mm, at least {:g} accepted: lower the "
                    "plan's stiffnesses",
                    BoundaryText(map.factor, 1.0), GuidanceMap::kMargin,
                    BoundaryText(map.depth_N_per_m, 1e-3),
                    1e-3 * GuidanceMap::kMargin * map.guidance.depth.stiffness));
}

std::vector<report::SummaryRow> RowsOf(const GuidanceMap& map) {
  return {{"Guidance",
           fmt::format(
               "{:g} N/mm aside, {:g} N·m/rad of tilt, {:g} N/mm of depth: of {} hands and levers that are "
               "stable without it, {} become unstable",
               1e-3 * map.guidance.lateral.stiffness, map.guidance.cone.stiffness,
               1e-3 * map.guidance.depth.stiffness, map.hands, map.unstable.size())},
          {"Guidance's boundary",
           fmt::format("{} times the stiffness of funnel and cone; depth {} N/mm; {}",
                       BoundaryText(map.factor, 1.0), BoundaryText(map.depth_N_per_m, 1e-3),
                       map.Accepted() ? "the plan keeps half of it" : "refused: more than half of it")}};
}

nlohmann::json ToJson(const GuidanceMap& map) {
  return {{"lateral_N_per_m", map.guidance.lateral.stiffness},
          {"cone_Nm_per_rad", map.guidance.cone.stiffness},
          {"depth_N_per_m", map.guidance.depth.stiffness},
          {"hands", map.hands},
          {"unstable", map.unstable},
          {"boundary_factor", map.factor.value},
          {"boundary_crossed", map.factor.crossed},
          {"depth_boundary_N_per_m", map.depth_N_per_m.value},
          {"depth_boundary_crossed", map.depth_N_per_m.crossed},
          {"margin", GuidanceMap::kMargin},
          {"accepted", map.Accepted()},
          {"unstable_by_lateral_and_cone", map.counts}};
}

std::string TableOf(const GuidanceMap& map) {
  const auto plan_factor = [](int node) { return GuidanceMap::kMargin * node / (GuidanceMap::kNodes - 1); };
  std::string table = "<table>\n<tr><th>lateral [N/mm], tilt [N·m/rad]</th>";
  for (int column = 0; column < GuidanceMap::kNodes; ++column)
    table += fmt::format("<th>{:.4g}</th>", plan_factor(column) * map.guidance.cone.stiffness);
  table += "</tr>\n";
  for (std::size_t row = 0; row < map.counts.size(); ++row) {
    table += fmt::format("<tr><th>{:.4g}</th>",
                         1e-3 * plan_factor(static_cast<int>(row)) * map.guidance.lateral.stiffness);
    for (const int count : map.counts[row]) table += fmt::format("<td>{}</td>", count);
    table += "</tr>\n";
  }
  return table + "</table>\n";
}

}  // namespace osteon::studies
