#include "common/bus/listen.h"

#include <algorithm>
#include <cstddef>
#include <memory>

namespace roundabout::bus {

std::vector<std::string> heardWithin(std::chrono::milliseconds duration, Bus& listener,
                                     const std::vector<std::string>& channels) {
  using Clock = std::chrono::steady_clock;
  // Shared, because the subscriptions outlive this call.
  const auto heard = std::make_shared<std::vector<bool>>(channels.size(), false);
  for (std::size_t i = 0; i < channels.size(); ++i) {
    listener.subscribe(channels[i], [heard, i](const Received&) { (*heard)[i] = true; });
  }
  const auto deadline = Clock::now() + duration;
  auto left = duration;
  do {
    listener.handle(left);
    left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
  } while (left.count() > 0 && std::find(heard->begin(), heard->end(), false) != heard->end());

  std::vector<std::string> names;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if ((*heard)[i]) {
      names.push_back(channels[i]);
    }
  }
  return names;
}

}  // namespace roundabout::bus
