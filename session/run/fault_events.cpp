#include "session/run/fault_events.h"

#include <string>

#include "session/summary/each_fault.h"

namespace osteon::session {

void FaultEvents::Record(io::Recorder& recorder, rt::Nanoseconds stamp, std::uint32_t faults) {
  if (faults == 0) return;
  const std::uint32_t found = faults & ~known_.fetch_or(faults);
  ForEachFault([&](safety::Fault fault, const safety::FaultText& text) {
    if ((found & static_cast<std::uint32_t>(fault)) != 0)
      recorder.PushEvent(stamp, std::string("fault: ") + text.name + "; " + text.reaction);
  });
}

}  // namespace osteon::session
