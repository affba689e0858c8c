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

double squaredDistance(const Sample& a, const Sample& b) {
  return (a.position - b.position).squaredNorm();
}

/// Squared distance to the nearest of the chosen; index of that in `nearest` if wanted.
double toNearest(const std::vector<Sample>& samples, const std::vector<std::size_t>& chosen,
                 std::size_t from, std::size_t except = SIZE_MAX, std::size_t* nearest = nullptr) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const double distance = squaredDistance(samples[from], samples[chosen[i]]);
    if (i != except && distance < best) {
      best = distance;
      if (nearest != nullptr) {
        *nearest = i;
      }
    }
  }
  return best;
}

/// Farthest-point sampling, beginning with the sample that is farthest from the middle.
std::vector<std::size_t> farthestPoints(const std::vector<Sample>& samples, std::size_t count) {
  Sample middle{Eigen::Vector2d::Zero(), 0.0, false};
  for (const Sample& sample : samples) {
    middle.position += sample.position / static_cast<double>(samples.size());
  }
  std::vector<std::size_t> chosen;
  while (chosen.size() < count) {
    std::size_t best = 0;
    double best_distance = -1.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double distance =
          chosen.empty() ? squaredDistance(samples[i], middle) : toNearest(samples, chosen, i);
      if (distance > best_distance + kSamePlace) {
        best = i;
        best_distance = distance;
      }
    }
    chosen.push_back(best);
  }
  return chosen;
}

/// The member of a cell with the least weighted squared distance to all members.
std::size_t medoid(const std::vector<Sample>& samples, const std::vector<std::size_t>& cell,
                   std::size_t current) {
  // The weighted squared distance to all is least at the sample nearest to the weighted mean.
  Sample mean{Eigen::Vector2d::Zero(), 0.0, false};
  for (const std::size_t i : cell) {
    mean.position += samples[i].weight * samples[i].position;
    mean.weight += samples[i].weight;
  }
  mean.position /= mean.weight;
  std::size_t best = current;
  for (const std::size_t i : cell) {
    if (squaredDistance(samples[i], mean) < squaredDistance(samples[best], mean) - 1e-12) {
      best = i;
    }
  }
  return best;
}

std::vector<Eigen::Vector2d> positionsOf(const std::vector<Sample>& samples,
                                         const std::vector<std::size_t>& chosen) {
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
  std::vector<std::size_t> chosen = farthestPoints(samples, count);
  for (int round = 0; round < kMaxRounds; ++round) {
    std::vector<std::vector<std::size_t>> cells(count);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      std::size_t nearest = 0;
      toNearest(samples, chosen, i, SIZE_MAX, &nearest);
      cells[nearest].push_back(i);
    }
    std::vector<std::size_t> moved;
    for (std::size_t k = 0; k < count; ++k) {
      moved.push_back(cells[k].empty() ? chosen[k] : medoid(samples, cells[k], chosen[k]));
    }
    if (moved == chosen) {
      break;
    }
    chosen = moved;
  }
  return positionsOf(samples, chosen);
}

std::vector<Eigen::Vector2d> spreadForSpacing(const std::vector<Stroke>& strokes,
                                              std::vector<Eigen::Vector2d> start) {
  const std::vector<Sample> samples = samplesOf(strokes);
  std::vector<std::size_t> chosen = farthestPoints(samples, start.size());
  // Each point in turn moves to where its nearest neighbour is farthest.
  for (int round = 0; round < kMaxRounds; ++round) {
    bool moved = false;
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      double best_distance = toNearest(samples, chosen, chosen[k], k);
      for (std::size_t i = 0; i < samples.size(); ++i) {
        const double distance = toNearest(samples, chosen, i, k);
        if (distance > best_distance + kSamePlace) {
          best_distance = distance;
          chosen[k] = i;
          moved = true;
        }
      }
    }
    if (!moved) {
      break;
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
