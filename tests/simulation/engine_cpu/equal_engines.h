#pragma once

#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "simulation/engine/reference_engine.h"
#include "simulation/engine_cpu/cpu_engine.h"

// Steps several engines with the same inputs and compares them bit for bit: the reference engine, with and
// without neighbour lists, and the CPU engine with each instruction set.

namespace osteon::simulation {

/// Whether every number of two models is equal bit for bit; padding bytes are not compared.
inline bool Identical(const ContactModel& a, const ContactModel& b) {
  const auto same = [](const auto& x, const auto& y) { return std::memcmp(&x, &y, sizeof x) == 0; };
  bool equal = same(a.X_WP, b.X_WP) && a.contact_count == b.contact_count && a.status == b.status &&
               same(a.n_W, b.n_W) && same(a.contact_fraction, b.contact_fraction) &&
               same(a.p_WS_m, b.p_WS_m) && same(a.F_T_W, b.F_T_W) &&
               same(a.advance_m_per_s, b.advance_m_per_s) && same(a.engaged_area_m2, b.engaged_area_m2) &&
               same(a.spindle_torque_Nm, b.spindle_torque_Nm) &&
               same(a.removed_volume_m3, b.removed_volume_m3) && same(a.removed_mass_kg, b.removed_mass_kg) &&
               same(a.cutting_work_J, b.cutting_work_J) && a.balls_not_split == b.balls_not_split &&
               a.pose_stamp == b.pose_stamp && a.frame == b.frame;
  for (std::size_t i = 0; i < a.contacts.size(); ++i) {
    const Contact &p = a.contacts[i], &q = b.contacts[i];
    equal = equal && same(p.p_TP_m, q.p_TP_m) && same(p.p_W_m, q.p_W_m) && same(p.n_W, q.n_W) &&
            same(p.gap_m, q.gap_m) && same(p.stiffness_N_per_m, q.stiffness_N_per_m) && same(p.mu, q.mu) &&
            same(p.advance_m_per_s, q.advance_m_per_s) && same(p.weight, q.weight) &&
            p.material == q.material;
  }
  return equal;
}

/// The names of the fields that differ, for a failure's message.
inline std::string DifferencesOf(const ContactModel& a, const ContactModel& b) {
  std::string names;
  const auto note = [&](const char* name, const auto& x, const auto& y) {
    if (std::memcmp(&x, &y, sizeof x) != 0) names += std::string(" ") + name;
  };
  note("contact_fraction", a.contact_fraction, b.contact_fraction), note("n_W", a.n_W, b.n_W);
  note("p_WS_m", a.p_WS_m, b.p_WS_m), note("F_T_W", a.F_T_W, b.F_T_W), note("X_WP", a.X_WP, b.X_WP);
  note("engaged_area_m2", a.engaged_area_m2, b.engaged_area_m2);
  note("advance_m_per_s", a.advance_m_per_s, b.advance_m_per_s);
  note("removed_volume_m3", a.removed_volume_m3, b.removed_volume_m3);
  note("contact_count", a.contact_count, b.contact_count);
  for (std::size_t i = 0; i < a.contacts.size(); ++i) {
    note("contact n", a.contacts[i].n_W, b.contacts[i].n_W);
    note("contact p", a.contacts[i].p_TP_m, b.contacts[i].p_TP_m);
    note("contact gap", a.contacts[i].gap_m, b.contacts[i].gap_m);
  }
  return names;
}

/// Whether every number of two carved states is equal bit for bit.
inline bool Identical(const CarvedState& a, const CarvedState& b) {
  const auto same = [](const auto& x, const auto& y) { return std::memcmp(&x, &y, sizeof x) == 0; };
  const auto same_list = [](const auto& x, const auto& y) {
    return x.size() == y.size() &&
           (x.empty() || std::memcmp(x.data(), y.data(), x.size() * sizeof x[0]) == 0);
  };
  bool equal = same_list(a.balls, b.balls) && a.cleared == b.cleared && a.split_balls == b.split_balls &&
               a.split_cuts == b.split_cuts && same_list(a.split_slots, b.split_slots) &&
               same(a.X_GP, b.X_GP) && a.has_proxy == b.has_proxy &&
               same(a.removed_volume_m3, b.removed_volume_m3) && same(a.removed_mass_kg, b.removed_mass_kg) &&
               same(a.cutting_work_J, b.cutting_work_J) && same(a.cutting_debt_J, b.cutting_debt_J) &&
               a.frame == b.frame && a.contact.pair_count == b.contact.pair_count &&
               a.contact.held_count == b.contact.held_count && a.contact.face_count == b.contact.face_count &&
               same(a.contact.friction, b.contact.friction);
  for (std::size_t i = 0; i < static_cast<std::size_t>(a.contact.pair_count); ++i)
    equal = equal && a.contact.pairs[i] == b.contact.pairs[i];
  for (std::size_t i = 0; i < static_cast<std::size_t>(a.contact.face_count); ++i)
    equal = equal && same(a.contact.face_n_G[i], b.contact.face_n_G[i]);
  return equal;
}

/// Facts that show that a run was worth comparing: engines that do nothing would be equal as well.
struct RunFacts {
  int touching{0};
  double max_force_N{0.0};
  std::size_t balls_cut{0}, points_cleared{0}, split{0};
};

/// Engines of one bone and tool that must stay equal.
class EqualEngines {
 public:
  /// @param sets  instruction sets of the CPU engines. If given, a reference engine that visits all balls is
  /// compared too. Empty: all instruction sets of the processor, and no engine that visits all balls, because
  /// it would be too slow
  EqualEngines(Bone bone, const Tool& tool, const CuttingParams& params = {},
               const Pose& X_WG = Pose::Identity(), const std::vector<std::string>& sets = {})
      : bone_(std::move(bone)), reference_(bone_, tool, X_WG, params) {
    for (const std::string& set : sets.empty() ? CpuInstructionSets() : sets)
      engines_.push_back(
          std::make_unique<CpuEngine>(bone_, tool, X_WG, params, CpuParams{.instruction_set = set}));
    if (!sets.empty())
      engines_.push_back(
          std::make_unique<ReferenceEngine>(bone_, tool, X_WG, params, ReferenceEngine::Loops::kAll));
  }

  /// One frame. @returns whether all engines gave the same bits.
  [[nodiscard]] bool Step(const FrameInput& input) {
    model_ = reference_.Step(input);
    facts_.touching += model_.contact_count > 0 ? 1 : 0;
    facts_.max_force_N = std::max(facts_.max_force_N, Vector3(model_.F_T_W.f).norm());
    bool equal = true;
    for (const auto& engine : engines_) {
      const ContactModel model = engine->Step(input);
      if (Identical(model_, model)) continue;
      equal = false;
      differences_ += engine->device() + " differs in" + DifferencesOf(model_, model) + "\n";
    }
    return equal;
  }
  /// The engines that differed, each with the names of the fields.
  [[nodiscard]] const std::string& differences() const { return differences_; }
  [[nodiscard]] const ContactModel& model() const { return model_; }

  /// Whether all carved states are equal; fills facts() from the reference's state.
  [[nodiscard]] bool SameStates() {
    const CarvedState state = reference_.Snapshot();
    facts_.balls_cut = facts_.points_cleared = 0;
    for (std::size_t i = 0; i < bone_.balls.size(); ++i)
      facts_.balls_cut += state.balls[4 * i + 3] < static_cast<float>(bone_.balls[i].radius_m * 1e3) ? 1 : 0;
    for (const std::uint8_t cleared : state.cleared) facts_.points_cleared += cleared;
    facts_.split = state.split_balls.size();
    bool equal = true;
    for (const auto& engine : engines_) equal = Identical(state, engine->Snapshot()) && equal;
    return equal;
  }
  [[nodiscard]] const RunFacts& facts() const { return facts_; }

  /// Restores all engines, the reference too, from the reference's state. Split balls then get new numbers,
  /// and the order of summation changes.
  void RestoreAll() {
    const CarvedState state = reference_.Snapshot();
    reference_.Restore(state);
    for (const auto& engine : engines_) engine->Restore(state);
  }

 private:
  Bone bone_;
  ReferenceEngine reference_;
  std::vector<std::unique_ptr<CuttingEngine>> engines_;
  ContactModel model_;
  RunFacts facts_;
  std::string differences_;
};

}  // namespace osteon::simulation
