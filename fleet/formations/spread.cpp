#include "fleet/formations/spread.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace roundabout::fleet {

namespace {

constexpr double kSampleStep = 0.02;    // of the height of a capital
constexpr double kCornerCosine = 0.76;  // a turn of more than 40 degrees is a corner
constexpr double kSalientShare = 2.0;   // a corner weighs as much as this share of a point's stroke
constexpr double kSamePlace = 1e-6;
constexpr int kMaxRounds = 100;

/// A place where a point may be, and how much of the shape it stands for.
struct Sample {
  Eigen::Vector2d position;
  double weight;
  bool salient;
};

bool closed(const Stroke& stroke) { return (stroke.front() - stroke.back()).norm() < kSamePlace; }

bool corner(const Eigen::Vector2d& before, const Eigen::Vector2d& at,
            const Eigen::Vector2d& after) {
  return (at - before).normalized().dot((after - at).normalized()) < kCornerCosine;
}

/// An end of an open stroke, or a corner.
bool salient(const Stroke& stroke, std::size_t i) {
  const std::size_t last = stroke.size() - 1;
  if (i > 0 && i < last) {
    return corner(stroke[i - 1], stroke[i], stroke[i + 1]);
  }
  return !closed(stroke) || corner(stroke[last - 1], stroke[0], stroke[1]);
}

void addSample(std::vector<Sample>& samples, const Sample& sample) {
  const auto same = std::find_if(samples.begin(), samples.end(), [&](const Sample& other) {
    return (other.position - sample.position).norm() < kSamePlace;
  });
  if (same == samples.end()) {
    samples.push_back(sample);
  } else {
    same->weight += sample.weight;
    same->salient = same->salient || sample.salient;
  }
}

std::vector<Sample> samplesOf(const std::vector<Stroke>& strokes) {
  std::vector<Sample> samples;
  for (const Stroke& stroke : strokes) {
    for (std::size_t i = 0; i < stroke.size(); ++i) {
      addSample(samples, {stroke[i], 0.0, salient(stroke, i)});
      if (i + 1 == stroke.size()) {
        break;
      }
      const Eigen::Vector2d leg = stroke[i + 1] - stroke[i];
      const double pieces = std::max(1.0, std::ceil(leg.norm() / kSampleStep));
      for (double piece = 0.5; piece < pieces; piece += 1.0) {
        addSample(samples, {stroke[i] + leg * (piece / pieces), leg.norm() / pieces, false});
      }
    }
  }
  return samples;
}

/// Indices of samples.
using Chosen = std::vector<std::size_t>;

double squaredDistance(const Sample& a, const Sample& b) {
  return (a.position - b.position).squaredNorm();
}

struct Nearest {
  std::size_t index;  ///< into the chosen
  double squared_distance;
};

Nearest nearest(const std::vector<Sample>& samples, const Chosen& chosen, std::size_t from) {
  Nearest best{0, std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const double distance = squaredDistance(samples[from], samples[chosen[i]]);
    if (distance < best.squared_distance) {
      best = {i, distance};
    }
  }
  return best;
}

/// Farthest-point sampling, beginning with `first`.
Chosen farthestPoints(const std::vector<Sample>& samples, std::size_t first, std::size_t count) {
  Chosen chosen{first};
  while (chosen.size() < count) {
    std::size_t best = 0;
    double best_distance = -1.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double distance = nearest(samples, chosen, i).squared_distance;
      if (distance > best_distance + kSamePlace) {
        best = i;
        best_distance = distance;
      }
    }
    chosen.push_back(best);
  }
  return chosen;
}

/// The member of a cell with the least weighted squared distance to all members: the one nearest
/// to their weighted mean.
std::size_t medoid(const std::vector<Sample>& samples, const std::vector<std::size_t>& cell,
                   std::size_t current) {
  Sample mean{Eigen::Vector2d::Zero(), 0.0, false};
  for (const std::size_t i : cell) {
    mean.position += samples[i].weight * samples[i].position;
    mean.weight += samples[i].weight;
  }
  mean.position /= mean.weight;
  std::size_t best = current;
  for (const std::size_t i : cell) {
    if (squaredDistance(samples[i], mean) < squaredDistance(samples[best], mean) - kSamePlace) {
      best = i;
    }
  }
  return best;
}

/// Weighted squared distance of the whole shape to the chosen.
double cost(const std::vector<Sample>& samples, const Chosen& chosen) {
  double sum = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    sum += samples[i].weight * nearest(samples, chosen, i).squared_distance;
  }
  return sum;
}

/// Lloyd's iteration with medoids: moves each point to the middle of what it is nearest to.
Chosen settle(const std::vector<Sample>& samples, Chosen chosen) {
  for (int round = 0; round < kMaxRounds; ++round) {
    std::vector<std::vector<std::size_t>> cells(chosen.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
      cells[nearest(samples, chosen, i).index].push_back(i);
    }
    Chosen moved;
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      moved.push_back(cells[k].empty() ? chosen[k] : medoid(samples, cells[k], chosen[k]));
    }
    if (moved == chosen) {
      break;
    }
    chosen = moved;
  }
  return chosen;
}

std::vector<Eigen::Vector2d> positionsOf(const std::vector<Sample>& samples, const Chosen& chosen) {
  std::vector<Eigen::Vector2d> positions;
  for (const std::size_t i : chosen) {
    positions.push_back(samples[i].position);
  }
  return positions;
}

}  // namespace

std::vector<Eigen::Vector2d> spreadForShape(const std::vector<Stroke>& strokes, std::size_t count) {
  std::vector<Sample> samples = samplesOf(strokes);
  double length = 0.0;
  for (const Sample& sample : samples) {
    length += sample.weight;
  }
  for (Sample& sample : samples) {
    sample.weight += sample.salient ? kSalientShare * length / static_cast<double>(count) : 0.0;
  }
  // Lloyd's iteration ends in the next local optimum: begin at every end and corner, keep the best.
  Chosen best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t first = 0; first < samples.size(); ++first) {
    if (first > 0 && !samples[first].salient) {
      continue;
    }
    const Chosen chosen = settle(samples, farthestPoints(samples, first, count));
    if (const double found = cost(samples, chosen); found < least - kSamePlace) {
      least = found;
      best = chosen;
    }
  }
  return positionsOf(samples, best);
}

std::vector<Eigen::Vector2d> spreadForSpacing(const std::vector<Stroke>& strokes,
                                              std::vector<Eigen::Vector2d> start) {
  const std::vector<Sample> samples = samplesOf(strokes);
  const auto gap = [&](const Chosen& chosen, std::size_t moving, std::size_t candidate) {
    double closest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      if (k != moving) {
        closest = std::min(closest, squaredDistance(samples[candidate], samples[chosen[k]]));
      }
    }
    return closest;
  };
  Chosen chosen = farthestPoints(samples, 0, start.size());
  // Each point in turn moves to where its nearest neighbour is farthest.
  bool moved = true;
  for (int round = 0; moved && round < kMaxRounds; ++round) {
    moved = false;
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      double best = gap(chosen, k, chosen[k]);
      for (std::size_t i = 0; i < samples.size(); ++i) {
        if (const double candidate = gap(chosen, k, i); candidate > best + kSamePlace) {
          best = candidate;
          chosen[k] = i;
          moved = true;
        }
      }
    }
  }
  std::vector<Eigen::Vector2d> spaced = positionsOf(samples, chosen);
  return closestPair(spaced) > closestPair(start) ? spaced : start;
}

double closestPair(const std::vector<Eigen::Vector2d>& points) {
  double closest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = i + 1; j < points.size(); ++j) {
      closest = std::min(closest, (points[i] - points[j]).norm());
    }
  }
  return closest;
}

}  // namespace roundabout::fleet
