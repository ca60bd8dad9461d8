#pragma once

#include <optional>
#include <vector>

#include "procedure/assessment/cavity_result.h"
#include "procedure/assessment/opening_result.h"
#include "procedure/assessment/process_figures.h"
#include "procedure/assessment/score.h"
#include "procedure/plan/surgical_plan.h"

namespace osteon::procedure {

/// The axis of the reaming. A spherical cavity has no axis, so the tool's axis counts: its mean, weighted by
/// the volume that the tool removed.
class ReamedAxis {
 public:
  /// @param feed_G  the tool's +z
  void Add(const Vector3& feed_G, double removed_m3) { sum_ -= removed_m3 * feed_G; }
  /// Adds the volume that another pass has removed, with its axis.
  void Add(const ReamedAxis& other) { sum_ += other.sum_; }
  /// The axis, out of the opening, unit; nothing if no volume was removed.
  [[nodiscard]] std::optional<Vector3> value() const {
    return sum_.norm() > 0.0 ? std::optional<Vector3>(sum_.normalized()) : std::nullopt;
  }

 private:
  Vector3 sum_{Vector3::Zero()};
};

/// Results of a session.
struct Assessment {
  CavityResult cavity;
  std::optional<OpeningResult> opening;  ///< only for a plan of an opening
  std::optional<Vector3> axis_G;     ///< of the reaming, or of the placed cup; nothing: no bone was removed
  bool axis_of_cup{false};           ///< axis_G is the axis of the placed cup
  std::optional<double> min_wall_m;  ///< thinnest wall that is left; nothing: not known
  ProcessFigures process;
};

/// Fills in the results that the carved bone shows: the cavity and, for a plan of an opening, the opening.
/// @param uncut, state  the bone before the session, and its state after it
void AssessBone(const SurgicalPlan& plan, const simulation::Bone& uncut, const simulation::CarvedState& state,
                Assessment& assessment);

/// Angle between the planned axis and Assessment::axis_G [rad]; nothing without that axis.
[[nodiscard]] std::optional<double> AxisError(const SurgicalPlan& plan, const Assessment& assessment);

/// A published mean with its standard deviation.
struct MeanAndSpread {
  double mean_m{0.0}, sd_m{0.0};
};

/// A shift of the hip's centre from the native one, and for comparison the shifts that two methods of reaming
/// left in patients. It is shown but never scored, because a plan may ask for another centre.
struct PublishedShift {
  const char* direction;  ///< "medial" or "superior", the positive one
  double value_m{0.0};    ///< of this session
  MeanAndSpread peripheral, standard;
  const char* source;
};
/// Returns the session's shifts beside the published ones; empty without a fitted sphere.
[[nodiscard]] std::vector<PublishedShift> PublishedShifts(const Assessment& assessment);

/// Returns the metrics' values; errors and shifts as magnitudes.
[[nodiscard]] MetricValues ValuesOf(const SurgicalPlan& plan, const Assessment& assessment);

}  // namespace osteon::procedure
