#include "app/fidelity_options.h"

#include "app/usage.h"

namespace osteon::app {

void AddFidelityOptions(CLI::App& app, FidelityChoice& choice) {
  auto* as_packed = app.add_flag("--as-packed", choice.as_packed,
                                 "the scene's own packing, whatever it costs, instead of a planned one");
  const auto add = [&](const char* name, const char* what, double min, double max, auto&& put) {
    app.add_option_function<double>(name, put, what)->check(NumberWithin(min, max))->excludes(as_packed);
  };
  add("--error-mm", "mean depth that a cut may be off the tool's sweep, instead of the scene's (osteon plan)",
      0.001, 5, [&choice](double mm) { choice.error_m = 1e-3 * mm; });
  add("--rate-hz",
      "frames a second, instead of the scene's: where they keep taking longer, zones are coarsened", 1, 100e3,
      [&choice](double hz) { choice.rate_hz = hz; });
}

}  // namespace osteon::app
