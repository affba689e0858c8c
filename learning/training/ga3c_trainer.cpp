#include "learning/training/ga3c_trainer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "learning/training/ga3c_loss.h"
#include "learning/training/reward.h"

namespace roundabout::learning {

Ga3cTrainer::Ga3cTrainer(const Recipe& recipe, int threads, TrainingState state)
    : Trainer(recipe, std::move(state)), threads_(threads), workers_(threads) {
  // TensorFlow's.
  state_.adam.second_decay = 0.999;
  state_.adam.epsilon = 1e-8;
  for (int i = 0; i < threads_; ++i) {
    Desk& desk = desks_.emplace_back();
    desk.network = makeNetwork(plan_);
    desk.gradient.resize(layout_.size());
  }
  renewEnvironments();
}

void Ga3cTrainer::renewEnvironments() {
  answered_.clear();
  asking_.clear();
  experience_.clear();
  experienced_ = 0;
  actors_.clear();
  for (int i = 0; i < recipe_.ga3c.environments; ++i) {
    actors_.emplace_back(
        recipe_,
        core::RandomStream(recipe_.seed, fmt::format("training/ga3c/{}/{}", i, state_.iterations)));
  }
}

IterationFigures Ga3cTrainer::iterate() {
  IterationFigures figures;
  place_ = stageAt(recipe_, static_cast<double>(state_.agent_steps));
  const Stage& stage = *place_.stage;
  figures.learning_rate = stage.at(stage.learning_rate, place_.done);
  const bool fresh = asking_.empty() && answered_.empty();
  for (Actor& actor : actors_) {
    actor.environment.enter(stage, stage.at(stage.collision_reward, place_.done));
    if (fresh) {
      begin(actor);
      asking_.push_back(&actor);
    }
  }
  learned_ = 0;
  for (Desk& desk : desks_) {
    desk.loss = {};
  }
  failed_ = false;
  workers_.forEach(threads_, [this](int i) {
    try {
      work(desks_[static_cast<std::size_t>(i)]);
    } catch (...) {
      // Nobody waits for what this thread was at work on.
      const Lock lock(mutex_);
      failed_ = true;
      changed_.notify_all();
      throw;
    }
  });

  for (const Desk& desk : desks_) {
    figures.loss += desk.loss;
  }
  const auto learned = static_cast<double>(learned_);
  figures.loss.entropy /= learned;
  figures.loss.value_error /= learned;
  figures.samples = learned_;
  for (const EpisodeFigures& episode : std::exchange(finished_, {})) {
    figures.reward += episode.reward;
    figures.success += episode.success ? 1.0 : 0.0;
    ++figures.episodes;
  }
  if (figures.episodes > 0) {
    figures.reward /= static_cast<double>(figures.episodes);
    figures.success /= static_cast<double>(figures.episodes);
  }
  ++state_.iterations;
  state_.agent_steps += static_cast<long>(figures.samples);
  state_.episodes += static_cast<long>(figures.episodes);
  return figures;
}

void Ga3cTrainer::work(Desk& desk) {
  const auto enough = static_cast<std::size_t>(recipe_.ga3c.iteration_samples);
  Lock lock(mutex_);
  while (learned_ < enough && !failed_) {
    if (experienced_ >= static_cast<std::size_t>(recipe_.ga3c.batch)) {
      learnSome(desk, lock);
    } else if (!answered_.empty()) {
      stepOne(lock);
    } else if (!asking_.empty()) {
      predictSome(desk, lock);
    } else {
      // Somebody else is at work on all that there is.
      changed_.wait(lock);
      continue;
    }
    changed_.notify_all();
  }
}

void Ga3cTrainer::learnSome(Desk& desk, Lock& lock) {
  desk.samples.clear();
  while (desk.samples.size() < static_cast<std::size_t>(recipe_.ga3c.batch)) {
    desk.samples.append(experience_.front());
    experienced_ -= experience_.front().size();
    experience_.pop_front();
  }
  learned_ += desk.samples.size();
  lock.unlock();
  {
    const std::shared_lock reading(parameters_mutex_);
    desk.loss += addGradient(desk);
  }
  update(desk.gradient);
  lock.lock();
}

void Ga3cTrainer::stepOne(Lock& lock) {
  Actor& actor = *answered_.front();
  answered_.pop_front();
  lock.unlock();
  const bool gives = step(actor);
  Samples given;
  if (gives) {
    std::swap(given, actor.samples);
    begin(actor);
  }
  lock.lock();
  if (gives) {
    experienced_ += given.size();
    experience_.push_back(std::move(given));
  }
  for (const EpisodeFigures& episode : actor.environment.takeFinished()) {
    finished_.push_back(episode);
  }
  asking_.push_back(&actor);
}

void Ga3cTrainer::predictSome(Desk& desk, Lock& lock) {
  std::vector<Actor*> served;
  std::size_t questions = 0;
  while (!asking_.empty() && questions < static_cast<std::size_t>(recipe_.ga3c.prediction_batch)) {
    served.push_back(asking_.front());
    asking_.pop_front();
    questions += served.back()->questions();
  }
  lock.unlock();
  desk.batch.clear();
  for (const Actor* actor : served) {
    const Samples& asked = actor->wantsValues() ? actor->beyond : actor->samples;
    for (std::size_t s = actor->wantsValues() ? 0 : actor->first; s < asked.size(); ++s) {
      desk.batch.add(asked.ego[s], asked.othersOf(s));
    }
  }
  {
    const std::shared_lock reading(parameters_mutex_);
    const Matrix& heads = desk.network->forward(state_.parameters, desk.batch);
    Eigen::Index row = 0;
    for (Actor* actor : served) {
      const auto rows = static_cast<Eigen::Index>(actor->questions());
      answer(*actor, heads.middleRows(row, rows));
      row += rows;
    }
  }
  lock.lock();
  answered_.insert(answered_.end(), served.begin(), served.end());
}

void Ga3cTrainer::begin(Actor& actor) {
  actor.samples.clear();
  actor.beyond.clear();
  actor.environment.beginSamples();
  actor.steps = 0;
  actor.first = 0;
  actor.environment.observe(actor.samples);
}

void Ga3cTrainer::answer(Actor& actor, const Eigen::Ref<const Matrix>& heads) {
  if (!actor.wantsValues()) {
    actor.environment.choose(actor.samples, heads, actor.first);
    return;
  }
  for (std::size_t k = 0; k < actor.last_samples.size(); ++k) {
    actor.samples.value_beyond[actor.last_samples[k]] =
        heads(static_cast<Eigen::Index>(k), kActionCount);
  }
}

bool Ga3cTrainer::step(Actor& actor) {
  if (actor.wantsValues()) {
    giveAway(actor);
    return true;
  }
  actor.environment.step(actor.samples);
  if (++actor.steps == recipe_.ga3c.return_steps) {
    actor.last_samples.clear();
    actor.environment.lookBeyond(actor.beyond, actor.last_samples);
    if (!actor.wantsValues()) {
      giveAway(actor);
      return true;
    }
    return false;
  }
  actor.first = actor.samples.size();
  actor.environment.observe(actor.samples);
  return false;
}

void Ga3cTrainer::giveAway(Actor& actor) {
  const double steps = place_.stage->planning_step_s / kRewardStep_s;
  constexpr double kWholeReturn = 1.0;
  actor.samples.estimateAdvantages(std::pow(kDiscount, steps), kWholeReturn);
}

LossFigures Ga3cTrainer::addGradient(Desk& desk) {
  const Stage& stage = *place_.stage;
  const double entropy_weight = stage.at(stage.entropy_weight, place_.done);
  desk.batch.clear();
  for (std::size_t s = 0; s < desk.samples.size(); ++s) {
    desk.batch.add(desk.samples.ego[s], desk.samples.othersOf(s));
  }
  const Matrix& heads = desk.network->forward(state_.parameters, desk.batch);
  desk.d_heads.resize(heads.rows(), kHeads);
  LossFigures sum;
  for (std::size_t s = 0; s < desk.samples.size(); ++s) {
    const auto row = static_cast<Eigen::Index>(s);
    sum += ga3cLoss(entropy_weight, desk.samples.action[s], desk.samples.target[s], heads.row(row),
                    desk.d_heads.row(row));
  }
  desk.gradient.setZero();
  desk.network->backward(state_.parameters, desk.batch, desk.d_heads, desk.gradient);
  return sum;
}

void Ga3cTrainer::update(const Parameters& gradient) {
  expectFinite(gradient.norm());
  const std::unique_lock writing(parameters_mutex_);
  const Stage& stage = *place_.stage;
  state_.adam.update(gradient, stage.at(stage.learning_rate, place_.done), state_.parameters);
  state_.averaged = state_.parameters;
}

}  // namespace roundabout::learning
