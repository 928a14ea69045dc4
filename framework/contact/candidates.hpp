// What the search finds.
#pragma once

#include <cstdint>
#include <vector>

#include "kerf/contact.hpp"

namespace kerf {

/// Candidates of all slaves that have any, in rows, and everything that they refer to or have referred to.
struct Candidates {
  std::vector<std::int64_t> node_id;
  std::vector<std::int32_t> node_owner, node_local;
  std::vector<std::int32_t> node_body;
  std::vector<std::int32_t> slave;  // node number
  std::vector<ContactRow> candidates, around_rows;  // per slave: its part of the next two, which have gaps
  std::vector<std::int32_t> candidate, around;
  std::vector<std::int64_t> facet_id;
  std::vector<std::int32_t> facet_nodes, facet_body;  // four node numbers per facet
  std::vector<double> facet_bulk_modulus, facet_volume, facet_edge;
};

}  // namespace kerf
