#pragma once

#include "session/procedure/unfinished.h"
#include "studies/assess/session_reading.h"

namespace osteon::studies {

using session::ToGoOfLastTool_mm;
using session::Unfinished;
using session::UnfinishedOf;

/// Says what is unfinished in a session, by its passes and by the bone left in the planned cavity.
[[nodiscard]] inline Unfinished UnfinishedOf(const AssessedSession& session) {
  return session::UnfinishedOf(session.plan.plan, session.file.passes, session.assessment.cavity);
}

}  // namespace osteon::studies
