// What is asked of `kerf partition`, from its options. Mistakes are thrown as InputError.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "app/commands.hpp"
#include "app/partition_study.hpp"
#include "kerf/partitioner.hpp"
#include "plugin/registry.hpp"

namespace kerf {

/// Of `--parts 2,4,8`: ascending and each once. A model has at least as many elements.
std::vector<int> parts_asked(const std::string& text, std::int64_t n_elements);

/// Of `--frame 0,10,last`: ascending and each once; none without `--results`.
std::vector<std::int64_t> frames_asked(const PartitionOptions& options);

/// Of all `--method`: names with commas between, `all`, or NAME={type: ...}. Each name is there once.
std::vector<PartitionMethod> methods_asked(const PartitionOptions& options, const Registry& registry);

std::unique_ptr<Partitioner> make_partitioner(const PartitionMethod& method, const Registry& registry);

}  // namespace kerf
