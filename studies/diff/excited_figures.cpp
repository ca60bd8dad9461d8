#include "studies/diff/excited_figures.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "session/setup/recorded_config.h"
#include "studies/identify/excited_axis.h"
#include "studies/identify/identify_estimate.h"
#include "studies/identify/identify_result.h"

namespace osteon::studies {
namespace {

// Two lines count as the same if they differ by at most this many standard deviations of their difference.
constexpr double kDeviations = 2.0;

// The kind of a run of `osteon identify`; only runs of the same kind are compared.
const char* KindOf(const ExcitationRequest& request) {
  if (request.rest_s > 0.0) return request.held ? "a tremor run" : "a noise run";
  if (request.joint > 0) return "a run of a joint";
  if (request.overlay) return request.held ? "a held overlay run" : "a free overlay run";
  return request.held ? "a held run along an axis" : "a free run along an axis";
}

// The excitation as text; two runs whose texts differ were excited differently.
std::string ExcitationOf(const ExcitationRequest& request) {
  if (request.rest_s > 0.0) return fmt::format("{} of {:g} s", KindOf(request), request.rest_s);
  return fmt::format("{}, seed {}, {} draws of {} periods", NameOf(request), request.seed, request.draws,
                     request.periods);
}

// Adds an estimate as a figure. Two runs count as the same if they differ by at most the half width of the
// estimate's interval.
// @param in  size of the figure's unit in SI: 1e-3 for ms
void Add(const char* name, const char* key, const char* unit, const Estimate& estimate, double in,
         ExcitedFigures& excited) {
  excited.figures.push_back({.name = name,
                             .key = key,
                             .unit = unit,
                             .value = estimate.value / in,
                             .least_difference = std::abs(estimate.half_width) / in});
}

// @param by  name of the signal by which the response was measured
void AddResponse(const char* by, const MeasuredResponse& response, ExcitedFigures& excited) {
  RecordedResponse& recorded = excited.responses.emplace_back();
  recorded.by = by;
  for (const ResponseLine& line : response.lines)
    recorded.lines.push_back({.hz = line.hz, .value = line.value, .sd = line.sd});
}

void AddHand(const AxisResult& axis, ExcitedFigures& excited) {
  Add("stiffness of the hand", "hand_stiffness_N_per_m", "N/m", axis.hand->stiffness_N_per_m, 1.0, excited);
  Add("damping of the hand", "hand_damping_Ns_per_m", "N s/m", axis.hand->damping_Ns_per_m, 1.0, excited);
  Add("mass of the hand", "hand_mass_kg", "kg", axis.hand->mass_kg, 1.0, excited);
}

// Adds everything that identify estimates along an axis or of a joint: arm, tool, hand and responses.
void AddAxis(const AxisResult& axis, ExcitedFigures& excited) {
  const bool is_joint = axis.request.joint > 0;
  excited.figures.push_back({.name = is_joint ? "RMS speed of the joint" : "RMS speed of the tool",
                             .key = is_joint ? "excited_rad_per_s" : "excited_m_per_s",
                             .unit = is_joint ? "rad/s" : "m/s",
                             .value = axis.rms_speed_m_per_s});
  if (axis.overlay) {
    Add("spring that a force meets", "spring_N_per_m", "N/m", axis.overlay->stiffness_N_per_m, 1.0, excited);
    Add("damping that a force meets", "damping_Ns_per_m", "N s/m", axis.overlay->damping_Ns_per_m, 1.0,
        excited);
    Add("mass that a force meets", "mass_kg", "kg", axis.overlay->mass_kg, 1.0, excited);
    Add("dead time of the force", "dead_time_ms", "ms", axis.overlay->dead_time_s, 1e-3, excited);
  } else {
    Add("bandwidth of the arm", "bandwidth_hz", "Hz", axis.fit.bandwidth_hz, 1.0, excited);
    Add("damping ratio of the arm", "damping_ratio", "", axis.fit.damping_ratio, 1.0, excited);
    Add("dead time of the arm", "dead_time_ms", "ms", axis.fit.dead_time_s, 1e-3, excited);
    Add("total lag of the arm", "lag_ms", "ms", axis.fit.lag_s, 1e-3, excited);
  }
  if (axis.tool) {
    Add("tool on the force sensor", "tool_mass_kg", "kg", axis.tool->mass_kg, 1.0, excited);
    Add("delay of the force sensor", "sensor_delay_ms", "ms", axis.tool->delay_s, 1e-3, excited);
  }
  if (axis.hand) AddHand(axis, excited);
  AddResponse("encoders", axis.by_encoders, excited);
  if (axis.by_force) AddResponse("force", *axis.by_force, excited);
  if (axis.hand && axis.force_over_position) AddResponse("hand", *axis.force_over_position, excited);
}

void AddForce(const char* name, const char* key, double value_N, ExcitedFigures& excited) {
  constexpr double kLeast_N = 1e-3;  // smaller differences never count
  excited.figures.push_back(
      {.name = name, .key = key, .unit = "N", .value = value_N, .least_difference = kLeast_N});
}

}  // namespace

bool IsExcitation(const std::string& event) { return ParseEvent(event).has_value(); }

ExcitedFigures ReadExcitedFigures(const std::filesystem::path& recording, const io::SessionInfo& session,
                                  const std::string& event) {
  const ExcitationRequest request = ParseEvent(event).value_or(ExcitationRequest{});
  ExcitedFigures excited{.kind = KindOf(request), .excitation = ExcitationOf(request)};
  const auto cell = session::LoadRecordedCell(session.config);
  if (!cell) {
    excited.refused = cell.error();
    return excited;
  }
  IdentifyResult result = EmptyResult("", *cell);
  if (const auto added = AddRecording(recording, *cell, result); !added) {
    excited.refused = added.error();
    return excited;
  }
  if (!result.refused.empty()) excited.refused = result.refused.front().what;
  for (const std::vector<AxisResult>* moved : {&result.axes, &result.joints})
    for (const AxisResult& axis : *moved) AddAxis(axis, excited);
  if (result.noise) {
    AddForce("noise of the force sensor", "noise_N", result.noise->white_N, excited);
    AddForce("drift of the force sensor", "drift_N", result.noise->drift_N, excited);
  }
  if (result.tremor) AddForce("tremor of the hand", "tremor_N", result.tremor->p999_N, excited);
  return excited;
}

std::size_t ResponseDifference::differing() const {
  return static_cast<std::size_t>(std::ranges::count_if(lines, &LineDifference::differs));
}

const LineDifference& ResponseDifference::worst() const {
  return *std::ranges::max_element(lines, {}, [](const LineDifference& line) {
    return std::abs(line.first.value - line.second.value) / std::max(1e-300, line.accepted);
  });
}

// Two lines count as being at the same frequency if their frequencies differ by at most this share.
constexpr double kSameFrequency = 1e-6;

std::vector<ResponseDifference> CompareResponses(const ExcitedFigures& first, const ExcitedFigures& second,
                                                 double within, std::vector<std::string>& only) {
  std::vector<ResponseDifference> differences;
  for (const RecordedResponse& a : first.responses) {
    const auto b = std::ranges::find(second.responses, a.by, &RecordedResponse::by);
    if (b == second.responses.end()) {
      only.push_back(fmt::format("only the first run has a response by {}", a.by));
      continue;
    }
    ResponseDifference difference{.by = a.by, .lines = {}};
    for (const RecordedResponse::Line& line_a : a.lines) {
      const auto line = std::ranges::find_if(b->lines, [&](const RecordedResponse::Line& line_b) {
        return std::abs(line_b.hz - line_a.hz) <= kSameFrequency * line_a.hz;
      });
      if (line == b->lines.end()) continue;
      const RecordedResponse::Line& line_b = *line;
      const double size = std::max(std::abs(line_a.value), std::abs(line_b.value));
      difference.lines.push_back(
          {.first = line_a,
           .second = line_b,
           // sd is that of one part: the real and imaginary parts together have sqrt(2) times as much
           .accepted =
               std::max(within * size, kDeviations * std::sqrt(2.0) * std::hypot(line_a.sd, line_b.sd))});
    }
    const std::size_t paired = difference.lines.size();
    if (paired < a.lines.size() || paired < b->lines.size())
      only.push_back(
          fmt::format("response by {}: {} lines of the first run and {} of the second are at frequencies "
                      "that the other has not",
                      a.by, a.lines.size() - paired, b->lines.size() - paired));
    if (paired > 0) differences.push_back(std::move(difference));
  }
  for (const RecordedResponse& b : second.responses)
    if (std::ranges::find(first.responses, b.by, &RecordedResponse::by) == first.responses.end())
      only.push_back(fmt::format("only the second run has a response by {}", b.by));
  return differences;
}

}  // namespace osteon::studies
