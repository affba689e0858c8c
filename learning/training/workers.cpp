#include "learning/training/workers.h"

#include <utility>

namespace roundabout::learning {

Workers::Workers(int threads) {
  for (int i = 1; i < threads; ++i) {
    threads_.emplace_back([this] { work(); });
  }
}

Workers::~Workers() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  begun_.notify_all();
  for (std::thread& thread : threads_) {
    thread.join();
  }
}

void Workers::forEach(int jobs, const std::function<void(int)>& job) {
  std::unique_lock lock(mutex_);
  job_ = &job;
  next_ = 0;
  jobs_ = jobs;
  begun_.notify_all();
  takeJobs(lock);
  finished_.wait(lock, [this] { return busy_ == 0; });
  job_ = nullptr;
  if (failure_) {
    std::rethrow_exception(std::exchange(failure_, nullptr));
  }
}

void Workers::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    begun_.wait(lock, [this] { return ending_ || next_ < jobs_; });
    if (ending_) {
      return;
    }
    takeJobs(lock);
    finished_.notify_all();
  }
}

void Workers::takeJobs(std::unique_lock<std::mutex>& lock) {
  ++busy_;
  while (next_ < jobs_) {
    const int job = next_++;
    lock.unlock();
    std::exception_ptr failure;
    try {
      (*job_)(job);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (failure) {
      failure_ = failure;
      next_ = jobs_;
    }
  }
  --busy_;
}

}  // namespace roundabout::learning
