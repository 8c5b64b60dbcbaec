#pragma once

#include <Eigen/Core>
#include <functional>

#include "recon/setup/factor.hpp"
#include "recon/setup/gram_matrix.hpp"

namespace compueye::recon {

// How long set-up will take, in seconds on all cores, by estimate: the same work is done on something small, timed, and
// scaled up. Right to a factor of about two; 0 where it cannot be long.

/// How many of them share set-up's work.
[[nodiscard]] double cores();

/// Of work as it stands, the second time, when memory and caches are what they will be.
[[nodiscard]] double seconds_of_trial(const std::function<void()>& work);

/// Work on a matrix of `order` whose operations grow as order^power, as work(order) does it.
[[nodiscard]] double seconds_of(Eigen::Index order, double power, const std::function<void(Eigen::Index order)>& work);

/// Of gram.fill(), by one row.
[[nodiscard]] double seconds_to_fill(const ParityGram& gram);

/// Of work that is cubic in the order of each class, a core a class.
[[nodiscard]] double seconds_of_classes(const ParityClasses& classes,
                                        const std::function<double(std::size_t parity_class)>& seconds);

/// Of symmetric_modes().
[[nodiscard]] double seconds_of_all_modes(Eigen::Index order);

/// Says so where it is more than a person would wait without a word.
void expect_set_up(const Progress& progress, double seconds);

/// A symmetric positive definite matrix without structure, to try work on.
[[nodiscard]] Eigen::MatrixXd matrix_to_try(Eigen::Index order);

}  // namespace compueye::recon
