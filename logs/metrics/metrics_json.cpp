#include "logs/metrics/metrics_json.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "logs/files.h"

namespace roundabout::logs {

namespace {

// Ordered: the same metrics give the same bytes, in the order of the structs.
using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json spread(const Spread& spread) {
  return {{"count", spread.count},
          {"p50_s", number(spread.p50)},
          {"p99_s", number(spread.p99)},
          {"max_s", number(spread.max)}};
}

Json gap(const ClosestGap& gap) {
  if (!std::isfinite(gap.gap_m)) {
    return nullptr;
  }
  return {{"gap_m", gap.gap_m}, {"at_s", gap.at_s}, {"vehicles", {gap.vehicle_a, gap.vehicle_b}}};
}

Json encounters(const std::vector<Encounter>& encounters, double total_s) {
  Json list = Json::array();
  for (const Encounter& encounter : encounters) {
    list.push_back({{"vehicles", {encounter.vehicle_a, encounter.vehicle_b}},
                    {"begin_at_s", encounter.begin_at_s},
                    {"end_at_s", encounter.end_at_s},
                    {"time_below_s", encounter.time_below_s},
                    {"closest_gap_m", encounter.closest_gap_m}});
  }
  return {{"count", encounters.size()}, {"total_time_s", total_s}, {"episodes", list}};
}

Json unseen(const std::vector<Unseen>& stretches) {
  Json list = Json::array();
  for (const Unseen& stretch : stretches) {
    list.push_back({{"vehicle", stretch.vehicle},
                    {"begin_at_s", stretch.begin_at_s},
                    {"end_at_s", stretch.end_at_s},
                    {"near", stretch.near}});
  }
  return list;
}

Json separation(const SeparationMetrics& separation) {
  Json pairs = Json::array();
  for (const PairMetrics& pair : separation.pairs) {
    pairs.push_back({{"vehicles", {pair.body_gap.vehicle_a, pair.body_gap.vehicle_b}},
                     {"closest_body_gap_m", number(pair.body_gap.gap_m)},
                     {"closest_at_s", number(pair.body_gap.at_s)},
                     {"body_touches", pair.touches},
                     {"closer_than_assumed", pair.approaches}});
  }
  return {{"closest_body_gap", gap(separation.body_gap)},
          {"closest_assumed_gap", gap(separation.assumed_gap)},
          {"body_touches", encounters(separation.touches, separation.touching_time_s)},
          {"closer_than_assumed", encounters(separation.approaches, separation.approaching_time_s)},
          {"unseen", unseen(separation.unseen)},
          {"pairs", pairs}};
}

Json timing(const TimingMetrics& timing) {
  return {{"real_time", timing.real_time},
          {"frames", timing.frames},
          {"missing_frames", timing.missing_frames},
          {"frames_out_of_order", timing.frames_out_of_order},
          {"data_duration_s", timing.data_duration_s},
          {"log_duration_s", timing.log_duration_s},
          {"real_time_factor", number(timing.real_time_factor)},
          {"nominal_interval_s", number(timing.nominal_interval_s)},
          {"rate_hz", number(timing.rate_hz)},
          {"interval_error", spread(timing.interval_error_s)},
          {"longest_interval_s", timing.longest_interval_s},
          {"steady", timing.steady}};
}

Json formation(const FormationMetrics& formation) {
  Json legs = Json::array();
  for (const LegMetrics& leg : formation.legs) {
    legs.push_back(
        {{"vehicle", leg.vehicle},
         {"goal_world_m", {leg.goal_world_m.x(), leg.goal_world_m.y(), leg.goal_world_m.z()}},
         {"reached", leg.reached},
         {"goal_at_s", leg.goal_at_s},
         {"time_to_goal_s", number(leg.time_to_goal_s)},
         {"straight_line_m", leg.straight_line_m},
         {"extra_time_s", number(leg.extra_time_s)},
         {"path_length_m", leg.path_length_m}});
  }
  return {{"name", formation.name},
          {"step", formation.step},
          {"formed", formation.formed},
          {"begin_at_s", formation.begin_at_s},
          {"end_at_s", formation.end_at_s},
          {"time_to_form_s", number(formation.time_to_form_s)},
          {"closest_body_gap", gap(formation.body_gap)},
          {"body_touches", formation.touches},
          {"closer_than_assumed", formation.approaches},
          {"vehicles", legs}};
}

Json shield(const ShieldMetrics& shield) {
  Json layers = Json::object();
  for (const auto& [layer, count] : shield.by_layer) {
    layers[nameOf(layer)] = count;
  }
  return {{"steps", shield.steps},
          {"interventions", shield.interventions},
          {"changed_share", shield.changedShare()},
          {"by_layer", layers},
          {"smallest_predicted_gap_m", number(shield.smallest_predicted_gap_m)}};
}

Json vehicle(const VehicleMetrics& vehicle) {
  Json modes = Json::object();
  for (const auto& [mode, time_s] : vehicle.time_in_mode_s) {
    modes[nameOf(mode)] = time_s;
  }
  return {{"name", vehicle.name},
          {"policy", vehicle.policy},
          {"path_length_m", vehicle.path_length_m},
          {"max_speed_mps", vehicle.max_speed_mps},
          {"max_acceleration_mps2", vehicle.max_acceleration_mps2},
          {"untracked_time_s", vehicle.untracked_time_s},
          {"time_in_mode_s", modes},
          {"commands", vehicle.commands},
          {"command_rate_hz", vehicle.command_rate_hz},
          {"command_latency", spread(vehicle.command_latency_s)},
          {"compute_time", spread(vehicle.compute_time_s)},
          {"shield", shield(vehicle.shield)},
          {"rejected_messages", vehicle.rejected_messages},
          {"rejected_measurements", vehicle.rejected_measurements},
          {"missed_ticks", vehicle.missed_ticks}};
}

Json faults(const FaultMetrics& faults) {
  Json silences = Json::array();
  for (const Silence& silence : faults.silences) {
    silences.push_back({{"who", silence.who},
                        {"begin_at_s", silence.begin_at_s},
                        {"end_at_s", silence.end_at_s},
                        {"returned", silence.returned}});
  }
  Json orders = Json::array();
  for (const SafetyOrderSeen& order : faults.safety_orders) {
    orders.push_back({{"at_s", order.at_s}, {"order", order.order}, {"vehicle", order.vehicle}});
  }
  return {{"silences", silences}, {"safety_orders", orders}, {"refusals", faults.refusals}};
}

template <class Element>
Json listOf(const std::vector<Element>& elements, Json (*convert)(const Element&)) {
  Json list = Json::array();
  for (const Element& element : elements) {
    list.push_back(convert(element));
  }
  return list;
}

Json phase(const PhaseMetrics& phase) {
  return {{"phase", nameOf(phase.phase)},
          {"formation", phase.formation},
          {"step", phase.step},
          {"begin_at_s", phase.begin_at_s},
          {"end_at_s", phase.end_at_s}};
}

}  // namespace

std::string toJson(const Metrics& metrics) {
  const Json json = {{"success", metrics.success},
                     {"failures", metrics.failures},
                     {"formations_flown", metrics.formations.size()},
                     {"formations_formed", metrics.formationsFormed()},
                     {"separation", separation(metrics.separation)},
                     {"obstacles",
                      {{"closest_gap", gap(metrics.obstacles.closest)},
                       {"body_touches", listOf(metrics.obstacles.touches, gap)},
                       {"unseen", unseen(metrics.obstacles.unseen)}}},
                     {"people",
                      {{"count", metrics.people.people},
                       {"closest_gap", gap(metrics.people.closest)},
                       {"body_touches", listOf(metrics.people.touches, gap)}}},
                     {"formations", listOf(metrics.formations, formation)},
                     {"vehicles", listOf(metrics.vehicles, vehicle)},
                     {"timing", timing(metrics.timing)},
                     {"phases", listOf(metrics.phases, phase)},
                     {"faults", faults(metrics.faults)}};
  // Text in a log may be any bytes: what is not UTF-8 is replaced instead of thrown at.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void writeMetricsJson(const Metrics& metrics, const std::string& file) {
  writeFile(file, toJson(metrics));
}

}  // namespace roundabout::logs
