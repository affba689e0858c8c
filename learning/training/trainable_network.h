#pragma once

#include "learning/training/batch.h"
#include "learning/training/parameters.h"

namespace roundabout::learning {

/// A network of planner::Ga3cCadrlWeights, to be trained: forward and back over whole batches, on
/// scratch memory of its own. Its parameters are somebody else's. One object for each thread.
class TrainableNetwork {
 public:
  virtual ~TrainableNetwork() = default;

  /// A row for each observation: the actions' scores, then the value. Valid until the next call.
  virtual const Matrix& forward(const Parameters& parameters, const Batch& batch) = 0;
  /// Adds to `gradient` that of sum(d_heads * heads), after forward() with the same arguments.
  virtual void backward(const Parameters& parameters, const Batch& batch, const Matrix& d_heads,
                        Parameters& gradient) = 0;
};

}  // namespace roundabout::learning
