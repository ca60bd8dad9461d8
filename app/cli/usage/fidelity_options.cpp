#include "app/cli/usage/fidelity_options.h"

#include "app/cli/usage/usage.h"

namespace osteon::app {

void AddFidelityOptions(CLI::App& app, session::FidelityChoice& choice) {
  auto* as_packed =
      app.add_flag("--as-packed", choice.as_packed,
                   "use the scene's own packing, whatever a frame then takes, instead of a planned one");
  const auto add = [&](const char* name, const char* what, double min, double max, auto&& put) {
    app.add_option_function<double>(name, put, what)->check(NumberWithin(min, max))->excludes(as_packed);
  };
  add("--error-mm", "accepted mean depth error of a cut, instead of the scene's (osteon plan)", 0.001, 5,
      [&choice](double mm) { choice.error_m = 1e-3 * mm; });
  add("--rate-hz",
      "frames per second, instead of the scene's; zones whose frames keep taking longer are made coarser", 1,
      100e3, [&choice](double hz) { choice.rate_hz = hz; });
}

}  // namespace osteon::app
