// Recursive inertial bisection: cuts at right angles to the longest principal axis of each piece.
//
// H.D. Simon, "Partitioning of unstructured problems for parallel processing", Computing Systems in Engineering 2
// (1991) 135-148. Suits slender bodies that lie at an angle to the coordinate axes.
#include "zoltan_support.hpp"

namespace kerf {
namespace {

class ZoltanRib final : public ZoltanPartitioner {
 public:
  static void describe(Schema<ZoltanRib>& s) { describe_zoltan(s); }

 protected:
  ZoltanParameters method(const PartitionProblem&) const override {
    return {{"LB_METHOD", "RIB"}, {"AVERAGE_CUTS", "1"}};
  }
};

}  // namespace
}  // namespace kerf

KERF_PARTITIONER(kerf::ZoltanRib, "zoltan_rib", "recursive inertial bisection, for slender bodies at an angle")
