// Finds, on one rank and without communication, the facets that each slave node may touch until the next search.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "dynamics/contact_records.hpp"

namespace kerf {

/// Candidates of all slaves that have any, in compressed rows, and everything they refer to.
struct Candidates {
  std::vector<std::int64_t> node_id;  // nodes that are referred to
  std::vector<std::int32_t> node_owner, node_local;
  std::vector<std::int32_t> node_part;
  std::vector<std::int32_t> slave;  // node number
  std::vector<std::int32_t> first_candidate, candidate, first_around, around;
  std::vector<std::int64_t> facet_id;
  std::vector<std::int32_t> facet_nodes, facet_part;  // four node numbers per facet
  std::vector<double> facet_bulk_modulus, facet_volume;
};

/// A slave and a facet are candidates where their boxes meet (their own boxes within one part, which counts only if
/// `same_part`), their roles match, and, within one part, the facet's element shares no node with the facets around the
/// slave.
class CandidateSearch {
 public:
  /// Slaves are given once each; facets may come in any order. Where all records, also later ones, come from one rank,
  /// `n_local` is the number of its nodes; otherwise 0.
  CandidateSearch(std::vector<ContactNodeRecord> slaves, std::vector<ContactFacetRecord> facets, bool same_part,
                  std::size_t n_local);
  ~CandidateSearch();

  /// The facets of some elements vanish, others appear, and nodes join the slaves. The candidates are then the same as
  /// those of a search with all that is left.
  void change(const std::vector<std::int64_t>& dead_elements, const std::vector<ContactFacetRecord>& new_facets,
              const std::vector<ContactNodeRecord>& new_slaves);
  Candidates candidates() const;

 private:
  struct Tables;
  std::unique_ptr<Tables> tables_;
};

}  // namespace kerf
