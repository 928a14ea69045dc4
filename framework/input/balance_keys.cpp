// Rewrites the block `balance` of inputs from before policies were plugins.
#include "input/balance_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace kerf {

void move_balance_keys(Node& root, Diagnostics& diagnostics) {
  static constexpr std::array<std::string_view, 4> moved = {"threshold", "check_interval", "cooldown", "cost_factor"};
  Entry* balance = root.find("balance");
  if (balance == nullptr || !balance->value.is_map()) return;
  std::vector<Entry>& entries = balance->value.entries;
  const auto belongs = [](const Entry& e) { return std::find(moved.begin(), moved.end(), e.key) != moved.end(); };
  const bool has_policy = balance->value.find("policy") != nullptr;
  Entry policy;
  policy.key = "policy";
  policy.value.kind = Node::Kind::map;
  for (const Entry& e : entries) {
    if (!belongs(e)) continue;
    if (has_policy)
      diagnostics.error(
          e.key_origin,
          fmt::format("`{}` belongs to a policy; expected it inside of `policy`, or no key `policy`", e.key));
    else
      diagnostics.warning(e.key_origin, fmt::format("`balance.{0}` is a key of the policy now; write `policy: {{type: "
                                                    "threshold, {0}: ...}}`",
                                                    e.key));
    if (policy.value.entries.empty()) {
      policy.key_origin = policy.value.origin = e.key_origin;
      Entry type;
      type.key = "type";
      type.key_origin = type.value.origin = e.key_origin;
      type.value.kind = Node::Kind::scalar;
      type.value.text = "threshold";
      policy.value.entries.push_back(std::move(type));
    }
    policy.value.entries.push_back(e);
  }
  if (policy.value.entries.empty()) return;
  std::erase_if(entries, belongs);
  if (!has_policy) entries.push_back(std::move(policy));
}

}  // namespace kerf
