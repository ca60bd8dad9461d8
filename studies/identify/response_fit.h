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

/// Fills the first 2 n elements of r with each line's residual divided by its standard deviation, real and
/// imaginary parts in turn.
void FillResiduals(std::span<const ResponseLine> lines, const ResponseModel& model, const Eigen::VectorXd& p,
                   Eigen::VectorXd& r);

/// Fits a model to measured lines. Each line is weighted by its standard deviation.
[[nodiscard]] LeastSquaresFit FitResponse(std::span<const ResponseLine> lines, const ResponseModel& model,
                                          const Eigen::VectorXd& start);

/// Chi^2 of a fit over its degrees of freedom: about 1 if the model and the standard deviations are right.
[[nodiscard]] double Chi2Of(const LeastSquaresFit& fit, std::size_t lines);

}  // namespace osteon::studies
