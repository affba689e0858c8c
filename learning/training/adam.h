#pragma once

#include "learning/training/parameters.h"

namespace roundabout::learning {

/// Adam (Kingma and Ba 2015).
struct Adam {
  static constexpr double kFirstDecay = 0.9;

  double second_decay = 0.99;
  double epsilon = 1e-6;

  Parameters first;   ///< running mean of the gradient
  Parameters second;  ///< running mean of its square
  long updates = 0;

  explicit Adam(Eigen::Index size)
      : first(Parameters::Zero(size)), second(Parameters::Zero(size)) {}

  void update(const Parameters& gradient, double learning_rate, Parameters& parameters);
};

}  // namespace roundabout::learning
