// What the partitioners built on Zoltan share: a load-balancing session behind value types.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "kerf/partitioner.hpp"

struct Zoltan_Struct;

namespace kerf {

/// Zoltan's own parameters: names and values as its user guide spells them.
using ZoltanParameters = std::vector<std::pair<std::string, std::string>>;

/// What a method of Zoltan sees of the elements beside their places and weights.
enum class ZoltanSees { places, graph, hypergraph };

/// One Zoltan structure on one communicator: takes weighted elements, gives back parts and, with KEEP_CUTS,
/// answers where points and boxes lie. Every failure is thrown as std::runtime_error on all ranks.
class ZoltanSession {
 public:
  /// Collective.
  ZoltanSession(MPI_Comm comm, const ZoltanParameters& parameters);
  ~ZoltanSession();
  ZoltanSession(const ZoltanSession&) = delete;
  ZoltanSession& operator=(const ZoltanSession&) = delete;

  /// True where `comm` holds the same ranks in the same order as the communicator this was made for. Local.
  bool serves(MPI_Comm comm) const;
  /// Collective. Pre: `weights` are not negative, one is positive on some rank, and more than one part is asked for.
  /// With RETURN_LISTS=NONE it keeps the cuts only and returns nothing.
  std::vector<int> partition(const PartitionProblem& problem, const std::vector<float>& weights, ZoltanSees sees);
  /// Pre: KEEP_CUTS=1 and a call to partition(). A point on a cut belongs to the lower side.
  int owner(Vec3 point) const;
  /// Ranks, ascending, of which the closed box touches the region. Contains owner(p) for every p in the box.
  void owners(Vec3 low, Vec3 high, std::vector<int>& ranks) const;

 private:
  std::vector<int> call(const PartitionProblem& problem);
  void check(int code, const char* what) const;

  MPI_Comm comm_ = MPI_COMM_NULL;
  Zoltan_Struct* zoltan_ = nullptr;
  int n_ranks_ = 1;
  bool lists_parts_ = true;
};

/// What all ranks know about a problem once it is found to be well formed.
struct PartitionSummary {
  bool empty = true;  // no element on any rank
  std::vector<double> largest_weights;  // of each of an element's weights, over all ranks
};

/// Collective. Throws std::runtime_error on all ranks where an array of any rank has the wrong length, a value
/// that is not finite, a negative weight, a part that is not asked for, or neighbours on ranks that do not exist.
PartitionSummary check_problem(const PartitionProblem& problem, ZoltanSees sees);

/// Weights scaled to a largest one of 1, since Zoltan keeps them in single precision; ones where all are zero.
std::vector<float> scaled_weights(const std::vector<double>& weights, const std::vector<double>& largest);

/// Base of the Zoltan partitioners: they differ in the parameters they set and in what they see.
class ZoltanPartitioner : public Partitioner {
 public:
  std::vector<int> partition(const PartitionProblem& problem) final;
  bool needs_graph() const final { return sees() == ZoltanSees::graph; }
  bool needs_nodes() const final { return sees() == ZoltanSees::hypergraph; }

  double imbalance_tolerance = 1.03;

 protected:
  /// Parameters of the method, LB_METHOD among them.
  virtual ZoltanParameters method(const PartitionProblem& problem) const = 0;
  virtual ZoltanSees sees() const { return ZoltanSees::places; }
  /// Called before every partition.
  virtual void begin() const {}
  /// Whether the next call starts from what this one found. Only then may a result depend on earlier calls.
  virtual bool keeps_session() const { return false; }

 private:
  std::unique_ptr<ZoltanSession> session_;
};

/// The value of LB_APPROACH for "repartition", "partition" or "refine". Elements whose present parts are not known,
/// since another number of parts than ranks is asked for, are partitioned afresh. Collective.
const char* zoltan_approach(const std::string& approach, const PartitionProblem& problem);

/// Declares how a method goes about elements that are distributed already.
template <class T>
void describe_approach(Schema<T>& s, std::string T::*member) {
  s.choice(member, "approach", {"repartition", "partition", "refine"},
           "repartition weighs communication against migration, partition starts afresh, refine changes little")
      .by_default("repartition");
}

/// Declares the parameters that all of them take.
template <class T>
void describe_zoltan(Schema<T>& s) {
  s.real(&ZoltanPartitioner::imbalance_tolerance, "imbalance_tolerance", "-", Range{1.0, 10.0, true, false},
         "largest load of a part over the mean that the partitioner aims at")
      .by_default("1.03");
}

}  // namespace kerf
