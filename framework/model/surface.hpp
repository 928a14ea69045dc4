// Knows which faces of live elements are exterior, as elements die on this and on other ranks.
//
// Elements are numbered through all parts of the rank: slot of part p plus the part's offset. Neighbours may be of
// different parts, where these share nodes. Faces are numbered as the shape of their element says, nodes
// counter-clockwise seen from outside. What is collapsed to a line is no face.
#pragma once

#include <mpi.h>

#include <array>
#include <compare>
#include <cstdint>
#include <memory>
#include <vector>

#include "kerf/shape.hpp"
#include "parallel/exchange_plan.hpp"

namespace kerf {

struct NodeStore;
struct PartModel;

struct ExteriorFacet {
  std::int32_t part = 0, slot = 0, face = 0;
  std::array<std::int32_t, 4> nodes = {};  // of the corners, in the order of the shape
  auto operator<=>(const ExteriorFacet&) const = default;
};

/// What the surface reads of the model.
struct SurfaceMesh {
  const std::vector<PartModel>& parts;
  const NodeStore& nodes;
  const std::vector<std::int32_t>& ghosts;  // local nodes owned by another rank
  const ExchangePlan* ghost_plan;  // owner to ghosts; null on one rank
  MPI_Comm comm;
  int rank;
  bool is_parallel() const { return ghost_plan != nullptr; }
};

class Surface {
 public:
  /// Finds all neighbours across faces, on this and other ranks. Collective.
  void build(const SurfaceMesh& mesh);
  /// After elements were retired: learns which neighbours on other ranks have died. Collective.
  void update(const SurfaceMesh& mesh);
  /// Faces of this rank's live elements that were opened by the elements retired since the previous update(), here or
  /// on other ranks. Call exactly once after each update(). Local.
  std::vector<ExteriorFacet> opened_by(const SurfaceMesh& mesh, const std::vector<ExteriorFacet>& retired);
  /// Those exterior faces that have a corner among the marked nodes, in any order. Local.
  std::vector<ExteriorFacet> exterior_round(const SurfaceMesh& mesh, const std::vector<char>& marked);
  /// Renumbers after a part was compacted; `moved` as returned by PartStore::compact.
  void compact(const SurfaceMesh& mesh, const std::vector<std::vector<std::int32_t>>& moved);
  /// All exterior faces of live elements of this rank, in the order of the elements. Local.
  const std::vector<ExteriorFacet>& exterior(const SurfaceMesh& mesh);
  /// Neighbours of a live element for graph partitioning: global id and rank of each live neighbour.
  void neighbours(const SurfaceMesh& mesh, int part, int slot, std::vector<std::int64_t>& ids,
                  std::vector<int>& ranks) const;

 private:
  using Neighbours = std::array<std::int32_t, Shape::most_faces>;  // across each face
  static constexpr std::int32_t none = -1;
  static constexpr Neighbours all_none = {none, none, none, none, none, none};
  static constexpr std::int32_t first_remote = -2;  // code of remote neighbour r is first_remote - r
  /// Where an element is.
  struct Place {
    std::int32_t part, slot;
  };
  Place place_of(std::int32_t element, std::int32_t likely_part) const;
  void match_local(const SurfaceMesh& mesh, std::vector<std::int64_t>& open);
  void match_remote(const SurfaceMesh& mesh, const std::vector<std::int64_t>& open);
  void find_exterior(const SurfaceMesh& mesh);
  bool open_face(const SurfaceMesh& mesh, int part, std::int32_t element, int face) const;

  std::vector<std::int32_t> offset_;  // first element number of each part, and the end
  std::vector<Neighbours> neighbour_;  // element number, none, or a remote code
  std::vector<std::int64_t> remote_id_;
  std::vector<int> remote_rank_;
  struct RemoteFace {
    std::int32_t remote, element, face;
  };
  std::vector<RemoteFace> remote_faces_;  // faces whose neighbour is remote
  std::vector<char> remote_died_;  // found dead by the last update
  std::vector<std::int64_t> remote_alive_, alive_;
  // What exterior() said last, then what has opened since; followed from death to death, for elements are many.
  enum class Known { nothing, all_but_last_deaths, all };
  Known known_ = Known::nothing;
  std::vector<ExteriorFacet> exterior_;
  std::size_t n_sorted_ = 0;
  bool tidy_ = false;  // sorted, and none of a dead element
  std::unique_ptr<ExchangePlan> plan_;
};

}  // namespace kerf
