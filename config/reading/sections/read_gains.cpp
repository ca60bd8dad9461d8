#include "config/reading/sections/read_gains.h"

#include <algorithm>

#include <fmt/format.h>

namespace osteon::config {
namespace {

// Which keys must be present. kAll: every key, in a cell's file. kAny: any subset, in a file that overrides a
// cell's gains.
enum class Keys { kAll, kAny };

// Whether to read a key. With kAll an absent key is read too, so that Finish() reports it.
bool ShouldRead(Reader& section, Keys keys, const char* key) {
  return keys == Keys::kAll || section.Has(key);
}

// Reads the virtual tool's mass, inertia, damping and dead zones: the keys of `admittance` that are gains.
void ReadAdmittanceGains(Reader& section, Keys keys, control::AdmittanceParams& admittance) {
  const auto read_triple = [&](const char* key, double min, double max, Vector3& value) {
    if (ShouldRead(section, keys, key)) value = section.Triple(key, min, max);
  };
  const auto read_number = [&](const char* key, double min, double max, double& value) {
    if (ShouldRead(section, keys, key)) value = section.Number(key, min, max);
  };
  read_triple("mass_kg", 0.1, 50, admittance.mass_kg);
  read_triple("inertia_kg_m2", 0.001, 5, admittance.inertia_kg_m2);
  read_triple("damping_Ns_per_m", 1, 2000, admittance.damping_Ns_per_m);
  read_triple("damping_Nms_per_rad", 0.01, 100, admittance.damping_Nms_per_rad);
  read_number("dead_zone_N", 0, 50, admittance.dead_zone_N);
  read_number("dead_zone_Nm", 0, 5, admittance.dead_zone_Nm);
}

// Reads the coupling's stiffness and damping: the keys of `coupling` that are gains.
void ReadCouplingGains(Reader& section, Keys keys, control::CouplingParams& coupling) {
  const auto read_number = [&](const char* key, double min, double max, double& value) {
    if (ShouldRead(section, keys, key)) value = section.Number(key, min, max);
  };
  read_number("stiffness_N_per_mm", 0.1, 100, coupling.max_stiffness_N_per_m);
  read_number("damping_Ns_per_m", 0, 2000, coupling.damping_Ns_per_m);
  read_number("damping_share_ratio", 0, 0.25, coupling.damping_share);
}

}  // namespace

void ReadAdmittance(Reader section, control::AdmittanceParams& admittance) {
  ReadAdmittanceGains(section, Keys::kAll, admittance);
  if (section.Has("centre_m")) admittance.centre_T_m = section.Triple("centre_m", -2, 2);
  if (section.Has("locked"))
    for (const std::size_t axis : section.Words("locked", {"x", "y", "z", "rx", "ry", "rz"}))
      admittance.locked[axis] = true;
}

void ReadCoupling(Reader section, control::CouplingParams& coupling) {
  ReadCouplingGains(section, Keys::kAll, coupling);
  coupling.fresh_s = section.Number("fresh_ms", 1, 1000);
  coupling.gone_s = section.Number("gone_ms", 2, 1000);
  coupling.ramp_s = section.Number("ramp_ms", 1, 10000);
}

void ApplyGainsFile(const std::filesystem::path& file, control::Law law,
                    control::AdmittanceParams& admittance, control::CouplingParams& coupling,
                    double max_stiffness_N_per_m) {
  Reader reader = Reader::Load(file);
  if (law == control::Law::kImpedance && reader.Has("admittance"))
    reader.Refuse(
        "admittance",
        "found for a cell with the impedance law, which has no virtual tool; accepted coupling alone");
  // work on copies, so that an error leaves the caller's gains unchanged
  control::AdmittanceParams new_admittance = admittance;
  control::CouplingParams new_coupling = coupling;
  if (reader.Has("admittance")) {
    Reader section = reader.Section("admittance");
    ReadAdmittanceGains(section, Keys::kAny, new_admittance);
  }
  if (reader.Has("coupling")) {
    Reader section = reader.Section("coupling");
    ReadCouplingGains(section, Keys::kAny, new_coupling);
    if (section.Has("stiffness_N_per_mm") && new_coupling.max_stiffness_N_per_m > max_stiffness_N_per_m)
      section.Refuse(
          "stiffness_N_per_mm",
          fmt::format("found {:.10g}, accepted at most {:.10g} while it runs: what it was started with",
                      1e-3 * new_coupling.max_stiffness_N_per_m, 1e-3 * max_stiffness_N_per_m));
  }
  reader.Finish();
  admittance = new_admittance;
  coupling = new_coupling;
}

control::Gains ReadGainsAgain(const std::filesystem::path& file, control::Law law, const control::Gains& own,
                              double max_stiffness_N_per_m) {
  control::AdmittanceParams admittance;
  control::CouplingParams coupling;
  control::ApplyGains(own, admittance, coupling);
  ApplyGainsFile(file, law, admittance, coupling, max_stiffness_N_per_m);
  // If the gains file has a stiffness, it is at most the maximum. If not, the cell's own stiffness is used,
  // which may exceed the maximum.
  coupling.max_stiffness_N_per_m = std::min(coupling.max_stiffness_N_per_m, max_stiffness_N_per_m);
  return control::GainsOf(admittance, coupling);
}

}  // namespace osteon::config
