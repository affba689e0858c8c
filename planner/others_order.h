#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace roundabout::planner {

/// In which order a learned policy is fed the others (paper, section "Agent Ordering Strategies");
/// docs/observation.md defines them. A network flies well in the order it was trained with only.
enum class OthersOrder { kClosestLast, kClosestFirst, kTimeToCollision };

struct NamedOthersOrder {
  std::string_view name;
  OthersOrder order;
};

/// Every order, by the name that weight files give it.
inline constexpr std::array kOthersOrders = {
    NamedOthersOrder{"closest_last", OthersOrder::kClosestLast},
    NamedOthersOrder{"closest_first", OthersOrder::kClosestFirst},
    NamedOthersOrder{"time_to_collision", OthersOrder::kTimeToCollision},
};

constexpr std::array<std::string_view, kOthersOrders.size()> othersOrderNames() {
  std::array<std::string_view, kOthersOrders.size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) {
    names[i] = kOthersOrders[i].name;
  }
  return names;
}

constexpr std::string_view nameOf(OthersOrder order) {
  for (const NamedOthersOrder& each : kOthersOrders) {
    if (each.order == order) {
      return each.name;
    }
  }
  return "unknown";
}

/// Nothing if there is no order of that name.
constexpr std::optional<OthersOrder> othersOrderNamed(std::string_view name) {
  for (const NamedOthersOrder& each : kOthersOrders) {
    if (each.name == name) {
      return each.order;
    }
  }
  return std::nullopt;
}

}  // namespace roundabout::planner
