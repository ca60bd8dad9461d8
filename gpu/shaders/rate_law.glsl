// Pass 3, first half: how far bone gives way in this frame (equivalent to simulation::ComputeAdvance, ComputeAdvanceStep and
// ComputeAdvanceEnd). Every invocation computes it for itself, which is cheaper than a separate pass.
struct Advance {
  double advance_mm, edge_work_Nmm;
  dvec3 step_mm;
};

// 1 - exp(-y) for y >= 0: the series for a small part of y, then repeated doubling.
double OneLessExp(double y) {
  uint doublings = 0u;
  for (; y > 0.01lf && doublings < 13u; ++doublings) y *= 0.5lf;  // for y beyond 40 the result is 1
  y = min(y, 0.01lf);
  // products by reciprocals, because one division takes as long as the rest
  const double third = 1.0lf / 3.0lf, fifth = 0.2lf, sixth = 1.0lf / 6.0lf;
  double q = y * (1.0lf - y * 0.5lf * (1.0lf - y * third * (1.0lf - y * 0.25lf * (1.0lf - y * fifth * (1.0lf - y * sixth)))));
  for (; doublings > 0u; --doublings) q *= 2.0lf - q;
  return q;
}

Advance ComputeAdvance(double at_contact, Slide slide) {
  // load all values at once
  double x = frame.exact.cutting, advance = 0.0lf, edge_work = 0.0lf;
  double spindle_rad_per_s = abs(frame.exact.spindle_rad_per_s), dt_s = frame.exact.dt_s;
  double stiffness = frame.exact.stiffness, max_force = frame.exact.max_force, max_slide = frame.exact.max_slide;
  double held_back = frame.exact.work_held_back;
  bool immediate = frame.immediate != 0u, turns = spindle_rad_per_s != 0.0lf && dt_s > 0.0lf;
  dvec3 n = frame.exact.n, delta = frame.exact.delta, start = frame.exact.start, goal = frame.exact.goal;
  uint first_shaft = frame.shaft_candidate, shaft_end = frame.shaft_end;
  double area = 0.0lf, moment = 0.0lf, work_per_mm = 0.0lf, per_pass = 0.0lf;
  double per_area = 1.0lf / (kUnitSubdivision * double(frame.area_scale)), per_moment = 1.0lf / (kUnitSubdivision * double(frame.moment_scale));
  for (uint m = 0; m < kMaterials; ++m) {
    double own = NumberOf(frame.exact.engaged[2 * m]) * per_area;
    area += own;
    moment += frame.exact.force_ratio[m] * (NumberOf(frame.exact.engaged[2 * m + 1]) * per_moment);
    work_per_mm += frame.exact.cutting_energy[m] * own;
    per_pass += frame.exact.edge_force[m] * own;
  }
  if (x > 0.0lf && turns) {
    double max_advance = max(0.0lf, max_slide - slide.way_mm);
    double arm = area > 0.0lf ? moment / area : 0.0lf;
    double force = min(stiffness * x, max_force);
    double available = force * spindle_rad_per_s * arm * dt_s;
    if (immediate) {
      advance = x;
      edge_work = available;
    } else if (work_per_mm <= 0.0lf) {
      advance = min(x, max_advance);
    } else {
      const double per_radian = 0.15915494309189535lf;  // passes of an edge
      double ploughing = min(spindle_rad_per_s * dt_s * per_radian * per_pass, available);
      double work = available - ploughing;
      double linear = max(0.0lf, work - held_back) / work_per_mm;
      edge_work = work;
      if (linear > 0.0lf) {
        double beyond = ploughing > 0.0lf ? x * (work / available) : x;
        advance = min(beyond * OneLessExp(linear / beyond), max_advance);
        edge_work = work * advance / linear;
      }
    }
  }
  dvec3 origin = start + at_contact * (goal - start);
  dvec3 slide_mm = AfterSlide(slide, origin, goal) - origin;
  // the immediate law goes all the way to the tool's pose, unless only balls that do not cut hold the tool
  bool all_the_way = immediate && turns && (advance > 0.0lf || delta == dvec3(0.0lf));
  dvec3 step_mm = all_the_way ? goal - origin - slide_mm : -advance * n;
  // balls that do not cut hold the proxy back
  for (uint c = first_shaft; c < shaft_end; ++c) {
    Candidate shaft = frame.candidates[c];
    dvec3 from_bone = dvec3(shaft.n_x, shaft.n_y, shaft.n_z);
    double closing = -dot(from_bone, step_mm) - max(0.0lf, double(shaft.gap_mm) + dot(from_bone, slide_mm));
    if (closing > 0.0lf) step_mm += closing * from_bone;
  }
  return Advance(advance, edge_work, step_mm);
}
