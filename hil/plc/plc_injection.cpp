#include "hil/plc/plc_injection.h"

#include <stdexcept>
#include <string>

#include "base/scramble.h"

namespace osteon::hil {

PlcInjection::PlcInjection(PlcServer& server, const InjectionParams& params)
    : server_(server), schedule_(params, Wire::kPlc, Direction::kBoth), draws_(params.seed) {
  for (std::size_t i = 0; i < params.injections.size(); ++i) {
    const Injection& injection = params.injections[i];
    const WireFaults& faults = injection.faults;
    if (injection.wire == Wire::kPlc &&
        (faults.duplicate > 0.0 || faults.reorder > 0.0 || faults.corrupt > 0.0))
      throw std::invalid_argument(
          "injection " + std::to_string(i + 1) +
          ": found duplicate, reorder or corrupt on the PLC's wire, accepted silence, "
          "loss, delay and jitter: it is TCP");
  }
}

void PlcInjection::Step(rt::Nanoseconds now) {
  const WireFaults faults = schedule_.At(now);
  // the server hangs while a silence lasts
  if (faults.silence != before_.silence) {
    server_.SetHung(faults.silence);
    hangs_ += faults.silence ? 1 : 0;
  }
  if (faults.loss > 0.0 && before_.loss <= 0.0) {
    server_.DropConnections();
    ++drops_;
  }
  if (faults.delay > 0 || faults.jitter > 0 || before_.delay > 0 || before_.jitter > 0) {
    const double share = simulation::Uniform(simulation::MixBits(draws_ += simulation::kSplitMixStep));
    server_.DelayAnswers(faults.delay +
                         static_cast<rt::Nanoseconds>(static_cast<double>(faults.jitter) * share));
  }
  before_ = faults;
}

}  // namespace osteon::hil
