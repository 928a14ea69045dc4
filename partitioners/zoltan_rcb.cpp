// Recursive coordinate bisection, the default partitioner, and the division of space that contact uses.
//
// M.J. Berger & S.H. Bokhari, "A partitioning strategy for nonuniform problems on multiprocessors", IEEE Trans.
// Computers C-36 (1987) 570-580. Cuts move a little when the weights change a little, so few elements migrate.
#include "zoltan_support.hpp"

namespace kerf {
namespace {

std::string flag(bool on) { return on ? "1" : "0"; }

/// Boxes of equal work, found from weighted points by recursive bisection.
class RcbDecomposition final : public SpatialDecomposition {
 public:
  explicit RcbDecomposition(double tolerance) : tolerance_(tolerance) {}

  void build(MPI_Comm comm, const std::vector<double>& coordinates, const std::vector<double>& weights) override {
    int n_ranks = 1, rank = 0;
    MPI_Comm_size(comm, &n_ranks);
    MPI_Comm_rank(comm, &rank);
    PartitionProblem problem;
    problem.comm = comm;
    problem.n_parts = n_ranks;
    problem.coordinates = coordinates;
    problem.weights = weights;
    problem.ids.resize(weights.size());
    for (std::size_t i = 0; i < weights.size(); ++i)
      problem.ids[i] = (static_cast<std::int64_t>(rank) << 40) + static_cast<std::int64_t>(i);
    const PartitionSummary summary = check_problem(problem, ZoltanSees::places);
    // Without points there is nothing to cut: rank 0 owns all of space.
    if (n_ranks == 1 || summary.empty) {
      session_.reset();
      return;
    }
    if (!session_ || !session_->serves(comm)) {
      session_.reset();
      session_ = std::make_unique<ZoltanSession>(comm, ZoltanParameters{{"LB_METHOD", "RCB"},
                                                                        {"KEEP_CUTS", "1"},
                                                                        {"RCB_REUSE", "1"},
                                                                        {"AVERAGE_CUTS", "1"},
                                                                        {"RETURN_LISTS", "NONE"},
                                                                        {"IMBALANCE_TOL", std::to_string(tolerance_)}});
    }
    try {
      session_->partition(problem, scaled_weights(weights, summary.largest_weights), ZoltanSees::places);
    } catch (...) {
      session_.reset();
      throw;
    }
  }

  int owner(Vec3 point) const override { return session_ ? session_->owner(point) : 0; }

  void owners(Vec3 low, Vec3 high, std::vector<int>& ranks) const override {
    if (session_)
      session_->owners(low, high, ranks);
    else
      ranks.assign(1, 0);
  }

 private:
  double tolerance_;
  std::unique_ptr<ZoltanSession> session_;  // null where rank 0 owns everything
};

class ZoltanRcb final : public ZoltanPartitioner {
 public:
  static void describe(Schema<ZoltanRcb>& s) {
    describe_zoltan(s);
    s.boolean(&ZoltanRcb::reuse_cuts, "reuse_cuts",
              "start each re-balance from the cuts of the one before and keep their directions, so that little moves")
        .by_default("true");
    s.boolean(&ZoltanRcb::rectilinear, "rectilinear",
              "keep elements whose centres lie in the same plane on the same side of a cut, at some cost in balance")
        .by_default("false");
    s.choice(&ZoltanRcb::criteria, "criteria", {"elements", "elements_and_contact"},
             "what is to be balanced: the work of elements, or that and the work of contact, each by itself")
        .by_default("elements");
    s.choice(&ZoltanRcb::norm, "norm", {"sum", "euclidean", "maximum"},
             "how the shares of two criteria on one side of a cut become one number; for elements_and_contact")
        .by_default("maximum");
  }

  bool needs_contact_work() const override { return criteria == "elements_and_contact"; }

  std::unique_ptr<SpatialDecomposition> spatial() const override {
    return std::make_unique<RcbDecomposition>(imbalance_tolerance);
  }

  bool reuse_cuts = true, rectilinear = false;
  std::string criteria = "elements", norm = "maximum";

 protected:
  // Zoltan's bisection by two criteria does not start from cuts.
  bool keeps_session() const override { return reuse_cuts && !needs_contact_work(); }
  ZoltanParameters method(const PartitionProblem& problem) const override {
    int n_ranks = 1;
    MPI_Comm_size(problem.comm, &n_ranks);
    const bool keeps = keeps_session() && problem.n_parts == n_ranks;
    ZoltanParameters all{{"LB_METHOD", "RCB"},
                         {"AVERAGE_CUTS", "1"},
                         {"KEEP_CUTS", flag(keeps)},
                         {"RCB_REUSE", flag(keeps)},
                         {"RCB_LOCK_DIRECTIONS", flag(keeps)},
                         {"RCB_RECTILINEAR_BLOCKS", flag(rectilinear)}};
    if (needs_contact_work())
      all.emplace_back("RCB_MULTICRITERIA_NORM", norm == "sum" ? "1" : norm == "euclidean" ? "2" : "3");
    return all;
  }
};

}  // namespace
}  // namespace kerf

KERF_PARTITIONER(kerf::ZoltanRcb, "zoltan_rcb", "recursive coordinate bisection: compact boxes, little migration")
