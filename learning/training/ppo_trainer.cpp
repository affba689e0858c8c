#include "learning/training/ppo_trainer.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "learning/training/reward.h"
#include "learning/training/weight_files.h"
#include "planner/policies/ga3c_cadrl/weights.h"

namespace roundabout::learning {

PpoTrainer::Shard::Shard(const NetworkPlan& plan, Eigen::Index parameters)
    : network(makeNetwork(plan)), gradient(Parameters::Zero(parameters)) {}

PpoTrainer::PpoTrainer(const Recipe& recipe, int threads, TrainingState state)
    : Trainer(recipe, std::move(state)), workers_(threads) {
  for (int i = 0; i < recipe_.shards; ++i) {
    shards_.emplace_back(plan_, layout_.size());
  }
  renewEnvironments();
}

void PpoTrainer::renewEnvironments() {
  hard_cases_.clear();
  for (Shard& shard : shards_) {
    shard.environments.clear();
  }
  for (int i = 0; i < recipe_.ppo.environments; ++i) {
    core::RandomStream random(recipe_.seed,
                              fmt::format("training/environment/{}/{}", i, state_.iterations));
    shards_[static_cast<std::size_t>(i % recipe_.shards)].environments.emplace_back(
        recipe_, std::move(random), &hard_cases_);
  }
  for (int i = 0; i < recipe_.shards; ++i) {
    shards_[static_cast<std::size_t>(i)].lab.emplace(
        recipe_,
        core::RandomStream(recipe_.seed, fmt::format("training/lab/{}/{}", i, state_.iterations)));
  }
}

IterationFigures PpoTrainer::iterate() {
  IterationFigures figures;
  place_ = stageAt(recipe_, static_cast<double>(state_.agent_steps));
  figures.learning_rate = place_.stage->at(place_.stage->learning_rate, place_.done);
  if (place_.stage->world == "lab") {
    flown_ = planner::toGa3cCadrlWeights(weightFile(plan_, state_.parameters, "in training"),
                                         "network in training");
  }
  workers_.forEach(recipe_.shards,
                   [this](int i) { rollOut(shards_[static_cast<std::size_t>(i)]); });
  collect(figures);
  mirrorSome();
  normaliseAdvantages();
  learn(figures);
  ++state_.iterations;
  state_.agent_steps += static_cast<long>(figures.samples);
  state_.episodes += static_cast<long>(figures.episodes);
  return figures;
}

void PpoTrainer::rollOut(Shard& shard) {
  const Stage& stage = *place_.stage;
  shard.samples.clear();
  if (stage.world == "lab") {
    flyInTheLab(shard);
  } else {
    stepEnvironments(shard);
  }
  const double steps = stage.planning_step_s / kRewardStep_s;
  shard.samples.estimateAdvantages(std::pow(kDiscount, steps),
                                   std::pow(recipe_.ppo.trace_decay, steps));
}

void PpoTrainer::flyInTheLab(Shard& shard) {
  const Stage& stage = *place_.stage;
  const int episodes = (recipe_.ppo.lab_episodes + recipe_.shards - 1) / recipe_.shards;
  for (int i = 0; i < episodes; ++i) {
    shard.lab->run(stage, stage.at(stage.collision_reward, place_.done), flown_, shard.samples);
  }
}

void PpoTrainer::stepEnvironments(Shard& shard) {
  const Stage& stage = *place_.stage;
  const auto evaluate = [&](const Samples& samples, std::size_t first) -> const Matrix& {
    shard.batch.clear();
    for (std::size_t s = first; s < samples.size(); ++s) {
      shard.batch.add(samples.ego[s], samples.othersOf(s));
    }
    return shard.network->forward(state_.parameters, shard.batch);
  };
  for (Environment& environment : shard.environments) {
    environment.enter(stage, stage.at(stage.collision_reward, place_.done));
    environment.beginSamples();
  }
  for (int step = 0; step < recipe_.ppo.steps; ++step) {
    const std::size_t first = shard.samples.size();
    for (Environment& environment : shard.environments) {
      environment.observe(shard.samples);
    }
    const Matrix& heads = evaluate(shard.samples, first);
    for (Environment& environment : shard.environments) {
      environment.choose(shard.samples, heads, first);
      environment.step(shard.samples);
    }
  }
  shard.beyond.clear();
  shard.last_samples.clear();
  for (Environment& environment : shard.environments) {
    environment.lookBeyond(shard.beyond, shard.last_samples);
  }
  const Matrix& heads = evaluate(shard.beyond, 0);
  for (std::size_t k = 0; k < shard.last_samples.size(); ++k) {
    shard.samples.value_beyond[shard.last_samples[k]] =
        heads(static_cast<Eigen::Index>(k), kActionCount);
  }
}

void PpoTrainer::collect(IterationFigures& figures) {
  samples_.clear();
  for (Shard& shard : shards_) {
    samples_.append(shard.samples);
    const auto count = [&](const std::vector<EpisodeFigures>& finished) {
      for (const EpisodeFigures& episode : finished) {
        figures.reward += episode.reward;
        figures.success += episode.success ? 1.0 : 0.0;
        ++figures.episodes;
      }
    };
    count(shard.lab->takeFinished());
    for (Environment& environment : shard.environments) {
      count(environment.takeFinished());
      for (TrainingCase& failed : environment.takeFailed()) {
        hard_cases_.add(std::move(failed));
      }
    }
  }
  figures.samples = samples_.size();
  if (figures.episodes > 0) {
    figures.reward /= static_cast<double>(figures.episodes);
    figures.success /= static_cast<double>(figures.episodes);
  }
}

// The world knows no left and right: a mirrored sample is as true as the one that it comes from,
// drawn by the mirrored policy with the same probability. That probability stays: what the policy
// itself would hardly ever do then counts as little. (With its own probability in place of it,
// ratios begin with one, actions of probability 1e-9 count in full, and training breaks down.)
void PpoTrainer::mirrorSome() {
  mirrored_.assign(samples_.size(), false);
  if (recipe_.ppo.mirrored_share <= 0.0) {
    return;
  }
  core::RandomStream random(recipe_.seed, fmt::format("training/mirror/{}", state_.iterations));
  for (std::size_t s = 0; s < samples_.size(); ++s) {
    if (random.chance(recipe_.ppo.mirrored_share)) {
      samples_.mirror(s);
      mirrored_[s] = true;
    }
  }
}

void PpoTrainer::normaliseAdvantages() {
  const auto count = static_cast<double>(samples_.size());
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (const float advantage : samples_.advantage) {
    sum += advantage;
    sum_of_squares += static_cast<double>(advantage) * advantage;
  }
  const double mean = sum / count;
  const double deviation = std::sqrt(std::max(sum_of_squares / count - mean * mean, 1e-12));
  advantages_.resize(samples_.size());
  for (std::size_t s = 0; s < advantages_.size(); ++s) {
    advantages_[s] = static_cast<float>((samples_.advantage[s] - mean) / deviation);
  }
}

void PpoTrainer::learn(IterationFigures& figures) {
  order_.resize(samples_.size());
  std::iota(order_.begin(), order_.end(), 0U);
  core::RandomStream random(recipe_.seed, fmt::format("training/order/{}", state_.iterations));
  const std::size_t parts =
      std::max<std::size_t>(1, order_.size() / static_cast<std::size_t>(recipe_.ppo.minibatch));
  std::size_t used = 0;
  for (int epoch = 0; epoch < recipe_.ppo.epochs && !figures.cut_short; ++epoch) {
    random.shuffle(order_);
    for (std::size_t part = 0; part < parts && !figures.cut_short; ++part) {
      const std::size_t begin = order_.size() * part / parts;
      const std::size_t end = order_.size() * (part + 1) / parts;
      figures.cut_short = !update(std::span(order_).subspan(begin, end - begin), figures.loss);
      used += end - begin;
    }
  }
  const auto mean = [used](double& sum) { sum /= static_cast<double>(used); };
  mean(figures.loss.divergence);
  mean(figures.loss.entropy);
  mean(figures.loss.clipped);
  mean(figures.loss.value_error);
}

LossFigures PpoTrainer::addGradient(Shard& shard, std::span<const std::uint32_t> order) {
  const double entropy_weight = place_.stage->at(place_.stage->entropy_weight, place_.done);
  shard.batch.clear();
  for (const std::uint32_t s : order) {
    shard.batch.add(samples_.ego[s], samples_.othersOf(s));
  }
  const Matrix& heads = shard.network->forward(state_.parameters, shard.batch);
  shard.d_heads.resize(heads.rows(), kHeads);
  LossFigures sum;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    LossFigures each = ppoLoss(recipe_.ppo, entropy_weight, samples_, order[k],
                               advantages_[order[k]], heads.row(row), shard.d_heads.row(row));
    if (mirrored_[order[k]]) {
      each.divergence = 0.0;  // from the mirrored policy, which differed before any update
    }
    sum += each;
  }
  shard.gradient.setZero();
  shard.network->backward(state_.parameters, shard.batch, shard.d_heads, shard.gradient);
  return sum;
}

bool PpoTrainer::update(std::span<const std::uint32_t> order, LossFigures& sum) {
  const std::size_t parts = shards_.size();
  workers_.forEach(recipe_.shards, [&](int i) {
    const auto part = static_cast<std::size_t>(i);
    const std::size_t begin = order.size() * part / parts;
    const std::size_t end = order.size() * (part + 1) / parts;
    shards_[part].figures = addGradient(shards_[part], order.subspan(begin, end - begin));
  });
  LossFigures figures;
  Parameters& gradient = shards_.front().gradient;
  for (std::size_t part = 0; part < parts; ++part) {
    figures += shards_[part].figures;
    if (part > 0) {
      gradient += shards_[part].gradient;
    }
  }
  const auto count = static_cast<double>(order.size());
  const auto own =
      std::count_if(order.begin(), order.end(), [this](std::uint32_t s) { return !mirrored_[s]; });
  if (own > 0) {
    figures.divergence *= count / static_cast<double>(own);
  }
  sum += figures;
  if (figures.divergence / count > recipe_.ppo.max_divergence) {
    return false;
  }
  gradient /= static_cast<float>(count);
  const double norm = gradient.norm();
  expectFinite(norm);
  if (norm > recipe_.ppo.max_gradient_norm) {
    gradient *= static_cast<float>(recipe_.ppo.max_gradient_norm / norm);
  }
  const Stage& stage = *place_.stage;
  state_.adam.update(gradient, stage.at(stage.learning_rate, place_.done), state_.parameters);
  // At first the mean is over what there is.
  const double weight =
      std::max(1.0 / recipe_.ppo.averaged_updates, 1.0 / static_cast<double>(state_.adam.updates));
  state_.averaged += static_cast<float>(weight) * (state_.parameters - state_.averaged);
  return true;
}

}  // namespace roundabout::learning
