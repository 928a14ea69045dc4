// Rows of candidates, written at the end of the lists and packed now and then.
#include "contact/candidate_rows.hpp"

#include <algorithm>

namespace kerf {

namespace {

/// Gives room of rows that were written anew back.
void pack(std::vector<ContactRow>& rows, std::vector<std::int32_t>& entries) {
  std::size_t used = 0;
  for (const ContactRow& row : rows) used += static_cast<std::size_t>(row.end - row.begin);
  if (entries.size() < 2 * used + 1024) return;
  std::vector<std::int32_t> packed;
  packed.reserve(2 * used);
  for (ContactRow& row : rows) {
    const auto begin = static_cast<std::int32_t>(packed.size());
    packed.insert(packed.end(), entries.begin() + row.begin, entries.begin() + row.end);
    row = {begin, static_cast<std::int32_t>(packed.size())};
  }
  entries.swap(packed);
}

}  // namespace

void CandidateRows::resize() {
  listed_node_.resize(records_.numbering.size(), -1);
  listed_facet_.resize(records_.facets.size(), -1);
  row_of_.resize(records_.slaves.size(), -1);
}

void CandidateRows::drop_facet(std::int32_t facet) {
  resize();
  if (listed_facet_[facet] >= 0) gone_from_lists_[listed_facet_[facet]] = any_gone_ = true;
  listed_facet_[facet] = gone;
}

std::int32_t CandidateRows::list_node(std::int32_t n, std::int64_t id, std::int32_t owner, std::int32_t local,
                                      std::int32_t body) {
  if (listed_node_[n] < 0) {
    listed_node_[n] = static_cast<std::int32_t>(lists_.node_id.size());
    lists_.node_id.push_back(id);
    lists_.node_owner.push_back(owner);
    lists_.node_local.push_back(local);
    lists_.node_body.push_back(body);
  }
  return listed_node_[n];
}

std::int32_t CandidateRows::list_corner(std::int32_t f, int k) {
  const ContactFacetRecord& r = records_.facets[f];
  return list_node(records_.corners[f][k], r.nodes[k], r.owners[k], r.locals[k], r.body);
}

std::int32_t CandidateRows::list_facet(std::int32_t f) {
  if (listed_facet_[f] < 0) {
    listed_facet_[f] = static_cast<std::int32_t>(lists_.facet_id.size());
    lists_.facet_id.push_back(records_.ids[f]);
    gone_from_lists_.push_back(false);
    lists_.facet_body.push_back(records_.facets[f].body);
    lists_.facet_bulk_modulus.push_back(records_.facets[f].bulk_modulus);
    lists_.facet_volume.push_back(records_.facets[f].volume);
    lists_.facet_edge.push_back(records_.facets[f].edge);
    for (int k = 0; k < 4; ++k) lists_.facet_nodes.push_back(list_corner(f, k));
  }
  return listed_facet_[f];
}

/// Writes the row of one slave at the end of the lists, or takes it out where the slave has no candidates.
void CandidateRows::make_row(std::int32_t s) {
  const std::size_t before = lists_.candidate.size();
  lists_.candidate.resize(before + records_.found[s].size());
  std::int32_t* end = lists_.candidate.data() + before;
  for (const std::int32_t f : records_.found[s])
    if (listed_facet_[f] != gone) *end++ = list_facet(f);
  lists_.candidate.resize(static_cast<std::size_t>(end - lists_.candidate.data()));
  if (lists_.candidate.size() == before) {
    if (row_of_[s] >= 0) remove_row(row_of_[s]);
    return;
  }
  if (row_of_[s] < 0) append_row(s);
  const auto row = static_cast<std::size_t>(row_of_[s]);
  lists_.candidates[row] = {static_cast<std::int32_t>(before), static_cast<std::int32_t>(lists_.candidate.size())};
  lists_.around_rows[row].begin = static_cast<std::int32_t>(lists_.around.size());
  for (const std::int32_t f : records_.around.of(records_.number[s])) lists_.around.push_back(list_facet(f));
  lists_.around_rows[row].end = static_cast<std::int32_t>(lists_.around.size());
}

void CandidateRows::append_row(std::int32_t s) {
  row_of_[s] = static_cast<std::int32_t>(slave_of_row_.size());
  slave_of_row_.push_back(s);
  const ContactNodeRecord& slave = records_.slaves[s];
  lists_.slave.push_back(list_node(records_.number[s], slave.id, slave.owner, slave.local, slave.body));
  lists_.candidates.emplace_back();
  lists_.around_rows.emplace_back();
}

void CandidateRows::remove_row(std::int32_t row) {
  row_of_[slave_of_row_[row]] = -1;
  if (slave_of_row_[row] != slave_of_row_.back()) row_of_[slave_of_row_.back()] = row;
  for (auto* list : {&slave_of_row_, &lists_.slave}) {
    (*list)[row] = list->back();
    list->pop_back();
  }
  for (auto* list : {&lists_.candidates, &lists_.around_rows}) {
    (*list)[row] = list->back();
    list->pop_back();
  }
}

/// Takes facets that are gone out of rows around which nothing else has changed. Where one of the facets round the
/// slave itself is gone, its row is made anew in any case.
void CandidateRows::drop_gone() {
  for (auto row = static_cast<std::int32_t>(lists_.candidates.size()) - 1; row >= 0; --row) {
    auto& [begin, end] = lists_.candidates[row];
    std::int32_t kept = begin;
    for (std::int32_t k = begin; k < end; ++k)
      if (gone_from_lists_[lists_.candidate[k]] == 0) lists_.candidate[kept++] = lists_.candidate[k];
    end = kept;
    if (begin == end) remove_row(row);
  }
  any_gone_ = false;
}

const Candidates& CandidateRows::update() {
  const std::size_t before = lists_.node_id.size();
  resize();
  if (any_gone_) drop_gone();
  std::sort(outdated_.begin(), outdated_.end());
  outdated_.erase(std::unique(outdated_.begin(), outdated_.end()), outdated_.end());
  for (const std::int32_t s : outdated_) make_row(s);
  outdated_.clear();
  pack(lists_.candidates, lists_.candidate);
  pack(lists_.around_rows, lists_.around);
  // Where new nodes have to be fetched from other ranks, those that the next death may lay bare come with them.
  if (one_rank_ || lists_.node_id.size() == before) return lists_;
  for (std::size_t f = 0; f < records_.facets.size(); ++f)
    for (int k = 4; k < 8 && listed_facet_[f] >= 0; ++k) list_corner(static_cast<std::int32_t>(f), k);
  return lists_;
}

}  // namespace kerf
