#include "planner/policies/static/static.h"

namespace roundabout::planner {

namespace {

class Static final : public Policy {
 public:
  Decision decide(const core::EgoAgent&, const core::Surroundings&) override { return {}; }

  std::unique_ptr<Policy> twin() const override { return std::make_unique<Static>(); }

  bool avoidsObstacles() const override { return true; }
  std::string_view name() const override { return "static"; }
};

}  // namespace

std::unique_ptr<Policy> makeStatic(const PolicyOptions&) { return std::make_unique<Static>(); }

}  // namespace roundabout::planner
