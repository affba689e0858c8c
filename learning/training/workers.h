#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace roundabout::learning {

/// Threads that share jobs. Which thread does which job is left to chance: jobs must not depend
/// on each other, so that results do not depend on the number of threads.
class Workers {
 public:
  /// The caller of forEach() is one of the threads.
  explicit Workers(int threads);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  /// job(0) to job(jobs - 1); returns when all are done. Throws what a job throws.
  void forEach(int jobs, const std::function<void(int)>& job);

 private:
  void work();
  void takeJobs(std::unique_lock<std::mutex>& lock);

  std::mutex mutex_;
  std::condition_variable begun_;
  std::condition_variable finished_;
  const std::function<void(int)>* job_ = nullptr;
  int next_ = 0;
  int jobs_ = 0;
  int busy_ = 0;
  bool ending_ = false;
  std::exception_ptr failure_;
  std::vector<std::thread> threads_;
};

}  // namespace roundabout::learning
