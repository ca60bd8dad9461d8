#include "studies/assess/norms.h"

#include <algorithm>

#include <fmt/format.h>

#include "procedure/assessment/score.h"
#include "studies/assess/unfinished.h"

namespace osteon::studies {
namespace {

// Says why a session cannot be used for a norm; empty if it can be used.
std::string WhyNoNorm(const AssessedSession& session, bool guided) {
  if (session.guided() != guided)
    return fmt::format(
        "found a session {}, accepted sessions {} guidance, as the one that is assessed: guided sessions are "
        "not compared with others",
        GuidanceText(session), guided ? "with" : "without");
  if (const std::string text = UnfinishedOf(session).text; !text.empty())
    return fmt::format("found a session that is not finished ({}), accepted finished ones", text);
  if (!session.missing.empty())
    return fmt::format("found recordings that are not whole ({}), accepted whole ones", session.missing);
  return "";
}

}  // namespace

std::string GuidanceText(const AssessedSession& session) {
  return session.guided() ? fmt::format("with guidance (gain {:g})", session.guidance_gain)
                          : std::string("without guidance");
}

tl::expected<Norms, std::string> ReadNorms(const std::vector<std::filesystem::path>& folders, bool guided) {
  std::map<std::string, std::vector<double>> found;
  for (const std::filesystem::path& folder : folders) {
    const auto session = ReadAssessedSession(folder);
    if (!session) return tl::make_unexpected("--norms: " + session.error());
    if (const std::string why = WhyNoNorm(*session, guided); !why.empty())
      return tl::make_unexpected(fmt::format("--norms {}: {}", folder.string(), why));
    for (const auto& [name, value] : procedure::ValuesOf(session->plan.plan, session->assessment))
      found[name].push_back(value);
  }
  Norms norms;
  for (auto& [name, values] : found) {
    std::ranges::sort(values);
    const std::size_t n = values.size();
    norms[name] = {.median = 0.5 * (values[(n - 1) / 2] + values[n / 2]), .sessions = static_cast<int>(n)};
  }
  return norms;
}

}  // namespace osteon::studies
