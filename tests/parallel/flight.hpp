// Random blocks that fly at one another, with a brute-force look for nodes inside foreign elements as they do.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <string>

#include "parallel/lookout.hpp"

namespace kerf::test {

struct Flight {
  std::uint64_t seed = 0;
  int n_bodies = 2;
  double speed = 1000.0;  // closing [m/s]
  bool aligned = false;  // faces meet flat, with an offset; else bodies are turned at random
  bool plastic = true;  // yields at 1 GPa; else elastic without limit
  enum class Deletion { none, random, strain } deletion = Deletion::none;
  std::string contact = "{type: eroding_surface}";
  int look_interval = 2;  // cycles between two looks; 0 for none
  int force_interval = 0;  // cycles between two re-balances that take place in any case; 0 for none
};

struct FlightReport {
  std::int64_t cycles = 0, n_eroded = 0, n_looks = 0;
  std::int64_t n_inside = 0, n_unpushed = 0;  // sightings of intruders of another part
  std::int64_t n_inside_own = 0, n_unpushed_own = 0;
  double deepest = 0.0, deepest_own = 0.0;  // as Intruder::depth
  std::int64_t n_ends_inside = 0;  // intruders of another part at the last look
  std::string worst;  // sentence about the deepest sighting
  ForceComparison forces;  // engine against brute force, at every look
  double energy_error = 0.0;  // at the end, over the initial energy
  std::string state_hash;  // at the end
};

/// The input file of a flight.
std::string flight_input(const Flight& flight);

/// Runs it on the ranks of `comm`; the report is complete on rank 0. Collective.
FlightReport fly(const Flight& flight, MPI_Comm comm = MPI_COMM_WORLD);

}  // namespace kerf::test
