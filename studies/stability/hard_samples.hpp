#pragma once

#include "studies/stability/hard_case.hpp"

namespace compueye::firmware {

// Changes that make samples hard. Channels that are singled out are evenly spread.

/// Every sample times `amount`.
void all_times(HardProblem& problem, double amount);
/// The middle sample `amount` times the rms of all.
void one_outlier(HardProblem& problem, double amount);
/// Nothing reads more than `amount` times the largest.
void saturated(HardProblem& problem, double amount);
/// A share of the channels reads nought, and nobody knows.
void dead_unknown(HardProblem& problem, double amount);
/// A share of the channels reads ten times the rms, and nobody knows.
void hot_unknown(HardProblem& problem, double amount);
/// A share of the channels reads NaN, and has no weight.
void dead_known(HardProblem& problem, double amount);
/// A share of the channels reads infinity, and has no weight.
void hot_known(HardProblem& problem, double amount);
/// Weights from 1 down to `amount`.
void weight_spread(HardProblem& problem, double amount);
/// Only the middle channel is left a weight.
void one_channel(HardProblem& problem, double amount);
/// Samples that have nothing to do with any picture.
void unrelated(HardProblem& problem, double amount);

}  // namespace compueye::firmware
