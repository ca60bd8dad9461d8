// Pass 3, first half: how far bone gives way in this frame (twin of simulation::AdvanceOfFrame, StepOfAdvance and EndOfAdvance). Every
// invocation works it out for itself: cheaper than a pass of its own.
struct Advance {
  double advance_mm, edge_work_Nmm;
  dvec3 step_mm;
};

// 1 - exp(-y) for y >= 0: the series for a small part of y, doubled.
double OneLessExp(double y) {
  uint doublings = 0u;
  for (; y > 0.01lf && doublings < 13u; ++doublings) y *= 0.5lf;  // beyond 40 it is 1
  y = min(y, 0.01lf);
  double q = y * (1.0lf - y / 2.0lf * (1.0lf - y / 3.0lf * (1.0lf - y / 4.0lf * (1.0lf - y / 5.0lf * (1.0lf - y / 6.0lf)))));
  for (; doublings > 0u; --doublings) q *= 2.0lf - q;
  return q;
}

Advance AdvanceOfFrame(double at_contact, Slide slide) {
  double x = frame.exact.cutting, advance = 0.0lf, edge_work = 0.0lf;
  bool turns = frame.exact.spindle_rad_per_s != 0.0lf && frame.exact.dt_s > 0.0lf;
  if (x > 0.0lf && turns) {
    double area = 0.0lf, moment = 0.0lf, work_per_mm = 0.0lf;
    for (uint m = 0; m < frame.material_count; ++m) {
      double own = double(frame.exact.engaged[2 * m]) / (kFiner * double(frame.area_scale));
      area += own;
      moment += frame.exact.force_ratio[m] * (double(frame.exact.engaged[2 * m + 1]) / (kFiner * double(frame.moment_scale)));
      work_per_mm += frame.exact.cutting_energy[m] * own;
    }
    double most = max(0.0lf, frame.exact.max_slide - slide.way_mm);
    double arm = area > 0.0lf ? moment / area : 0.0lf;
    double force = min(frame.exact.stiffness * x, frame.exact.max_force);
    double work = force * abs(frame.exact.spindle_rad_per_s) * arm * frame.exact.dt_s;
    if (frame.immediate != 0u) {
      advance = x;
      edge_work = work;
    } else if (work_per_mm <= 0.0lf) {
      advance = min(x, most);
    } else {
      double linear = max(0.0lf, work - frame.exact.work_held_back) / work_per_mm;
      advance = min(x * OneLessExp(linear / x), most);
      edge_work = linear > 0.0lf ? work * advance / linear : work;
    }
  }
  dvec3 goal = frame.exact.goal, origin = frame.exact.start + at_contact * (goal - frame.exact.start);
  dvec3 slide_mm = AfterSlide(slide, origin, goal) - origin;
  // the immediate law goes all the way to the tool's pose, but where balls that do not cut hold alone
  bool all_the_way = frame.immediate != 0u && turns && (advance > 0.0lf || frame.exact.delta == dvec3(0.0lf));
  dvec3 step_mm = all_the_way ? goal - origin - slide_mm : -advance * frame.exact.n;
  // balls that do not cut hold it back
  for (uint c = frame.shaft_candidate; c < frame.shaft_end; ++c) {
    Candidate shaft = frame.candidates[c];
    dvec3 n = dvec3(shaft.n_x, shaft.n_y, shaft.n_z);
    double closing = -dot(n, step_mm) - max(0.0lf, double(shaft.gap_mm) + dot(n, slide_mm));
    if (closing > 0.0lf) step_mm += closing * n;
  }
  return Advance(advance, edge_work, step_mm);
}
