#include "simulation/engine_cpu/kernels.h"

// Compiles the kernels for every instruction set: Highway includes this file once for each set
// (foreach_target.h). Of the x86 sets, only those that differ much from each other are built; AVX3 is
// AVX-512.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simulation/engine_cpu/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simulation/engine_cpu/kernels/engagement-inl.h"
#include "simulation/engine_cpu/kernels/first_contact-inl.h"
#include "simulation/engine_cpu/kernels/list_rows-inl.h"
#include "simulation/engine_cpu/kernels/near_field-inl.h"
#include "simulation/engine_cpu/kernels/placing-inl.h"
#include "simulation/engine_cpu/kernels/removal-inl.h"
#include "simulation/engine_cpu/kernels/sweep-inl.h"

HWY_BEFORE_NAMESPACE();
namespace osteon::simulation::cpu {
namespace HWY_NAMESPACE {

const Kernels* KernelsOfTarget() {
  static constexpr Kernels kKernels{.name = HWY_STR(HWY_NAMESPACE),
                                    .place = Place,
                                    .between = Between,
                                    .shifted = Shifted,
                                    .farthest = Farthest,
                                    .ways = Ways,
                                    .first_contact = FirstContact,
                                    .block_contact = BlockContact,
                                    .pair_contact = PairContact,
                                    .near_field = SearchNearField,
                                    .engagement = MeasureEngagement,
                                    .removal = RemoveBalls,
                                    .large_balls = FindLargeBalls,
                                    .clearing = FindCleared,
                                    .ball_rows = MakeBallRows,
                                    .point_rows = MakePointRows,
                                    .points_near = PointsNear,
                                    .tools_near_box = ToolsNearBox,
                                    .boxes_near = BoxesNear};
  return &kKernels;
}

}  // namespace HWY_NAMESPACE
}  // namespace osteon::simulation::cpu
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace osteon::simulation::cpu {
namespace {

HWY_EXPORT(KernelsOfTarget);

// Finds the kernels for every instruction set that the processor has, best first. In Highway's bit mask,
// better sets have lower bits.
std::vector<const Kernels*> FindKernels() {
  std::vector<const Kernels*> found;
  const std::int64_t plain = HWY_SCALAR | HWY_EMU128;
  for (std::int64_t sets = (hwy::SupportedTargets() | plain) & HWY_TARGETS; sets != 0; sets &= sets - 1) {
    hwy::GetChosenTarget().Update(sets & -sets);
    found.push_back(HWY_DYNAMIC_DISPATCH(KernelsOfTarget)());
  }
  hwy::GetChosenTarget().DeInit();  // undo the choice: Highway chooses the best set again
  return found;
}

}  // namespace

const std::vector<const Kernels*>& AvailableKernels() {
  static const std::vector<const Kernels*> kernels = FindKernels();
  return kernels;
}

}  // namespace osteon::simulation::cpu
#endif
