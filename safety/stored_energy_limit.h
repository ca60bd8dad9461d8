#pragma once

#include "base/marker.h"

namespace osteon::safety {

/// Bounds the energy that the coupling's spring can give back, however deep the tool is pressed into bone. f
/// is the spring's force, d its displacement, E the bound:
///
///     k   = f·d / |d|^2            stiffness along d
///     d_E = sqrt(2 E / k)          displacement at which the spring stores E
///     d_s = clamp(d_s, |d| - d_E, |d|)
///     rendered force = f (|d| - d_s) / |d|
///
/// If the tool goes in beyond d_E, the rest position d_s slips with it, as in dry friction, and the force
/// stays at sqrt(2 E k). If the tool comes out, d_s stays, and the force falls to zero within d_E, so at most
/// E is given back. A limit on the force alone is not enough: a force that stays at its limit over 0.1 m
/// would give back its whole work over that distance.
class StoredEnergyLimit {
 public:
  /// @param max_stored_J > 0; infinite: no bound
  explicit StoredEnergyLimit(double max_stored_J) : max_stored_J_(max_stored_J) {}

  /// Computes one tick. @param displacement_m  |d|, >= 0  @param energy_J  energy of the spring without the
  /// bound, f·d / 2
  /// @returns the share of the spring's wrench to render, 0 … 1
  [[nodiscard]] double Step(double displacement_m, double energy_J) OSTEON_RT;

  /// Resets the rest position to d_s = 0. Call it when rendering starts.
  void Reset() OSTEON_RT { slip_m_ = 0.0; }

 private:
  double max_stored_J_;
  double slip_m_{0.0};  // d_s
};

}  // namespace osteon::safety
