#include "sim/rejections.h"

#include <spdlog/spdlog.h>

namespace roundabout::sim {

void Rejections::add(std::string_view channel, std::string_view reason) {
  if (++counts_[{std::string(channel), std::string(reason)}] == 1) {
    spdlog::warn("{}: refused: {} (further ones are only counted)", channel, reason);
  }
}

int Rejections::total() const {
  int sum = 0;
  for (const auto& [kind, count] : counts_) {
    sum += count;
  }
  return sum;
}

int Rejections::count(const std::string& channel, const std::string& reason) const {
  const auto found = counts_.find({channel, reason});
  return found == counts_.end() ? 0 : found->second;
}

}  // namespace roundabout::sim
