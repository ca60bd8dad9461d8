#include "studies/charts/chart_items.h"

#include <string>

#include "studies/sharding/exact_number.h"

namespace osteon::studies {
namespace {

using nlohmann::json;

// Visits each number of the scores with its name; the scores may be const.
template <class Scores, class Visit>
void VisitScores(Scores& s, const Visit& visit) {
  visit("depth_error_m", s.depth_error_m);
  visit("depth_error_se_m", s.depth_error_se_m);
  visit("lost_m", s.lost_m);
  visit("left_m", s.left_m);
  visit("probe_p95_m", s.probe_p95_m);
  visit("volume_error", s.volume_error);
  visit("swept_volume_m3", s.swept_volume_m3);
  visit("ripple", s.ripple);
  visit("force_rms_N", s.force.force_rms_N);
  visit("force_relative", s.force.force_relative);
  visit("torque_rms_Nm", s.force.torque_rms_Nm);
  visit("normal_rms_deg", s.force.normal_rms_deg);
  visit("normal_max_deg", s.force.normal_max_deg);
  visit("force_jump_N_per_ms", s.force.force_jump_N_per_ms);
  visit("torque_jump_Nm_per_ms", s.force.torque_jump_Nm_per_ms);
  visit("normal_jump_deg_per_ms", s.force.normal_jump_deg_per_ms);
}

// Visits each percentile of a time with its name; the figures may be const.
template <class Figures, class Visit>
void VisitFigures(Figures& f, const Visit& visit) {
  visit("p50_us", f.p50_us);
  visit("p95_us", f.p95_us);
  visit("p99_us", f.p99_us);
  visit("p999_us", f.p999_us);
  visit("max_us", f.max_us);
}

}  // namespace

json FiguresItem(const simulation::TimeFigures& figures) {
  json item = json::object();
  VisitFigures(figures, [&](const char* name, double value) { item[name] = ExactNumber(value); });
  return item;
}

simulation::TimeFigures FiguresFrom(const json& item) {
  simulation::TimeFigures figures;
  VisitFigures(figures, [&](const char* name, double& value) { ReadAt(item, name, value); });
  return figures;
}

json ScoresItem(const simulation::WorkloadScores& scores) {
  json item{{"touched", scores.force.touched}};
  VisitScores(scores, [&](const char* name, double value) { item[name] = ExactNumber(value); });
  return item;
}

simulation::WorkloadScores ScoresFrom(const json& item) {
  simulation::WorkloadScores scores;
  ReadAt(item, "touched", scores.force.touched);
  VisitScores(scores, [&](const char* name, double& value) { ReadAt(item, name, value); });
  return scores;
}

json ScalingPointItem(const ScalingPoint& point) {
  const FrameTiming& t = point.timing;
  return {{"series", point.series},
          {"spheres", point.spheres},
          {"cut_zone_m", ExactNumber(point.cut_zone_m)},
          {"method", t.method},
          {"device", t.device},
          {"frames", t.frames},
          {"frame_us", FiguresItem(t.frame_us)},
          {"active_spheres_mean", t.active_spheres_mean ? ExactNumber(*t.active_spheres_mean) : json()}};
}

ScalingPoint ScalingPointFrom(const json& item) {
  ScalingPoint point;
  ReadAt(item, "series", point.series);
  ReadAt(item, "spheres", point.spheres);
  ReadAt(item, "cut_zone_m", point.cut_zone_m);
  FrameTiming& t = point.timing;
  ReadAt(item, "method", t.method);
  ReadAt(item, "device", t.device);
  ReadAt(item, "frames", t.frames);
  t.frame_us = FiguresFrom(item.at("frame_us"));
  if (const json& active = item.at("active_spheres_mean"); !active.is_null())
    t.active_spheres_mean = ExactNumberFrom(active);
  return point;
}

}  // namespace osteon::studies
