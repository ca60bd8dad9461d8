# cmake -DSOURCE_DIR=… -DBUILD_DIR=… -P plant_faults.cmake
# Writes BUILD_DIR/serial_chain.cpp and zone.cpp: the product's sources, with the faults of planted_fault.h planted in
# single expressions. A fault whose place is no longer in the source ends the build, so that none is lost unseen.

macro(open_source path)
  file(READ ${SOURCE_DIR}/${path} text)
  set(path_read ${path})
endmacro()

# PLANTED(kX) in `wrong` holds where the fault kX is the one that is asked for.
macro(plant right wrong)
  string(FIND "${text}" "${right}" first)
  string(FIND "${text}" "${right}" last REVERSE)
  if(first EQUAL -1 OR NOT first EQUAL last)
    message(FATAL_ERROR "${path_read}: found '${right}' not once, so no fault can be planted there: "
      "mend tests/safety/plant_faults.cmake")
  endif()
  string(REGEX REPLACE "PLANTED\\((k[A-Za-z]+)\\)" "osteon::planted::Is(osteon::planted::Fault::\\1)" planted "${wrong}")
  string(REPLACE "${right}" "${planted}" text "${text}")
endmacro()

macro(write_source name)
  string(PREPEND text "#include \"tests/safety/planted_fault.h\"\n")
  file(WRITE ${BUILD_DIR}/${name} "${text}")
endmacro()

open_source(kinematics/serial_chain.cpp)
plant([=[turn.cos[i], turn.sin[i]);]=]
      [=[turn.cos[i], PLANTED(kJointSign) && i == 1 ? -turn.sin[i] : turn.sin[i]);]=])
plant([=[steps_[i].cos_alpha, steps_[i].sin_alpha,]=]
      [=[steps_[i].cos_alpha, PLANTED(kJointAxis) && i == 2 ? -steps_[i].sin_alpha : steps_[i].sin_alpha,]=])
plant([=[at.Go(steps_[i].p,]=]
      [=[at.Go(PLANTED(kJointOrigin) && i == 2 ? Vector3(steps_[i].p + Vector3(0.03, 0.0, 0.0)) : steps_[i].p,]=])
plant([=[step.offset_rad = ]=] [=[step.offset_rad = (PLANTED(kJointZero) && i == 3 ? 0.1 : 0.0) + ]=])
plant([=[p_KF_ = R_LK.transpose() * params.X_LF.translation();]=]
      [=[p_KF_ = R_LK.transpose() * params.X_LF.translation();
  if (PLANTED(kFlangeOrigin)) p_KF_.z() += 0.03;
  if (PLANTED(kFlangeAxis)) R_KF_ = R_KF_ * Eigen::AngleAxisd(1.0, Vector3::UnitX()).toRotationMatrix();]=])
plant([=[const Vector3 axis = posture.axis_B(i);]=]
      [=[const Vector3 axis = PLANTED(kJacobianAxis) && i == 1
                             ? Vector3(posture.R_BK[static_cast<std::size_t>(i)].col(0))
                             : Vector3(posture.axis_B(i));]=])
plant([=[J.col(i).template head<3>() = axis.cross(p_B - posture.p_BL[static_cast<std::size_t>(i)]);]=]
      [=[J.col(i).template head<3>() =
        (PLANTED(kJacobianSign) && i == 0 ? -1.0 : 1.0) *
        axis.cross(p_B - posture.p_BL[static_cast<std::size_t>(i)] +
                   (PLANTED(kJacobianOffset) ? Vector3(0.0, 0.0, 0.3) : Vector3(0.0, 0.0, 0.0)));]=])
write_source(serial_chain.cpp)

open_source(safety/zone.cpp)
plant([=[const Vector3 p_Z = zone.R_W.transpose() * (p_WP - zone.p_W_m);]=]
      [=[const Vector3 way_W = PLANTED(kZoneSign) ? Vector3(zone.p_W_m - p_WP) : Vector3(p_WP - zone.p_W_m);
  Vector3 p_Z = PLANTED(kZoneAxis) ? Vector3(zone.R_W * way_W) : Vector3(zone.R_W.transpose() * way_W);
  if (PLANTED(kZoneOrigin)) p_Z += Vector3(0.02, 0.02, 0.02);]=])
plant([=[bounds_[i].toward_W = zone.R_W * bounds_[i].toward_W;]=]
      [=[bounds_[i].toward_W = PLANTED(kZoneDirection) ? Vector3(zone.R_W.transpose() * bounds_[i].toward_W)
                                                    : Vector3(zone.R_W * bounds_[i].toward_W);]=])
plant([=[return Add(-Vector3::UnitZ(), p_Z.z());]=]
      [=[return Add(-Vector3::UnitZ(), PLANTED(kInHalfSpaceSign) ? -p_Z.z() : p_Z.z());]=])
plant([=[zone.half_edge_m[i] - p_Z[i]);]=]
      [=[zone.half_edge_m[i] - p_Z[i] + (PLANTED(kInBoxOffset) ? 0.02 : 0.0));]=])
plant([=[zone.radius_m - across.norm());]=]
      [=[zone.radius_m - across.norm() + (PLANTED(kInCylinderOffset) ? 0.02 : 0.0));]=])
plant([=[zone.half_length_m - p_Z.z());]=]
      [=[zone.half_length_m + (PLANTED(kInCylinderEndSign) ? p_Z.z() : -p_Z.z()));]=])
plant([=[zone.radius_m - out.norm());]=]
      [=[zone.radius_m - out.norm() + (PLANTED(kInSphereOffset) ? 0.02 : 0.0));]=])
plant([=[std::clamp(p_Z.z(), -zone.half_length_m, zone.half_length_m)]=]
      [=[std::clamp(p_Z.z(), -zone.half_length_m, zone.half_length_m + (PLANTED(kAxisOffset) ? 0.02 : 0.0))]=])
plant([=[return Add(Vector3::UnitZ(), -p_Z.z());]=]
      [=[return Add(PLANTED(kOutHalfSpaceSign) ? Vector3(-Vector3::UnitZ()) : Vector3(Vector3::UnitZ()), -p_Z.z());]=])
plant([=[std::abs(p_Z[i]) - zone.half_edge_m[i];]=]
      [=[std::abs(p_Z[i]) - zone.half_edge_m[i] + (PLANTED(kOutBoxOffset) ? 0.02 : 0.0);]=])
plant([=[{across.norm() - zone.radius_m,]=]
      [=[{across.norm() - zone.radius_m + (PLANTED(kOutCylinderOffset) ? 0.02 : 0.0),]=])
plant([=[return Add(-DirectionOr(out, Vector3::UnitX()), out.norm() - zone.radius_m);]=]
      [=[return Add((PLANTED(kOutSphereSign) ? 1.0 : -1.0) * DirectionOr(out, Vector3::UnitX()),
                 out.norm() - zone.radius_m + (PLANTED(kOutSphereOffset) ? 0.02 : 0.0));]=])
plant([=[return {.toward_Z = -beyond / distance_m, .distance_m = distance_m};]=]
      [=[return {.toward_Z = (PLANTED(kGapsSign) ? 1.0 : -1.0) * beyond / distance_m, .distance_m = distance_m};]=])
plant([=[return {.toward_Z = -out_Z[nearest], .distance_m = gap_m[nearest]};]=]
      [=[return {.toward_Z = (PLANTED(kGapsSign) ? 1.0 : -1.0) * out_Z[nearest], .distance_m = gap_m[nearest]};]=])
plant([=[min_m = std::min(min_m, bounds_[i].distance_m);]=]
      [=[min_m = PLANTED(kMaxOfAll) ? std::max(min_m, bounds_[i].distance_m)
                                                 : std::min(min_m, bounds_[i].distance_m);]=])
write_source(zone.cpp)
