#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include "plugin/include/osteon.h"
#include "plugin/src/bone_source.h"
#include "plugin/src/plan.h"
#include "plugin/src/result.h"
#include "plugin/src/session.h"

// The objects to which the pointers of osteon.h lead.

struct OsteonBone {
  std::shared_ptr<const osteon::plugin::BoneSource> source;
};
struct OsteonTool {
  std::shared_ptr<const osteon::plugin::ToolSource> source;
};
struct OsteonPlan {
  osteon::plugin::PlanSource source;
};
struct OsteonGuidance {
  osteon::plugin::GuidanceTick tick;
};
struct OsteonSession {
  osteon::plugin::Session session;
  OsteonSession(std::shared_ptr<const osteon::plugin::BoneSource> bone,
                std::shared_ptr<const osteon::plugin::ToolSource> tool, const OsteonSettings& settings)
      : session(std::move(bone), std::move(tool), settings) {}
};

namespace osteon::plugin {

inline constexpr const char* kForked =
    "the process was forked: found a call in the child, accepted in the process that made the session";

/// Fills a caller's struct if the caller was compiled with this library's ABI; otherwise fails.
template <class Params>
OsteonResult Init(std::uint32_t abi, Params* params, void (*fill)(Params*)) noexcept {
  return Guarded([&] {
    CheckAbi(abi);
    CheckPointer(params, "params");
    fill(params);
  });
}

/// Calls `call` with the session. In a forked child, where the session has no threads, it fails instead.
template <class Call>
OsteonResult WithSession(OsteonSession* session, const Call& call) noexcept {
  return Guarded([&] {
    CheckPointer(session, "session");
    if (session->session.is_forked()) throw Failure(OSTEON_ERROR_FORK, kForked);
    call(session->session);
  });
}

}  // namespace osteon::plugin
