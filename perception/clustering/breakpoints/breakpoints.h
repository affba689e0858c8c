#pragma once

#include "perception/clustering/clusterer.h"

namespace roundabout::perception {

/// Segments as the adaptive breakpoints leave them, legs paired into people: first around the
/// places where somebody is expected, at most two a place and at least total squared distance; then
/// the nearest of the rest to each other.
std::unique_ptr<Clusterer> makeBreakpoints();

}  // namespace roundabout::perception
