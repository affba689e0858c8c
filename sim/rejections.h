#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace roundabout::sim {

/// Counts refused messages by channel and reason, and logs the first of each kind: a broken sender
/// sends hundreds a second.
class Rejections {
 public:
  void add(std::string_view channel, std::string_view reason);

  int total() const;
  int count(const std::string& channel, const std::string& reason) const;

 private:
  std::map<std::pair<std::string, std::string>, int> counts_;
};

}  // namespace roundabout::sim
