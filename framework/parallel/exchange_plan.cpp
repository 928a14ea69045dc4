// The only file that moves nodal and element values with Tpetra.
#include "parallel/exchange_plan.hpp"

#include <Teuchos_DefaultMpiComm.hpp>
#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <algorithm>
#include <map>

#include "parallel/communicator.hpp"

namespace kerf {

namespace {

using Map = Tpetra::Map<int, long long>;
using Import = Tpetra::Import<int, long long>;
template <class T>
using Columns = Tpetra::MultiVector<T, int, long long>;
static_assert(sizeof(long long) == sizeof(std::int64_t));

Teuchos::RCP<const Map> make_map(const std::vector<std::int64_t>& ids,
                                 const Teuchos::RCP<const Teuchos::Comm<int>>& comm) {
  const auto* data = reinterpret_cast<const long long*>(ids.data());
  return Teuchos::rcp(new Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(),
                              Teuchos::ArrayView<const long long>(data, static_cast<int>(ids.size())), 0, comm));
}

}  // namespace

struct ExchangePlan::Plan {
  std::vector<std::int64_t> requested;
  std::size_t n_needed = 0;
  Teuchos::RCP<const Map> source, target;
  Teuchos::RCP<const Import> import;
  // Reused between calls: allocating a MultiVector costs more than sending it. Keyed by the number of columns.
  std::map<int, std::pair<Teuchos::RCP<Columns<double>>, Teuchos::RCP<Columns<double>>>> reals;
  std::map<int, std::pair<Teuchos::RCP<Columns<long long>>, Teuchos::RCP<Columns<long long>>>> integers;

  template <class T>
  auto& vectors(int n_components) {
    auto& cache = [this]() -> auto& {
      if constexpr (std::is_same_v<T, double>)
        return reals;
      else
        return integers;
    }
    ();
    auto& pair = cache[n_components];
    if (pair.first.is_null()) {
      pair.first = Teuchos::rcp(new Columns<T>(source, n_components));
      pair.second = Teuchos::rcp(new Columns<T>(target, n_components));
    }
    return pair;
  }

  template <class T, class Value>
  void pull(const std::vector<std::int32_t>& sources, const Value* values, int stride, Value* copies, int copy_stride,
            int n_components) {
    auto& [owned, copied] = vectors<T>(n_components);
    {
      auto view = owned->getLocalViewHost(Tpetra::Access::OverwriteAll);
      for (std::size_t i = 0; i < sources.size(); ++i)
        for (int c = 0; c < n_components; ++c)
          view(i, c) = sources[i] < 0 ? Value{0} : values[static_cast<std::size_t>(sources[i]) * stride + c];
    }
    copied->doImport(*owned, *import, Tpetra::INSERT);
    const auto view = copied->getLocalViewHost(Tpetra::Access::ReadOnly);
    for (std::size_t i = 0; i < n_needed; ++i)
      for (int c = 0; c < n_components; ++c) copies[i * copy_stride + c] = view(i, c);
  }
};

ExchangePlan::ExchangePlan(MPI_Comm comm, const std::vector<Needed>& needed) : plan_(std::make_unique<Plan>()) {
  const int n_ranks = size_of(comm);
  std::vector<std::vector<std::int64_t>> wanted(static_cast<std::size_t>(n_ranks));
  std::vector<std::int64_t> ids;
  ids.reserve(needed.size());
  for (const Needed& item : needed) {
    wanted[item.owner].push_back(item.id);
    ids.push_back(item.id);
  }
  for (const auto& list : all_to_all(comm, wanted))
    plan_->requested.insert(plan_->requested.end(), list.begin(), list.end());
  std::sort(plan_->requested.begin(), plan_->requested.end());
  plan_->requested.erase(std::unique(plan_->requested.begin(), plan_->requested.end()), plan_->requested.end());
  plan_->n_needed = needed.size();

  const Teuchos::RCP<const Teuchos::Comm<int>> teuchos = Teuchos::rcp(new Teuchos::MpiComm<int>(comm));
  plan_->source = make_map(plan_->requested, teuchos);
  plan_->target = make_map(ids, teuchos);
  // The owners are known already, which spares Tpetra the search in its directory.
  const int here = rank_of(comm);
  Teuchos::Array<int> owners;
  std::size_t same = 0;
  while (same < ids.size() && same < plan_->requested.size() && ids[same] == plan_->requested[same]) ++same;
  for (std::size_t i = same; i < needed.size(); ++i)
    if (needed[i].owner != here) owners.push_back(needed[i].owner);
  plan_->import = Teuchos::rcp(new Import(plan_->source, plan_->target, owners));
}

ExchangePlan::~ExchangePlan() = default;

const std::vector<std::int64_t>& ExchangePlan::requested() const { return plan_->requested; }

void ExchangePlan::pull(const double* values, int stride, double* copies, int copy_stride, int n_components) {
  plan_->pull<double>(sources_, values, stride, copies, copy_stride, n_components);
}

void ExchangePlan::pull(const std::int64_t* values, int stride, std::int64_t* copies, int copy_stride,
                        int n_components) {
  plan_->pull<long long>(sources_, values, stride, copies, copy_stride, n_components);
}

void ExchangePlan::push_add(const std::int64_t* copies, int copy_stride, std::int64_t* values, int stride,
                            int n_components) {
  auto& [owned, copied] = plan_->vectors<long long>(n_components);
  {
    auto view = copied->getLocalViewHost(Tpetra::Access::OverwriteAll);
    for (std::size_t i = 0; i < plan_->n_needed; ++i)
      for (int c = 0; c < n_components; ++c) view(i, c) = copies[i * copy_stride + c];
  }
  owned->putScalar(0);
  owned->doExport(*copied, *plan_->import, Tpetra::ADD);
  const auto view = owned->getLocalViewHost(Tpetra::Access::ReadOnly);
  for (std::size_t i = 0; i < sources_.size(); ++i)
    for (int c = 0; c < n_components && sources_[i] >= 0; ++c)
      values[static_cast<std::size_t>(sources_[i]) * stride + c] += view(i, c);
}

}  // namespace kerf
