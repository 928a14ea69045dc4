// The candidates of a search as lists that contact laws read, made anew row by row where something has changed.
#pragma once

#include <cstdint>
#include <vector>

#include "contact/candidate_search.hpp"
#include "contact/surface_tables.hpp"

namespace kerf {

class CandidateRows {
 public:
  /// `records` must outlive this. `one_rank`: whether all nodes are those of one rank.
  CandidateRows(const SearchRecords& records, bool one_rank) : records_(records), one_rank_(one_rank) {}

  bool has(std::int32_t slave) const {
    return slave < static_cast<std::int32_t>(row_of_.size()) && row_of_[slave] >= 0;
  }
  /// The row of a slave is to be made anew.
  void outdate(std::int32_t slave) { outdated_.push_back(slave); }
  /// A facet is gone for good.
  void drop_facet(std::int32_t facet);
  /// The lists as things stand; nodes and facets keep their places in them.
  const Candidates& update();

 private:
  void resize();
  std::int32_t list_node(std::int32_t n, std::int64_t id, std::int32_t owner, std::int32_t local, std::int32_t body);
  std::int32_t list_corner(std::int32_t f, int k);
  std::int32_t list_facet(std::int32_t f);
  void make_row(std::int32_t s);
  void append_row(std::int32_t s);
  void remove_row(std::int32_t row);
  void drop_gone();

  static constexpr std::int32_t gone = -2;
  const SearchRecords& records_;
  bool one_rank_;
  Candidates lists_;
  std::vector<std::int32_t> row_of_;  // per slave: its row in the lists, or -1
  std::vector<std::int32_t> slave_of_row_;
  std::vector<std::int32_t> outdated_;  // slaves whose rows are to be made anew, some of them perhaps twice
  std::vector<std::int32_t> listed_node_, listed_facet_;  // per node number and facet: place in the lists, -1, or gone
  std::vector<char> gone_from_lists_;  // per facet of the lists
  bool any_gone_ = false;  // since the rows were made
};

}  // namespace kerf
