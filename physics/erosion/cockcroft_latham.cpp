// Cockcroft-Latham: ductile failure at a limit of the plastic work of the largest principal stress.
//
// Source: M.G. Cockcroft & D.J. Latham, "Ductility and the workability of metals", J. Inst. Metals 96 (1968) 33-39.
#include "accumulated_damage.hpp"

namespace {

using namespace kerf;

/// W' = max(sigma_1, 0) ep'. W = `limit` is failure, or where softening begins.
struct CockcroftLatham final : AccumulatedDamage<CockcroftLatham> {
  double limit = 0.0;  // [J/m3]
  using State = DamageState;
  using Reads = DamageReads;

  static void describe(Schema<CockcroftLatham>& s) {
    s.real(&CockcroftLatham::limit, "limit", "Pa", positive, "work at failure, per volume, W_cr");
    describe_damage(s, "cockcroft_latham_work", "Pa",
                    "integral of the positive largest principal stress over plastic strain", "cockcroft_latham");
  }
  double amount_at_failure() const { return limit; }
  [[gnu::always_inline]] double pace(const Point& in, const Reads&, double) const {
    return max_of(largest_principal(in.stress), 0.0);
  }
};

}  // namespace

KERF_EROSION(CockcroftLatham, "cockcroft_latham", "plastic work of the largest principal stress reaches a limit")
