#pragma once

#include <complex>
#include <cstddef>
#include <functional>
#include <span>

#include <Eigen/Core>

#include "studies/identify/least_squares.h"
#include "studies/identify/measured_response.h"

namespace osteon::studies {

/// A model of a response, by its parameters and the frequency [Hz].
using ResponseModel = std::function<std::complex<double>(const Eigen::VectorXd& p, double hz)>;

/// The rest of each line over its standard deviation: real and imaginary parts in turn, the first 2 n of
/// r.
void FillResiduals(std::span<const ResponseLine> lines, const ResponseModel& model, const Eigen::VectorXd& p,
                   Eigen::VectorXd& r);

/// Fits a model to measured lines; each line weighs by its standard deviation.
[[nodiscard]] LeastSquaresFit FitResponse(std::span<const ResponseLine> lines, const ResponseModel& model,
                                          const Eigen::VectorXd& start);

/// Chi^2 of such a fit over its degrees of freedom: about 1 where the model and the deviations are right.
[[nodiscard]] double Chi2Of(const LeastSquaresFit& fit, std::size_t lines);

}  // namespace osteon::studies
