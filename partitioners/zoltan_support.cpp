// Calls Zoltan: hands elements over through its query functions and takes owners back.
#include "zoltan_support.hpp"

#include <zoltan.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace kerf {
namespace {

// A global id of Kerf is 64 bits wide; Zoltan's is as wide as it was configured, and may take several entries.
constexpr int entry_bits = 8 * static_cast<int>(sizeof(ZOLTAN_ID_TYPE));
constexpr int id_entries = entry_bits >= 64 ? 1 : 64 / entry_bits;

/// What the query functions read.
struct Input {
  const PartitionProblem& problem;
  const std::vector<float>& weights;  // problem.n_weights per element
  int rank;
};

const Input& input_of(void* data) { return *static_cast<const Input*>(data); }

// The most significant entry comes first, so that Zoltan's order of ids is ours.
void write_id(std::int64_t id, ZOLTAN_ID_TYPE* entries) {
  auto rest = static_cast<std::uint64_t>(id);
  for (int k = id_entries - 1; k >= 0; --k) {
    entries[k] = static_cast<ZOLTAN_ID_TYPE>(rest);
    if constexpr (id_entries > 1) rest >>= entry_bits;
  }
}

int count_elements(void* data, int* error) {
  *error = ZOLTAN_OK;
  return static_cast<int>(input_of(data).problem.ids.size());
}

void list_elements(void* data, int, int, ZOLTAN_ID_PTR global, ZOLTAN_ID_PTR local, int, float* weights, int* error) {
  const Input& in = input_of(data);
  for (std::size_t i = 0; i < in.problem.ids.size(); ++i) {
    write_id(in.problem.ids[i], global + id_entries * i);
    local[i] = static_cast<ZOLTAN_ID_TYPE>(i);
  }
  std::copy(in.weights.begin(), in.weights.end(), weights);
  *error = ZOLTAN_OK;
}

void list_parts(void* data, int, int, int n, ZOLTAN_ID_PTR, ZOLTAN_ID_PTR local, int* parts, int* error) {
  const Input& in = input_of(data);
  const std::vector<int>& present = in.problem.present_parts;
  for (int i = 0; i < n; ++i) parts[i] = present.empty() ? in.rank : present[local[i]];
  *error = ZOLTAN_OK;
}

void list_sizes(void* data, int, int, int n, ZOLTAN_ID_PTR, ZOLTAN_ID_PTR local, int* sizes, int* error) {
  for (int i = 0; i < n; ++i) sizes[i] = input_of(data).problem.record_bytes[local[i]];
  *error = ZOLTAN_OK;
}

int count_dimensions(void*, int* error) {
  *error = ZOLTAN_OK;
  return 3;
}

void list_coordinates(void* data, int, int, int n, ZOLTAN_ID_PTR, ZOLTAN_ID_PTR local, int, double* out, int* error) {
  const std::vector<double>& x = input_of(data).problem.coordinates;
  for (int i = 0; i < n; ++i) std::copy_n(x.begin() + 3 * static_cast<std::ptrdiff_t>(local[i]), 3, out + 3 * i);
  *error = ZOLTAN_OK;
}

void count_neighbours(void* data, int, int, int n, ZOLTAN_ID_PTR, ZOLTAN_ID_PTR local, int* counts, int* error) {
  const std::vector<std::int64_t>& first = input_of(data).problem.first;
  for (int i = 0; i < n; ++i) counts[i] = static_cast<int>(first[local[i] + 1] - first[local[i]]);
  *error = ZOLTAN_OK;
}

void list_neighbours(void* data, int, int, int n, ZOLTAN_ID_PTR, ZOLTAN_ID_PTR local, int*, ZOLTAN_ID_PTR neighbours,
                     int* ranks, int, float*, int* error) {
  const PartitionProblem& p = input_of(data).problem;
  std::size_t out = 0;
  for (int i = 0; i < n; ++i) {
    for (std::int64_t k = p.first[local[i]]; k < p.first[local[i] + 1]; ++k, ++out) {
      write_id(p.neighbours[static_cast<std::size_t>(k)], neighbours + id_entries * out);
      ranks[out] = p.neighbour_ranks[static_cast<std::size_t>(k)];
    }
  }
  *error = ZOLTAN_OK;
}

// Nodes are hyperedges; each element is handed over with the list of its nodes.
void count_pins(void* data, int* n_lists, int* n_pins, int* format, int* error) {
  const PartitionProblem& p = input_of(data).problem;
  *n_lists = static_cast<int>(p.ids.size());
  *n_pins = static_cast<int>(p.nodes.size());
  *format = ZOLTAN_COMPRESSED_VERTEX;
  *error = ZOLTAN_OK;
}

void list_pins(void* data, int, int, int, int, ZOLTAN_ID_PTR elements, int* first, ZOLTAN_ID_PTR nodes, int* error) {
  const PartitionProblem& p = input_of(data).problem;
  for (std::size_t i = 0; i < p.ids.size(); ++i) {
    write_id(p.ids[i], elements + id_entries * i);
    first[i] = static_cast<int>(p.first_node[i]);
  }
  for (std::size_t k = 0; k < p.nodes.size(); ++k) write_id(p.nodes[k], nodes + id_entries * k);
  *error = ZOLTAN_OK;
}

/// What is wrong with a problem; the largest value over all ranks is what all of them report.
enum class Fault { none, lengths, coordinates, weights, present, sizes, graph, nodes };

const char* sentence(Fault fault) {
  switch (fault) {
    case Fault::lengths:
      return "the partitioner was given coordinates or weights that do not match the number of elements";
    case Fault::coordinates:
      return "the partitioner was given an element whose coordinates are not finite; the run has become unstable";
    case Fault::weights:
      return "the partitioner was given an element whose work is negative or not finite";
    case Fault::present:
      return "the partitioner was given a present part that is not one of those asked for";
    case Fault::sizes:
      return "the partitioner was given records of elements without a positive size";
    case Fault::nodes:
      return "the partitioner was given lists of nodes that do not match the elements, or are longer than 2^31";
    default:
      return "the partitioner was given a graph of neighbours that does not match the elements and ranks";
  }
}

bool graph_fits(const PartitionProblem& p, int n_ranks) {
  const std::size_t n = p.ids.size();
  if (n == 0) return p.neighbours.empty();
  if (p.first.size() != n + 1 || p.first.front() != 0) return false;
  if (!std::is_sorted(p.first.begin(), p.first.end())) return false;
  const auto n_edges = static_cast<std::size_t>(p.first.back());
  return n_edges == p.neighbours.size() && n_edges == p.neighbour_ranks.size() &&
         std::all_of(p.neighbour_ranks.begin(), p.neighbour_ranks.end(),
                     [n_ranks](int r) { return r >= 0 && r < n_ranks; });
}

bool nodes_fit(const PartitionProblem& p) {
  const std::size_t n = p.ids.size();
  if (n == 0) return p.nodes.empty();
  return p.first_node.size() == n + 1 && p.first_node.front() == 0 &&
         std::is_sorted(p.first_node.begin(), p.first_node.end()) &&
         static_cast<std::size_t>(p.first_node.back()) == p.nodes.size() &&
         p.nodes.size() <= static_cast<std::size_t>(std::numeric_limits<int>::max());
}

Fault fault_of(const PartitionProblem& p, ZoltanSees sees, int n_ranks) {
  const std::size_t n = p.ids.size();
  if (p.n_weights < 1 || p.coordinates.size() != 3 * n || p.weights.size() != n * static_cast<std::size_t>(p.n_weights))
    return Fault::lengths;
  const auto finite = [](double x) { return std::isfinite(x); };
  if (!std::all_of(p.coordinates.begin(), p.coordinates.end(), finite)) return Fault::coordinates;
  if (!std::all_of(p.weights.begin(), p.weights.end(), [](double w) { return w >= 0.0 && std::isfinite(w); }))
    return Fault::weights;
  if (!p.present_parts.empty() &&
      (p.present_parts.size() != n || !std::all_of(p.present_parts.begin(), p.present_parts.end(),
                                                   [&p](int part) { return part >= 0 && part < p.n_parts; })))
    return Fault::present;
  if (sees == ZoltanSees::graph && !graph_fits(p, n_ranks)) return Fault::graph;
  if (sees == ZoltanSees::hypergraph && !nodes_fit(p)) return Fault::nodes;
  if (sees == ZoltanSees::hypergraph &&
      (p.record_bytes.size() != n ||
       !std::all_of(p.record_bytes.begin(), p.record_bytes.end(), [](int bytes) { return bytes > 0; })))
    return Fault::sizes;
  return Fault::none;
}

/// The part of each element now; on ranks beyond the number of parts it is the last one.
std::vector<int> present_parts(const PartitionProblem& problem) {
  if (!problem.present_parts.empty()) return problem.present_parts;
  int rank = 0;
  MPI_Comm_rank(problem.comm, &rank);
  return std::vector<int>(problem.ids.size(), std::min(rank, problem.n_parts - 1));
}

}  // namespace

ZoltanSession::ZoltanSession(MPI_Comm comm, const ZoltanParameters& parameters) {
  static const int initialised = [] {
    float version = 0.0F;
    return Zoltan_Initialize(0, nullptr, &version);
  }();
  MPI_Comm_dup(comm, &comm_);
  MPI_Comm_size(comm_, &n_ranks_);
  zoltan_ = Zoltan_Create(comm_);
  const auto set = [this](const std::string& name, const std::string& value) {
    return zoltan_ != nullptr && Zoltan_Set_Param(zoltan_, name.c_str(), value.c_str()) == ZOLTAN_OK;
  };
  bool good = initialised == ZOLTAN_OK && set("DEBUG_LEVEL", "0") &&
              set("NUM_GID_ENTRIES", std::to_string(id_entries)) && set("NUM_LID_ENTRIES", "1") &&
              set("RETURN_LISTS", "PARTS") && set("REMAP", "1");
  for (const auto& [name, value] : parameters) {
    good = good && set(name, value);
    if (name == "RETURN_LISTS") lists_parts_ = value == "PARTS";
  }
  check(good ? ZOLTAN_OK : ZOLTAN_FATAL, "could not be set up: it does not know one of its parameters");
}

ZoltanSession::~ZoltanSession() {
  // A session that outlives MPI has nothing left to free: its communicators are gone.
  int finalised = 0;
  MPI_Finalized(&finalised);
  if (finalised != 0) return;
  if (zoltan_ != nullptr) Zoltan_Destroy(&zoltan_);
  if (comm_ != MPI_COMM_NULL) MPI_Comm_free(&comm_);
}

bool ZoltanSession::serves(MPI_Comm comm) const {
  int result = MPI_UNEQUAL;
  MPI_Comm_compare(comm_, comm, &result);
  return result == MPI_CONGRUENT || result == MPI_IDENT;
}

// Warnings (for example that the tolerance could not be reached) leave a valid partition.
void ZoltanSession::check(int code, const char* what) const {
  int failed = code == ZOLTAN_OK || code == ZOLTAN_WARN ? 0 : 1;
  MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, comm_);
  if (failed != 0) throw std::runtime_error(std::string("the partitioning library Zoltan ") + what);
}

std::vector<int> ZoltanSession::partition(const PartitionProblem& problem, const std::vector<float>& weights,
                                          ZoltanSees sees) {
  int rank = 0;
  MPI_Comm_rank(comm_, &rank);
  Input input{problem, weights, rank};
  Zoltan_Set_Num_Obj_Fn(zoltan_, count_elements, &input);
  Zoltan_Set_Obj_List_Fn(zoltan_, list_elements, &input);
  Zoltan_Set_Num_Geom_Fn(zoltan_, count_dimensions, &input);
  Zoltan_Set_Geom_Multi_Fn(zoltan_, list_coordinates, &input);
  Zoltan_Set_Part_Multi_Fn(zoltan_, list_parts, &input);
  if (sees == ZoltanSees::graph) {
    Zoltan_Set_Num_Edges_Multi_Fn(zoltan_, count_neighbours, &input);
    Zoltan_Set_Edge_List_Multi_Fn(zoltan_, list_neighbours, &input);
  }
  if (sees == ZoltanSees::hypergraph) {
    Zoltan_Set_HG_Size_CS_Fn(zoltan_, count_pins, &input);
    Zoltan_Set_HG_CS_Fn(zoltan_, list_pins, &input);
    Zoltan_Set_Obj_Size_Multi_Fn(zoltan_, list_sizes, &input);
  }
  const bool accepted =
      Zoltan_Set_Param(zoltan_, "NUM_GLOBAL_PARTS", std::to_string(problem.n_parts).c_str()) == ZOLTAN_OK &&
      Zoltan_Set_Param(zoltan_, "OBJ_WEIGHT_DIM", std::to_string(problem.n_weights).c_str()) == ZOLTAN_OK;
  check(accepted ? ZOLTAN_OK : ZOLTAN_FATAL, "does not take the number of parts or of weights");
  return call(problem);
}

/// What Zoltan lists for every element of this rank.
std::vector<int> ZoltanSession::call(const PartitionProblem& problem) {
  int changes = 0, n_gid = 0, n_lid = 0, n_import = 0, n_export = 0;
  ZOLTAN_ID_PTR import_global = nullptr, import_local = nullptr, export_global = nullptr, export_local = nullptr;
  int *import_ranks = nullptr, *import_parts = nullptr, *export_ranks = nullptr, *export_parts = nullptr;
  const int code =
      Zoltan_LB_Partition(zoltan_, &changes, &n_gid, &n_lid, &n_import, &import_global, &import_local, &import_ranks,
                          &import_parts, &n_export, &export_global, &export_local, &export_ranks, &export_parts);
  // Without lists, although they were asked for, everything stays where it is.
  std::vector<int> parts = lists_parts_ ? present_parts(problem) : std::vector<int>{};
  bool good = code == ZOLTAN_OK || code == ZOLTAN_WARN;
  good = good && (n_export <= 0 || static_cast<std::size_t>(n_export) == parts.size());
  for (int i = 0; good && i < n_export; ++i) {
    good = export_local[i] < parts.size() && export_parts[i] >= 0 && export_parts[i] < problem.n_parts;
    if (good) parts[export_local[i]] = export_parts[i];
  }
  Zoltan_LB_Free_Part(&import_global, &import_local, &import_ranks, &import_parts);
  Zoltan_LB_Free_Part(&export_global, &export_local, &export_ranks, &export_parts);
  check(good ? ZOLTAN_OK : ZOLTAN_FATAL, "could not find a partition; try another partitioner");
  return parts;
}

int ZoltanSession::owner(Vec3 point) const {
  std::array<double, 3> x{point.x, point.y, point.z};
  int rank = -1, part = -1;
  if (Zoltan_LB_Point_PP_Assign(zoltan_, x.data(), &rank, &part) != ZOLTAN_OK || rank < 0)
    throw std::runtime_error("the partitioning library Zoltan could not find the owner of a point");
  return rank;
}

void ZoltanSession::owners(Vec3 low, Vec3 high, std::vector<int>& ranks) const {
  ranks.resize(static_cast<std::size_t>(n_ranks_));
  int n = 0;
  if (Zoltan_LB_Box_Assign(zoltan_, low.x, low.y, low.z, high.x, high.y, high.z, ranks.data(), &n) != ZOLTAN_OK)
    throw std::runtime_error("the partitioning library Zoltan could not find the owners of a box");
  ranks.resize(static_cast<std::size_t>(n));
  std::sort(ranks.begin(), ranks.end());
}

PartitionSummary check_problem(const PartitionProblem& problem, ZoltanSees sees) {
  int n_ranks = 1;
  MPI_Comm_size(problem.comm, &n_ranks);
  const Fault fault = fault_of(problem, sees, n_ranks);
  std::array<double, 2> common{static_cast<double>(fault), problem.ids.empty() ? 0.0 : 1.0};
  MPI_Allreduce(MPI_IN_PLACE, common.data(), 2, MPI_DOUBLE, MPI_MAX, problem.comm);
  const auto worst = static_cast<Fault>(static_cast<int>(common[0]));
  if (worst != Fault::none) throw std::runtime_error(sentence(worst));
  PartitionSummary summary{common[1] == 0.0, std::vector<double>(static_cast<std::size_t>(problem.n_weights), 0.0)};
  for (std::size_t k = 0; k < problem.weights.size(); ++k) {
    double& largest = summary.largest_weights[k % summary.largest_weights.size()];
    largest = max_of(largest, problem.weights[k]);
  }
  MPI_Allreduce(MPI_IN_PLACE, summary.largest_weights.data(), problem.n_weights, MPI_DOUBLE, MPI_MAX, problem.comm);
  return summary;
}

std::vector<float> scaled_weights(const std::vector<double>& weights, const std::vector<double>& largest) {
  std::vector<float> scaled(weights.size(), 1.0F);
  for (std::size_t k = 0; k < weights.size(); ++k)
    if (const double unit = largest[k % largest.size()]; unit > 0.0) scaled[k] = static_cast<float>(weights[k] / unit);
  return scaled;
}

const char* zoltan_approach(const std::string& approach, const PartitionProblem& problem) {
  int n_ranks = 1, knows_parts = problem.present_parts.empty() ? 0 : 1;
  MPI_Comm_size(problem.comm, &n_ranks);
  MPI_Allreduce(MPI_IN_PLACE, &knows_parts, 1, MPI_INT, MPI_MAX, problem.comm);
  if (approach == "partition" || (knows_parts == 0 && problem.n_parts != n_ranks)) return "PARTITION";
  return approach == "refine" ? "REFINE" : "REPARTITION";
}

std::vector<int> ZoltanPartitioner::partition(const PartitionProblem& problem) {
  const PartitionSummary summary = check_problem(problem, sees());
  int n_ranks = 1;
  MPI_Comm_size(problem.comm, &n_ranks);
  if (problem.n_parts == 1 || summary.empty) return std::vector<int>(problem.ids.size(), 0);
  // Not worth moving, and some methods fail at it.
  auto n_elements = static_cast<std::int64_t>(problem.ids.size());
  MPI_Allreduce(MPI_IN_PLACE, &n_elements, 1, MPI_INT64_T, MPI_SUM, problem.comm);
  if (n_elements < problem.n_parts) return present_parts(problem);
  // What a call leaves behind belongs to as many parts as there are ranks.
  const bool keeps = keeps_session() && problem.n_parts == n_ranks;
  if (!session_ || !keeps || !session_->serves(problem.comm)) {
    session_.reset();
    ZoltanParameters parameters = method(problem);
    parameters.emplace_back("IMBALANCE_TOL", std::to_string(imbalance_tolerance));
    session_ = std::make_unique<ZoltanSession>(problem.comm, parameters);
  }
  begin();
  try {
    std::vector<int> parts =
        session_->partition(problem, scaled_weights(problem.weights, summary.largest_weights), sees());
    if (!keeps) session_.reset();
    return parts;
  } catch (...) {
    session_.reset();  // whatever state a failure has left behind must not reach the next call
    throw;
  }
}

}  // namespace kerf
