#include "studies/identify/response_fit.h"

namespace osteon::studies {

void FillResiduals(std::span<const ResponseLine> lines, const ResponseModel& model, const Eigen::VectorXd& p,
                   Eigen::VectorXd& r) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::complex<double> residual = (lines[i].value - model(p, lines[i].hz)) / lines[i].sd;
    r[2 * static_cast<Eigen::Index>(i)] = residual.real();
    r[2 * static_cast<Eigen::Index>(i) + 1] = residual.imag();
  }
}

LeastSquaresFit FitResponse(std::span<const ResponseLine> lines, const ResponseModel& model,
                            const Eigen::VectorXd& start) {
  const auto residuals = [&](const Eigen::VectorXd& p, Eigen::VectorXd& r) {
    FillResiduals(lines, model, p, r);
  };
  return Solve({.parameters = static_cast<int>(start.size()),
                .residuals = 2 * static_cast<int>(lines.size()),
                .evaluate = residuals},
               start);
}

double Chi2Of(const LeastSquaresFit& fit, std::size_t lines) {
  return fit.cost / (2.0 * static_cast<double>(lines) - static_cast<double>(fit.parameters.size()));
}

}  // namespace osteon::studies
