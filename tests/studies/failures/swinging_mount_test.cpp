#include <algorithm>

#include <gtest/gtest.h>

#include "studies/failures/compliance/swinging_mount.h"

// The vibration index if the bone swings on its mount. The index must not take the swing for an oscillation
// of the loop.

namespace osteon::studies {
namespace {

TEST(SwingingMount, TheVibrationIndexAddsNoMoreDragThanOnBoneAtRest) {
  double most_at_rest = 0.0;
  for (const hil::GridHand& hand : hil::NamedHands()) {
    if (hand.mass_kg == 0.0) continue;  // not for a fixture or a clamp
    for (const double tremor_N : {0.5, 1.0}) {
      const SwingTrial rest = RunSwingTrial({.hand = hand, .tremor_N = tremor_N});
      EXPECT_FALSE(rest.fault) << hand.name;
      most_at_rest = std::max(most_at_rest, rest.mean_drag);
      for (const double hz : {4.0, 6.0, 8.0, 10.0, 12.0, 15.0, 20.0}) {
        const SwingTrial swing = RunSwingTrial({.hand = hand, .tremor_N = tremor_N, .mount_hz = hz});
        EXPECT_FALSE(swing.fault) << hand.name << " " << hz << " Hz";
        EXPECT_LE(swing.mean_drag, 1.15 * rest.mean_drag)
            << hand.name << ", tremor " << tremor_N << " N, mount of " << hz << " Hz";
        EXPECT_GT(swing.swing_m, rest.swing_m) << hand.name << " " << hz << " Hz: the bone gives way";
      }
    }
  }
  EXPECT_GT(most_at_rest, 1.5) << "the index acts in this scene at all";
}

}  // namespace
}  // namespace osteon::studies
