#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <random>

#include "control/coupling/virtual_coupling.h"
#include "control/laws/admittance_law.h"
#include "control/stability/vibration_index.h"
#include "hil/loops/admittance_loop.h"

namespace osteon::studies {

/// Parameters of Model B as a simulation in time. It uses the shipped parts, and includes effects that the
/// matrix of hil::AdmittanceLoop leaves out.
struct AdmittanceRunParams {
  hil::AdmittanceLoopParams loop;
  /// Force with which the hand presses on the wall; without a wall there is no preload.
  double preload_N{60.0};
  double kick_m_per_s{1e-4};  ///< initial velocity of the virtual tool
  double command_loss{0.0};   ///< share of lost commands; the arm then keeps the last command that it got
  int command_jitter{0};      ///< largest additional delay of a command [ticks]; commands stay in order
  double seconds{4.0};        ///< length of the run; growth is measured over its second half
  std::uint64_t seed{1};
  double noise_N{0.0};  ///< RMS value of the sensor's noise
  /// Index that raises drag and mass; none: the law is not changed.
  std::optional<control::VibrationParams> vibration{};
};

/// State of the axis in a tick.
struct AxisTick {
  double x_m{0.0};     ///< position of the virtual tool, relative to its rest position
  double hand_N{0.0};  ///< force of the hand without its preload
  double wall_N{0.0};
  double index{0.0}, damping_factor{1.0}, reference_N{0.0};  ///< of the vibration index
  bool valid{true};                                          ///< false: the law refused its input
};

/// One axis of the cell, built of EvaluateCoupling on a plane (a wall that acts on commanded or measured
/// positions of a given age), VibrationIndex and StepAdmittance, ServoArm with its dead time, and the hand's
/// linear spring, damper and mass. Commands may get lost or come late. Deterministic.
class AdmittanceAxis {
 public:
  /// @throws std::invalid_argument on a parameter out of range.
  explicit AdmittanceAxis(const AdmittanceRunParams& params);

  [[nodiscard]] AxisTick Step();

 private:
  // The newest values of a signal; the present value is the first.
  class History {
   public:
    explicit History(int oldest) : values_(static_cast<std::size_t>(oldest) + 1, 0.0) {}
    void Push(double value) {
      values_.push_front(value);
      values_.pop_back();
    }
    [[nodiscard]] double at(int ticks_ago) const { return values_[static_cast<std::size_t>(ticks_ago)]; }

   private:
    std::deque<double> values_;
  };
  void SendCommand();
  [[nodiscard]] double HandForce();
  [[nodiscard]] double WallForce(std::int64_t tick);
  [[nodiscard]] double Uniform();  // from 0 to below 1

  AdmittanceRunParams params_;
  double preload_N_, rest_m_;  ///< rest_m_: position at which the wall balances the preload
  /// The axis is z of a rotated tool, so that the law's changes of frame are tested as well.
  Matrix3 R_WT_;
  hil::ServoArm arm_;
  double command_gain_;      ///< factor on commands: HeldArm::command_gain of the arm with this hand
  double arm_m_per_s_{0.0};  ///< the arm's velocity in the previous tick
  /// Force that the sensor measured; commanded position x_c and velocity v_c; sent x_c.
  History felt_, poses_, speeds_, commands_;
  double x_c_m_{0.0}, v_c_m_per_s_, told_arm_m_{0.0};  ///< told_arm_m_: last command that the arm got
  int late_{0};                                        ///< present additional delay of the commands [ticks]
  std::int64_t tick_{0};
  std::mt19937_64 bits_;
  control::CouplingParams coupling_;
  control::CouplingState coupling_state_;
  simulation::ContactModel plane_;
  control::AdmittanceParams law_;
  control::AdmittanceState tool_;
  std::optional<control::VibrationIndex> vibration_;
  double mass_factor_{1.0};
};

}  // namespace osteon::studies
