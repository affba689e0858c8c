#pragma once

#include <map>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

namespace roundabout::logs {

/// Chooses channels by regular expressions for whole names, as LCM's own tools do.
class ChannelFilter {
 public:
  /// Channels that match one of `only` (all, if there is none) and none of `except`. Throws
  /// core::StartupError if one is no regular expression.
  ChannelFilter(const std::vector<std::string>& only, const std::vector<std::string>& except);

  bool passes(std::string_view channel);

 private:
  std::vector<std::regex> only_;
  std::vector<std::regex> except_;
  std::map<std::string, bool, std::less<>> known_;
};

}  // namespace roundabout::logs
