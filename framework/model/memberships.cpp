// How ranks agree on the table of combinations.
#include "model/memberships.hpp"

#include <algorithm>
#include <iterator>

#include "core/assert.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

namespace {

/// Appends the length of a list and its entries.
void write(std::vector<std::int32_t>& out, const std::vector<std::int32_t>& list) {
  out.push_back(static_cast<std::int32_t>(list.size()));
  out.insert(out.end(), list.begin(), list.end());
}

std::vector<std::int32_t> read(const std::vector<std::int32_t>& in, std::size_t& at) {
  const auto first = in.begin() + static_cast<std::ptrdiff_t>(at) + 1;
  std::vector<std::int32_t> list(first, first + in[at]);
  at += 1 + list.size();
  return list;
}

std::vector<std::int32_t> written(const std::vector<Membership>& all) {
  std::vector<std::int32_t> out;
  for (const Membership& m : all) {
    write(out, m.parts);
    write(out, m.sets);
  }
  return out;
}

/// In ascending order, each once.
std::vector<Membership> sorted(const std::vector<std::int32_t>& in) {
  std::vector<Membership> all;
  for (std::size_t at = 0; at < in.size();) {
    Membership m;
    m.parts = read(in, at);
    m.sets = read(in, at);
    all.push_back(std::move(m));
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

std::vector<std::int32_t> joined(const std::vector<std::int32_t>& a, const std::vector<std::int32_t>& b) {
  std::vector<std::int32_t> all;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(all));
  return all;
}

}  // namespace

Membership joined(const Membership& a, const Membership& b) {
  return {joined(a.parts, b.parts), joined(a.sets, b.sets)};
}

Memberships::Memberships(MPI_Comm comm, const std::vector<Membership>& here) {
  std::vector<std::int32_t> table = written(sorted(gather_to_root(comm, written(here))));
  auto size = static_cast<int>(table.size());
  MPI_Bcast(&size, 1, MPI_INT, 0, comm);
  table.resize(static_cast<std::size_t>(size));
  MPI_Bcast(table.data(), size, MPI_INT32_T, 0, comm);
  all_ = sorted(table);
}

std::int32_t Memberships::number_of(const Membership& membership) const {
  const auto at = std::lower_bound(all_.begin(), all_.end(), membership);
  KERF_ASSERT(at != all_.end() && *at == membership, "ranks have agreed on all combinations of parts and sets");
  return static_cast<std::int32_t>(at - all_.begin());
}

}  // namespace kerf
