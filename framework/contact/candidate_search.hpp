// Finds, on one rank and without communication, the facets that each slave node may touch until the next search.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "contact/candidates.hpp"
#include "contact/records.hpp"
#include "kerf/contact.hpp"

namespace kerf {

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

  /// The facets of some elements vanish, others appear, and nodes join the slaves or, with a record without a role,
  /// leave them. The candidates are then the same as those of a search with all that is left.
  void change(const std::vector<std::int64_t>& dead_elements, const std::vector<ContactFacetRecord>& new_facets,
              const std::vector<ContactNodeRecord>& changed_slaves);
  /// Slaves that are known here, and facets that need not be, get other boxes. The candidates are then those of a
  /// search with the new boxes, and perhaps some more.
  void refresh(const std::vector<ContactFacetRecord>& facets, const std::vector<ContactNodeRecord>& slaves);
  /// The same for many at once: what grew or came late since the search does not make later calls dearer any more.
  void renew(const std::vector<ContactFacetRecord>& facets, const std::vector<ContactNodeRecord>& slaves);
  /// Valid until the next call. Until the next search the lists of nodes and facets only grow: new ones are appended,
  /// and unused ones stay. If new nodes had to be appended and records come from several ranks, the nodes behind every
  /// facet are appended too.
  const Candidates& candidates();
  /// Whether so many facets came or grew since the search or renewal that another one costs less than going on.
  bool stale() const;

 private:
  struct Tables;
  std::unique_ptr<Tables> tables_;
};

}  // namespace kerf
