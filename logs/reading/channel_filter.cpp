#include "logs/reading/channel_filter.h"

#include <algorithm>

#include "common/core/error.h"

namespace roundabout::logs {

namespace {

std::vector<std::regex> compiled(const std::vector<std::string>& patterns) {
  std::vector<std::regex> expressions;
  for (const std::string& pattern : patterns) {
    try {
      expressions.emplace_back(pattern);
    } catch (const std::regex_error&) {
      throw core::StartupError("channels", "pattern", "a regular expression", pattern);
    }
  }
  return expressions;
}

bool anyMatches(const std::vector<std::regex>& expressions, const std::string& channel) {
  return std::any_of(expressions.begin(), expressions.end(), [&](const std::regex& expression) {
    return std::regex_match(channel, expression);
  });
}

}  // namespace

ChannelFilter::ChannelFilter(const std::vector<std::string>& only,
                             const std::vector<std::string>& except)
    : only_(compiled(only)), except_(compiled(except)) {}

bool ChannelFilter::passes(std::string_view channel) {
  const auto known = known_.find(channel);
  if (known != known_.end()) {
    return known->second;
  }
  const std::string name(channel);
  const bool passes = (only_.empty() || anyMatches(only_, name)) && !anyMatches(except_, name);
  known_.emplace(name, passes);
  return passes;
}

}  // namespace roundabout::logs
