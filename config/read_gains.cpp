#include "config/read_gains.h"

namespace osteon::config {
namespace {

// Which keys must be there: all of a cell's file, any of one that is laid over it.
enum class Keys { kAll, kAny };

bool Wants(Reader& section, Keys keys, const char* key) { return keys == Keys::kAll || section.Has(key); }

void ReadAdmittance(Reader section, Keys keys, control::AdmittanceParams& admittance) {
  const auto triple = [&](const char* key, double min, double max, Vector3& value) {
    if (Wants(section, keys, key)) value = section.Triple(key, min, max);
  };
  const auto number = [&](const char* key, double min, double max, double& value) {
    if (Wants(section, keys, key)) value = section.Number(key, min, max);
  };
  triple("mass_kg", 0.1, 50, admittance.mass_kg);
  triple("inertia_kg_m2", 0.001, 5, admittance.inertia_kg_m2);
  triple("damping_Ns_per_m", 1, 2000, admittance.damping_Ns_per_m);
  triple("damping_Nms_per_rad", 0.01, 100, admittance.damping_Nms_per_rad);
  number("dead_zone_N", 0, 50, admittance.dead_zone_N);
  number("dead_zone_Nm", 0, 5, admittance.dead_zone_Nm);
}

void ReadForces(Reader& section, Keys keys, control::CouplingParams& coupling) {
  const auto number = [&](const char* key, double min, double max, double& value) {
    if (Wants(section, keys, key)) value = section.Number(key, min, max);
  };
  number("stiffness_N_per_mm", 0.1, 100, coupling.max_stiffness_N_per_m);
  number("damping_Ns_per_m", 0, 2000, coupling.damping_Ns_per_m);
  number("damping_share_ratio", 0, 0.25, coupling.damping_share);
}

}  // namespace

void ReadAdmittance(Reader section, control::AdmittanceParams& admittance) {
  ReadAdmittance(section, Keys::kAll, admittance);
}

void ReadCoupling(Reader section, control::CouplingParams& coupling) {
  ReadForces(section, Keys::kAll, coupling);
  coupling.fresh_s = section.Number("fresh_ms", 1, 1000);
  coupling.gone_s = section.Number("gone_ms", 2, 1000);
  coupling.ramp_s = section.Number("ramp_ms", 1, 10000);
}

void LayGainsOver(const std::filesystem::path& file, control::AdmittanceParams& admittance,
                  control::CouplingParams& coupling) {
  Reader reader = Reader::Load(file);
  control::AdmittanceParams law = admittance;
  control::CouplingParams forces = coupling;
  if (reader.Has("admittance")) ReadAdmittance(reader.Section("admittance"), Keys::kAny, law);
  if (reader.Has("coupling")) {
    Reader section = reader.Section("coupling");
    ReadForces(section, Keys::kAny, forces);
  }
  reader.Finish();
  admittance = law;
  coupling = forces;
}

}  // namespace osteon::config
