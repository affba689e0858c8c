#pragma once

#include <limits>
#include <span>
#include <vector>

#include "common/core/time.h"
#include "sim/dynamics/dynamics.h"
#include "sim/pedestrians/pedestrian.h"

namespace roundabout::sim {

/// One time during which a vehicle's body overlapped a person's.
struct Encounter {
  std::size_t vehicle;
  std::int32_t person;
  core::Utime begin;
  double vehicle_closing_mps;  ///< when it began: how fast the vehicle moved towards the person
  double person_closing_mps;   ///< and the person towards the vehicle

  /// The vehicle ran into the person: it moved towards it faster than somebody who is standing.
  /// Who walks into a vehicle that stands or gives way is not run into.
  bool byVehicle() const { return vehicle_closing_mps > kPedestrianStandsMps; }
};

/// The truth about vehicles and people; bodies are discs in the floor plane.
class Encounters {
 public:
  Encounters(std::vector<double> vehicle_radii_m, double person_radius_m);

  void update(core::Utime now, std::span<const BodyState> bodies,
              std::span<const Pedestrian> people);

  std::span<const Encounter> all() const { return encounters_; }
  /// m between edges, smallest so far; negative: they overlapped; infinite: nobody was there.
  double closestM() const { return closest_m_; }

 private:
  std::vector<double> radii_m_;
  double person_radius_m_;
  // Of whoever overlaps now.
  std::vector<std::pair<std::size_t, std::int32_t>> open_;
  std::vector<std::pair<std::size_t, std::int32_t>> still_open_;
  std::vector<Encounter> encounters_;
  double closest_m_ = std::numeric_limits<double>::infinity();
};

}  // namespace roundabout::sim
