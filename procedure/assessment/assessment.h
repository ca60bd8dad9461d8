#pragma once

#include <optional>
#include <vector>

#include "procedure/assessment/cavity_result.h"
#include "procedure/assessment/opening_result.h"
#include "procedure/assessment/process_figures.h"
#include "procedure/assessment/score.h"
#include "procedure/plan/surgical_plan.h"

namespace osteon::procedure {

/// The axis of the reaming. A spherical cavity has no axis, so the mean of the tool's axis is used, weighted
/// by the volume that the tool removed.
class ReamedAxis {
 public:
  /// Adds the volume that the tool removed with this feed direction. @param feed_G  the tool's +z, in G
  void Add(const Vector3& feed_G, double removed_m3) { sum_ -= removed_m3 * feed_G; }
  /// Adds the removed volume and the axis of another pass.
  void Add(const ReamedAxis& other) { sum_ += other.sum_; }
  /// The unit axis, pointing out of the opening; nothing if no volume was removed.
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
  std::optional<Vector3> axis_G;  ///< axis of the reaming, or of the placed cup; nothing: no bone was removed
  bool axis_of_cup{false};        ///< axis_G is the axis of the placed cup
  std::optional<double> min_wall_m;  ///< thickness of the thinnest remaining wall; nothing: not known
  ProcessFigures process;
};

/// Fills in the results that follow from the carved bone: the cavity and, for a plan of an opening, the
/// opening.
/// @param uncut, state  the bone before the session, and its state after it
void AssessBone(const SurgicalPlan& plan, const simulation::Bone& uncut, const simulation::CarvedState& state,
                Assessment& assessment);

/// Angle between the planned axis and Assessment::axis_G [rad]; nothing if axis_G is absent.
[[nodiscard]] std::optional<double> AxisError(const SurgicalPlan& plan, const Assessment& assessment);

/// A published mean with its standard deviation.
struct MeanAndSpread {
  double mean_m{0.0}, sd_m{0.0};
};

/// A shift of the hip's centre from the native centre. For comparison: the published shifts after two methods
/// of reaming in patients. The shift is shown but never scored, because a plan may ask for another centre.
struct PublishedShift {
  const char* direction;  ///< "medial" or "superior", the positive one
  double value_m{0.0};    ///< shift in this session
  MeanAndSpread peripheral, standard;
  const char* source;
};
/// Returns the session's shifts with the published ones; empty without a fitted sphere.
[[nodiscard]] std::vector<PublishedShift> PublishedShifts(const Assessment& assessment);

/// Returns the metrics' values; errors and shifts as magnitudes.
[[nodiscard]] MetricValues ValuesOf(const SurgicalPlan& plan, const Assessment& assessment);

}  // namespace osteon::procedure
