// Finds out with Tpetra's maps who needs what from whom, and moves nodal and element values accordingly.
#include "parallel/exchange_plan.hpp"

#include <Teuchos_DefaultMpiComm.hpp>
#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "parallel/communicator.hpp"
#include "parallel/peer_messages.hpp"

namespace kerf {

namespace {

using Map = Tpetra::Map<int, long long>;
using Import = Tpetra::Import<int, long long>;
static_assert(sizeof(long long) == sizeof(std::int64_t));

Teuchos::RCP<const Map> make_map(const std::vector<std::int64_t>& ids,
                                 const Teuchos::RCP<const Teuchos::Comm<int>>& comm) {
  const auto* data = reinterpret_cast<const long long*>(ids.data());
  return Teuchos::rcp(new Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(),
                              Teuchos::ArrayView<const long long>(data, static_cast<int>(ids.size())), 0, comm));
}

}  // namespace

/// Who sends what to whom. Tpetra's maps find it out; the messages themselves are sent by PeerMessages, because a
/// doImport() of few rows costs several times as much as its messages do.
struct ExchangePlan::Plan {
  MPI_Comm comm = MPI_COMM_NULL;
  std::vector<std::int64_t> requested;
  std::vector<Peer> owners, holders;  // places in `needed` by owner; places in `requested` by rank that has a copy
  std::vector<std::int32_t> own_source, own_copy;  // the same for copies on this rank
  PeerMessages<double> reals;
  PeerMessages<std::int64_t> integers;

  PeerMessages<double>& messages(double) { return reals; }
  PeerMessages<std::int64_t>& messages(std::int64_t) { return integers; }

  template <class Value>
  void pull(const std::vector<std::int32_t>& sources, const Value* values, int stride, Value* copies, int copy_stride,
            int n_components) {
    const auto read = [&](std::int32_t source, Value* row) {
      const std::int32_t at = sources[source];
      for (int c = 0; c < n_components; ++c)
        row[c] = at < 0 ? Value{0} : values[static_cast<std::size_t>(at) * stride + c];
    };
    const auto write = [&](std::int32_t copy, const Value* row) {
      std::copy_n(row, n_components, copies + static_cast<std::size_t>(copy) * copy_stride);
    };
    for (std::size_t k = 0; k < own_source.size(); ++k)
      read(own_source[k], copies + static_cast<std::size_t>(own_copy[k]) * copy_stride);
    messages(Value{}).exchange(comm, holders, owners, n_components, read, write);
  }

  void find_peers(const Import& import, const std::vector<Needed>& needed);
};

/// Reads the lists of an Import. Those of the two sides of a message are in the same order.
void ExchangePlan::Plan::find_peers(const Import& import, const std::vector<Needed>& needed) {
  for (std::size_t i = 0; i < import.getNumSameIDs(); ++i) {
    own_source.push_back(static_cast<std::int32_t>(i));
    own_copy.push_back(static_cast<std::int32_t>(i));
  }
  const auto from = import.getPermuteFromLIDs(), to = import.getPermuteToLIDs();
  own_source.insert(own_source.end(), from.begin(), from.end());
  own_copy.insert(own_copy.end(), to.begin(), to.end());
  const auto exports = import.getExportLIDs(), remotes = import.getRemoteLIDs();
  const auto ranks = import.getExportPIDs();
  for (Teuchos::ArrayView<const int>::size_type i = 0; i < exports.size(); ++i)
    peer_of(holders, ranks[i]).items.push_back(exports[i]);
  for (const int copy : remotes) peer_of(owners, needed[static_cast<std::size_t>(copy)].owner).items.push_back(copy);
}

ExchangePlan::ExchangePlan(MPI_Comm comm, const std::vector<Needed>& needed) : plan_(std::make_unique<Plan>()) {
  const int n_ranks = size_of(comm);
  std::vector<std::vector<std::int64_t>> wanted(static_cast<std::size_t>(n_ranks));
  std::vector<std::int64_t> ids;
  ids.reserve(needed.size());
  for (const Needed& item : needed) {
    wanted[item.owner].push_back(item.id);
    ids.push_back(item.id);
  }
  std::vector<std::int64_t>& requested = plan_->requested;
  for (const auto& list : all_to_all(comm, std::move(wanted)))
    requested.insert(requested.end(), list.begin(), list.end());
  std::sort(requested.begin(), requested.end());
  requested.erase(std::unique(requested.begin(), requested.end()), requested.end());
  plan_->comm = comm;

  const Teuchos::RCP<const Teuchos::Comm<int>> teuchos = Teuchos::rcp(new Teuchos::MpiComm<int>(comm));
  const auto source = make_map(requested, teuchos), target = make_map(ids, teuchos);
  // The owners are known already, which spares Tpetra the search in its directory.
  const int here = rank_of(comm);
  Teuchos::Array<int> owners;
  std::size_t same = 0;
  while (same < ids.size() && same < requested.size() && ids[same] == requested[same]) ++same;
  for (std::size_t i = same; i < needed.size(); ++i)
    if (needed[i].owner != here) owners.push_back(needed[i].owner);
  plan_->find_peers(Import(source, target, owners), needed);
  check_order(ids);
}

/// Throws std::logic_error where a copy would get the value of another item.
void ExchangePlan::check_order(const std::vector<std::int64_t>& ids) {
  std::vector<std::int32_t> all(plan_->requested.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<std::int64_t> arrived(ids.size(), -1);
  plan_->pull(all, plan_->requested.data(), 1, arrived.data(), 1, 1);
  if (arrived != ids) throw std::logic_error("the lists of an exchange are not in the same order on two ranks");
}

ExchangePlan::~ExchangePlan() = default;

const std::vector<std::int64_t>& ExchangePlan::requested() const { return plan_->requested; }

void ExchangePlan::pull(const double* values, int stride, double* copies, int copy_stride, int n_components) {
  plan_->pull(sources_, values, stride, copies, copy_stride, n_components);
}

void ExchangePlan::pull(const std::int64_t* values, int stride, std::int64_t* copies, int copy_stride,
                        int n_components) {
  plan_->pull(sources_, values, stride, copies, copy_stride, n_components);
}

void ExchangePlan::push_add(const std::int64_t* copies, int copy_stride, std::int64_t* values, int stride,
                            int n_components) {
  const auto read = [&](std::int32_t copy, std::int64_t* row) {
    std::copy_n(copies + static_cast<std::size_t>(copy) * copy_stride, n_components, row);
  };
  const auto add = [&](std::int32_t source, const std::int64_t* row) {
    const std::int32_t at = sources_[source];
    for (int c = 0; c < n_components && at >= 0; ++c) values[static_cast<std::size_t>(at) * stride + c] += row[c];
  };
  for (std::size_t k = 0; k < plan_->own_source.size(); ++k)
    add(plan_->own_source[k], copies + static_cast<std::size_t>(plan_->own_copy[k]) * copy_stride);
  plan_->integers.exchange(plan_->comm, plan_->owners, plan_->holders, n_components, read, add);
}

}  // namespace kerf
