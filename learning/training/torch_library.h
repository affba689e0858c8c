#pragma once

#include <map>
#include <memory>
#include <string>

#include "learning/training/trainable_network.h"

// What `roundabout_torch`, the one library that is linked with libtorch, and the program that loads
// it agree on.

namespace roundabout::learning {

/// What it builds a network from.
struct TorchPlan {
  std::string architecture;
  int max_others = 0;
  std::map<std::string, ParameterLayout::Layer, std::less<>> layers;
};

/// The network as a graph of libtorch's operations, differentiated by libtorch: any architecture
/// that the planner flies. The library is loaded at the first call, because libtorch takes half a
/// second and 300 shared objects to start, which nobody but training should pay. Throws
/// core::StartupError if it cannot be loaded.
std::unique_ptr<TrainableNetwork> makeTorchNetwork(const TorchPlan& plan);

inline constexpr const char* kTorchLibrary = "libroundabout_torch.so";
inline constexpr const char* kMakeTorchNetwork = "roundaboutMakeTorchNetwork";
/// Whoever calls it owns what it returns. Throws as libtorch does.
using MakeTorchNetwork = TrainableNetwork*(const TorchPlan&);

}  // namespace roundabout::learning
