// Pass 3, first half: how far bone gives way in this frame (twin of simulation::AdvanceOfFrame, StepOfAdvance and EndOfAdvance). Every
// invocation works it out for itself: cheaper than a pass of its own.
struct Advance {
  float advance_mm, edge_work_Nmm;
  vec3 step_mm;
};
Advance AdvanceOfFrame(float at_contact, Slide slide) {
  float x = frame.delta.w, advance = 0.0, edge_work = 0.0;
  if (x > 0.0 && frame.spindle_rad_per_s != 0.0 && frame.dt_s > 0.0) {
    float area = 0.0, moment = 0.0, work_per_mm = 0.0;
    for (uint m = 0; m < frame.material_count; ++m) {
      float own = Total(frame.engaged_sums[2 * m], frame.area_scale);
      area += own;
      moment += frame.material[m].y * Total(frame.engaged_sums[2 * m + 1], frame.moment_scale);
      work_per_mm += frame.material[m].x * own;
    }
    float most = max(0.0, frame.max_slide_mm - slide.way_mm);
    float arm = area > 0.0 ? moment / area : 0.0;
    float force = min(frame.stiffness_N_per_mm * x, frame.max_force_N);
    float work = force * abs(frame.spindle_rad_per_s) * arm * frame.dt_s;
    if (frame.immediate != 0u) {
      advance = x;
      edge_work = work;
    } else if (work_per_mm <= 0.0) {
      advance = min(x, most);
    } else {
      float linear = max(0.0, work - frame.work_held_back_Nmm) / work_per_mm;
      float y = linear / x;
      // x (1 - exp(-y)); the series where the difference would cancel
      advance = min(x * (y < 1e-2 ? y * (1.0 - y * (0.5 - y / 6.0)) : 1.0 - exp(-y)), most);
      edge_work = linear > 0.0 ? work * advance / linear : work;
    }
  }
  vec3 origin = OriginAtContact(at_contact), slide_mm = AfterSlide(slide, origin, frame.goal.xyz) - origin;
  // the immediate law goes all the way to the tool's pose, but where balls that do not cut hold alone
  bool all_the_way = frame.immediate != 0u && frame.spindle_rad_per_s != 0.0 && frame.dt_s > 0.0 &&
                     (advance > 0.0 || frame.delta.xyz == vec3(0.0));
  vec3 step_mm = all_the_way ? frame.goal.xyz - origin - slide_mm : -advance * frame.n.xyz;
  // balls that do not cut hold it back
  for (uint c = frame.shaft_candidate; c < frame.shaft_end; ++c) {
    Candidate shaft = frame.candidates[c];
    vec3 n = vec3(shaft.n_x, shaft.n_y, shaft.n_z);
    float closing = -dot(n, step_mm) - max(0.0, shaft.gap_mm + dot(n, slide_mm));
    if (closing > 0.0) step_mm += closing * n;
  }
  return Advance(advance, edge_work, step_mm);
}
