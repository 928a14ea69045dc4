// The whole model on one rank: parts with their laws and elements, nodes, and the plans that tie ranks together.
#pragma once

#include <mpi.h>

#include <memory>
#include <string>
#include <vector>

#include "input/model_input.hpp"
#include "input/placement.hpp"
#include "model/joining.hpp"
#include "model/law_reads.hpp"
#include "model/memberships.hpp"
#include "model/node_store.hpp"
#include "model/part_store.hpp"
#include "model/surface.hpp"
#include "parallel/exchange_plan.hpp"

namespace kerf {

/// A body: its laws (owned by the input), the numbers of its mesh, its elements on this rank.
struct PartModel {
  const PartInput* input = nullptr;
  const MaterialInput* material = nullptr;
  std::int64_t first_element = 0, n_elements = 0;  // global ids of the undeformed mesh
  std::int64_t first_node = 0, n_nodes = 0;  // of the mesh, before parts were joined: see SharedNodes
  std::int64_t first_own_node = 0;  // nodes from here to that of the next part have this as their first part
  std::int32_t body = 0;  // the first of the parts that the input joins with it, directly or through others
  std::int64_t shift_in_body = 0;  // added to the id of an element, it numbers the elements of each body without gaps
  double bulk_modulus = 0.0;  // of the undeformed material [Pa]
  double grueneisen = 0.0, grueneisen_compressed = 0.0;  // dp/d(rho e) there, and at 1.1 times the density [-]
  double shear_modulus = 0.0;  // [Pa]
  double initial_pressure = 0.0;  // [Pa]
  double hot_stiffness = 0.0;  // greatest modulus or pressure with the initial energies of the input [Pa]
  double initial_mass = 0.0;  // [kg]
  double initial_energy = 0.0;  // internal energy per mass at the start, which the store does not contain [J/kg]
  int first_criterion_state = 0;  // component of the erosion state where the first criterion's begins
  double work = 1.0;  // work of one element and cycle, for the work model
  std::unique_ptr<Placement> placement;
  std::unique_ptr<PartStore> store;
  LawReads material_reads, eos_reads;  // of the strength or solid, and of the EOS
};

/// Forces of one step and sums over the run, in whole quanta; see design, section 5.
struct Quanta {
  ForceScale force;
  double energy = 1.0, per_energy = 1.0;  // [J], [1/J]; powers of two
  double mass = 1.0;  // [kg]; a power of two
};

struct Model {
  MPI_Comm comm = MPI_COMM_NULL;
  const ModelInput* input = nullptr;
  std::vector<PartModel> parts;
  std::vector<std::string> set_names;
  Memberships memberships;  // of nodes in parts and sets
  SharedNodes shared;
  std::int64_t n_elements = 0, n_nodes = 0;
  Quanta quanta;
  double dummy_edge = 1.0;  // [m]
  MeshScale scale;

  NodeStore nodes;
  std::vector<std::int32_t> live_elements;  // per local node: live elements of this rank that touch it
  std::vector<int> node_owner;  // per local node: rank
  std::vector<std::int32_t> ghosts;  // local nodes owned by another rank, in the plan's order
  std::unique_ptr<ExchangePlan> ghost_plan;  // owner to ghosts; null on one rank
  Surface surface;

  /// The part of the model that the surface reads.
  SurfaceMesh surface_mesh() const { return {parts, nodes, ghosts, ghost_plan.get(), comm, rank_}; }
  int n_ranks() const { return n_ranks_; }
  int rank() const { return rank_; }
  void set_comm(MPI_Comm c) {
    comm = c;
    MPI_Comm_size(c, &n_ranks_);
    MPI_Comm_rank(c, &rank_);
  }
  std::int64_t n_live_local() const {
    std::int64_t n = 0;
    for (const PartModel& p : parts) n += p.store->n_live();
    return n;
  }
  /// The first of the parts that a node belongs to, by the node's id.
  std::int32_t part_of_node(std::int64_t id) const;
  /// All parts that a local node belongs to.
  const std::vector<std::int32_t>& parts_of(int node) const { return memberships[nodes.membership[node]].parts; }
  bool belongs_to(int node, std::int32_t part) const;
  /// Part of an element, by its id.
  std::int32_t part_of_element(std::int64_t id) const;
  /// Whether parts may share nodes.
  bool has_joined_parts() const { return has_joined_parts_; }
  void set_joined_parts(bool joined) { has_joined_parts_ = joined; }
  /// Local index of a node id, -1 where this rank has no copy.
  std::int32_t local_node(std::int64_t id) const;
  /// To be called whenever local nodes came, went or changed places.
  void index_nodes();
  /// Another number after every call of index_nodes().
  std::int64_t node_arrangement() const { return node_arrangement_; }

 private:
  bool has_joined_parts_ = false;
  std::vector<std::int32_t> by_id_;  // local nodes in the order of their ids
  std::int64_t node_arrangement_ = 0;
  int n_ranks_ = 1, rank_ = 0;
};

}  // namespace kerf
