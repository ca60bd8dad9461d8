#include "config/reading/sections/read_calibration.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "config/reading/strict/reader.h"

namespace osteon::config {
namespace {

// Largest accepted differences of a calibration from the tool's file. The mass may differ by the larger of
// kMaxMassOff_kg and kMaxMassOffShare × the file's mass.
constexpr double kMaxMassOff_kg = 0.5, kMaxMassOffShare = 0.5, kMaxCenterOff_m = 0.05, kMaxApexOff_m = 0.02;

// Reads section `payload`: the mass, centre of mass and bias that the loop subtracts from the sensor's
// wrench.
void ReadPayload(Reader section, control::ForceSensorParams& sensor) {
  const double mass_kg = section.Number("mass_kg", 0.001, 100);
  const double max_off_kg = std::max(kMaxMassOff_kg, kMaxMassOffShare * sensor.tool_mass_kg);
  if (!(std::abs(mass_kg - sensor.tool_mass_kg) <= max_off_kg))
    section.Refuse("mass_kg",
                   fmt::format("found {:g} kg, accepted {:.3g} ± {:.3g} kg, which the tool's file gives",
                               mass_kg, sensor.tool_mass_kg, max_off_kg));
  const Vector3 center_F_m = section.Triple("center_mm", -1000, 1000);
  const double off_m = (center_F_m - Vector3(sensor.tool_center_F_m)).norm();
  if (!(off_m <= kMaxCenterOff_m))
    section.Refuse(
        "center_mm",
        fmt::format("found a centre {:.0f} mm from where the tool's file has it, accepted up to {:g} mm",
                    1e3 * off_m, 1e3 * kMaxCenterOff_m));
  sensor.tool_mass_kg = mass_kg;
  sensor.tool_center_F_m = center_F_m;
  sensor.bias_S = Wrench{.f = section.Triple("bias_N", -200, 200), .t = section.Triple("bias_Nm", -20, 20)};
}

}  // namespace

void ApplyCalibration(const std::filesystem::path& file, CellConfig& cell) {
  Reader reader = Reader::Load(file);
  if (reader.Has("payload")) ReadPayload(reader.Section("payload"), cell.servo.sensor);
  if (reader.Has("tcp_mm")) {
    const Vector3 p_FT_m = reader.Triple("tcp_mm", -1000, 1000);
    const double off_m = (p_FT_m - cell.tool.X_FT.translation()).norm();
    if (!(off_m <= kMaxApexOff_m))
      reader.Refuse(
          "tcp_mm",
          fmt::format("found an apex {:.1f} mm from where the tool's file has it, accepted up to {:g} mm",
                      1e3 * off_m, 1e3 * kMaxApexOff_m));
    cell.tool.X_FT.translation() = p_FT_m;
  }
  reader.Finish();
}

}  // namespace osteon::config
