#include "safety/energy_limits.h"

#include <stdexcept>
#include <string>

#include "base/number_text.h"

namespace osteon::safety {

void Validate(const EnergyLimitParams& params) {
  const auto positive = [](const char* name, double value) {
    if (!(value > 0.0))
      throw std::invalid_argument("energy limits: " + std::string(name) + ": found " +
                                  base::NumberText(value) + ", accepted > 0");
  };
  positive("max_stored_J", params.max_stored_J);
  positive("max_power_W", params.max_power_W);
  positive("max_kinetic_J", params.max_kinetic_J);
  positive("moving_mass_kg", params.moving_mass_kg);
}

}  // namespace osteon::safety
