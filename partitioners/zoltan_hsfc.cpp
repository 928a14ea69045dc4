// Hilbert space-filling curve: orders the elements along the curve and cuts it into pieces of equal work.
//
// J.R. Pilkington & S.B. Baden, "Dynamic partitioning of non-uniform structured workloads with spacefilling curves",
// IEEE Trans. Parallel Distrib. Syst. 7 (1996) 288-300. The fastest of the geometric methods; its surfaces are
// larger than those of the bisections.
#include "zoltan_support.hpp"

namespace kerf {
namespace {

class ZoltanHsfc final : public ZoltanPartitioner {
 public:
  static void describe(Schema<ZoltanHsfc>& s) { describe_zoltan(s); }

 protected:
  ZoltanParameters method(const PartitionProblem&) const override { return {{"LB_METHOD", "HSFC"}}; }
};

}  // namespace
}  // namespace kerf

KERF_PARTITIONER(kerf::ZoltanHsfc, "zoltan_hsfc", "Hilbert space-filling curve: fast, with larger surfaces")
