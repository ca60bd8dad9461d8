#pragma once

#include <rapidcheck.h>

#include <cmath>
#include <limits>
#include <ostream>
#include <vector>

// Generates operations on a cell for property tests, one for each tick: the operation, its target, and a
// value that may be extreme or not finite.

namespace osteon::property {

inline constexpr int kMaxTicks = 50;  ///< length of a case: 50 ms at 1 kHz

/// One operation on a cell, in one tick.
struct Op {
  int what{0};   ///< number of the operation; 0 does nothing: failing cases shrink toward it
  int which{0};  ///< target of the operation, 0 … 6: for example one of seven joints
  double value{0.0};
};
inline void showValue(const Op& op, std::ostream& out) {
  out << "{" << op.what << ", " << op.which << ", " << op.value << "}";
}

/// Generates values from 1e-7 to 100 of either sign, and special ones: NaN, infinities, extremes. Shrinks
/// toward 0.
inline rc::Gen<double> WildValue() {
  constexpr int kSteps = 900;  // a hundred per decade
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const auto of_step = [](int step) {
    const double size = std::pow(10.0, (step / 2) / 100.0 - 7.0);
    return step == 0 ? 0.0 : step % 2 == 0 ? size : -size;
  };
  return rc::gen::weightedOneOf<double>(
      {{9, rc::gen::map(rc::gen::resize(100, rc::gen::inRange(0, 2 * kSteps + 1)), of_step)},
       {1, rc::gen::element(std::numeric_limits<double>::quiet_NaN(), kInf, -kInf, 1e308, -1e308,
                            std::numeric_limits<double>::denorm_min(), 6.283185307179586, -0.0)}});
}

/// Generates one operation per tick: 75 % do nothing, 20 % push the tool, so that the remaining 5 %, which
/// are errors, occur in a moving cell.
/// @param pushes, kinds  Op::what is below `kinds`; the operations from `pushes` on push the tool
inline rc::Gen<std::vector<Op>> WildOps(int pushes, int kinds) {
  const auto among = [](int from, int to) { return rc::gen::resize(100, rc::gen::inRange(from, to)); };
  return rc::gen::container<std::vector<Op>>(
      kMaxTicks,
      rc::gen::build<Op>(rc::gen::set(&Op::what, rc::gen::weightedOneOf<int>({{75, rc::gen::just(0)},
                                                                              {20, among(pushes, kinds)},
                                                                              {5, among(0, pushes)}})),
                         rc::gen::set(&Op::which, among(0, 7)), rc::gen::set(&Op::value, WildValue())));
}

}  // namespace osteon::property
