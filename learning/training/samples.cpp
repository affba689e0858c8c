#include "learning/training/samples.h"

#include <array>

#include "planner/policies/ga3c_cadrl/actions.h"

namespace roundabout::learning {

namespace {

template <class Value>
void extend(std::vector<Value>& values, const std::vector<Value>& more) {
  values.insert(values.end(), more.begin(), more.end());
}

/// The action that turns as far to the other side.
constexpr std::array<std::uint8_t, planner::kActions.size()> mirroredActions() {
  std::array<std::uint8_t, planner::kActions.size()> mirrored{};
  for (std::size_t i = 0; i < mirrored.size(); ++i) {
    for (std::size_t j = 0; j < mirrored.size(); ++j) {
      if (planner::kActions[j].speed_fraction == planner::kActions[i].speed_fraction &&
          planner::kActions[j].heading_change_rad == -planner::kActions[i].heading_change_rad) {
        mirrored[i] = static_cast<std::uint8_t>(j);
      }
    }
  }
  return mirrored;
}

}  // namespace

void Samples::mirror(std::size_t sample) {
  static constexpr auto kMirrored = mirroredActions();
  constexpr std::size_t kHeading = 1;
  constexpr std::size_t kPositionOrthogonal = 1;
  constexpr std::size_t kVelocityOrthogonal = 3;
  ego[sample][kHeading] = -ego[sample][kHeading];
  for (std::uint32_t i = first_other[sample]; i < first_other[sample + 1]; ++i) {
    others[i][kPositionOrthogonal] = -others[i][kPositionOrthogonal];
    others[i][kVelocityOrthogonal] = -others[i][kVelocityOrthogonal];
  }
  action[sample] = kMirrored[action[sample]];
}

void Samples::clear() {
  const auto forget = [](auto&... each) { (each.clear(), ...); };
  forget(ego, first_other, others, action, sharpness, log_probability, value, reward, next,
         value_beyond, advantage, target);
  first_other.push_back(0);
}

std::size_t Samples::add(const planner::Observation& observation) {
  ego.push_back(observation.ego);
  extend(others, observation.others);
  first_other.push_back(static_cast<std::uint32_t>(others.size()));
  action.push_back(0);
  next.push_back(kCutOff);
  const auto addZero = [](auto&... each) { (each.push_back(0.0F), ...); };
  addZero(sharpness, log_probability, value, reward, value_beyond, advantage, target);
  return size() - 1;
}

void Samples::append(const Samples& more) {
  const auto samples_before = static_cast<std::int32_t>(size());
  const auto others_before = static_cast<std::uint32_t>(others.size());
  for (std::size_t s = 0; s < more.size(); ++s) {
    first_other.push_back(others_before + more.first_other[s + 1]);
    next.push_back(more.next[s] < 0 ? more.next[s] : more.next[s] + samples_before);
  }
  extend(ego, more.ego);
  extend(others, more.others);
  extend(action, more.action);
  extend(sharpness, more.sharpness);
  extend(log_probability, more.log_probability);
  extend(value, more.value);
  extend(reward, more.reward);
  extend(value_beyond, more.value_beyond);
  extend(advantage, more.advantage);
  extend(target, more.target);
}

void Samples::truncate(std::size_t count) {
  const auto shorten = [count](auto&... each) { (each.resize(count), ...); };
  shorten(ego, action, sharpness, log_probability, value, reward, next, value_beyond, advantage,
          target);
  first_other.resize(count + 1);
  others.resize(first_other.back());
}

void Samples::estimateAdvantages(double discount, double trace_decay) {
  const auto gamma = static_cast<float>(discount);
  const auto decay = static_cast<float>(discount * trace_decay);
  for (std::size_t s = size(); s-- > 0;) {
    float after = 0.0F;
    float trace = 0.0F;
    if (next[s] >= 0) {
      const auto following = static_cast<std::size_t>(next[s]);
      after = value[following];
      trace = decay * advantage[following];
    } else if (next[s] == kCutOff) {
      after = value_beyond[s];
    }
    advantage[s] = reward[s] + gamma * after - value[s] + trace;
    target[s] = advantage[s] + value[s];
  }
}

}  // namespace roundabout::learning
