#pragma once

#include "simulation/contact/contact_model.h"

namespace osteon::simulation {

/// The record of one simulation frame. Plain data.
struct FrameRecord {
  ContactModel model;
  rt::Nanoseconds stamp{0};        ///< when the frame was published
  rt::Nanoseconds duration_ns{0};  ///< wall time of the frame; 0 in virtual time
  double cup_depth_m{0.0};  ///< deepest proxy apex so far below the cup's uncut floor; negative: above it
};

}  // namespace osteon::simulation
